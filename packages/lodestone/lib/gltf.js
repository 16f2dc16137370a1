// A plugin for three.js's GLTFLoader: meshes of files that `lodestone build --profile stream` has written refine themselves
// by how they are seen. What the file shows at first is a mesh as any other, in place of which its stream's levels come.
import { Box3, LoaderUtils, Sphere, Vector2 } from 'three';
import { LodestoneStream } from './index.js';
import { STEP, StreamBuffers, nameOf, pixelsPerUnit } from './three_buffers.js';

const EXTENSION = 'LODESTONE_removal_stream';
const PATIENCE = 300; // milliseconds before it is coarsened

/** A mesh of the file with its stream. */
class RefinedMesh {
  #source; // () => Promise of a URL
  #options;
  #parts; // { geometry, group, wanted } of primitives that are refined
  #shown; // { deviation, faceCount } of the file's own level
  #stream;
  #buffers;
  #attached = false;
  #wanted = Infinity;
  #frame = -1;
  #finest = Infinity; // wanted in this frame
  #needed = 0; // when it was last wanted as fine as it is
  #url; // of what is in memory
  #closed = false;

  constructor(source, shown, parts, options) {
    this.#source = source;
    this.#shown = shown;
    this.#parts = parts;
    this.#options = options;
    this.complete = new Promise((resolve, reject) => {
      this.resolve = resolve;
      this.reject = reject;
    });
    this.complete.catch(() => {}); // who wants to know awaits it
  }

  get geometries() {
    return this.#parts.map(({ geometry }) => geometry);
  }

  /** The level that is drawn; undefined while it is the file's own. */
  get level() {
    return this.#attached ? this.#stream.level : undefined;
  }

  /** Of what has arrived. */
  get bytes() {
    return this.#stream?.bytes ?? 0;
  }

  /** Is told by each object that shows the mesh how far its levels may lie from the whole. */
  want(deviation, frame) {
    const now = performance.now();
    if (frame !== this.#frame) {
      // Several cameras may see it in turn: it gets coarser when none has wanted it as fine for a while.
      if (this.#finest > this.#wanted * STEP && now - this.#needed > PATIENCE) this.#set(this.#finest);
      this.#frame = frame;
      this.#finest = Infinity;
    }
    this.#finest = Math.min(this.#finest, deviation);
    if (this.#finest <= this.#wanted * STEP) this.#needed = now;
    if (this.#finest * STEP < this.#wanted) this.#set(this.#finest);
  }

  #set(deviation) {
    this.#wanted = deviation;
    if (this.#closed) return;
    if (this.#stream) this.#stream.want(deviation);
    else if ((deviation < this.#shown.deviation || deviation === 0) && !this.opening) {
      this.opening = this.#open().catch((error) => this.reject(error)).finally(() => this.#letGo());
    }
  }

  async #open() {
    const { worker, fetch } = this.#options;
    const options = { deviation: this.#wanted, ...(worker !== undefined && { worker }), ...(fetch && { fetch }) };
    this.#url = await this.#source();
    const stream = await LodestoneStream.open(this.#url, options);
    this.#stream = stream;
    if (this.#closed) return;
    this.#buffers = new StreamBuffers(stream);
    stream.want(this.#wanted);
    for await (const update of stream) {
      this.#apply(update);
      this.#options.onUpdate?.(this);
      if (stream.complete) this.resolve();
    }
  }

  #letGo() {
    this.#stream?.close();
    if (this.#url?.startsWith('blob:')) URL.revokeObjectURL(this.#url);
  }

  /** What arrives first is coarser than what is there already: only a level as fine takes its place. */
  #apply(update) {
    const others = this.#buffers.write(update);
    const first = !this.#attached && update.level.faceCount >= this.#shown.faceCount;
    this.#attached ||= first;
    if (!this.#attached) return;
    update.groups.forEach(({ count }, group) => {
      for (const part of this.#parts) {
        if (this.#stream.groups[group].material !== part.primitive) continue;
        if (first || others) this.#buffers.put(part.geometry, group, part.wanted);
        part.geometry.boundingBox ??= new Box3();
        part.geometry.boundingSphere ??= new Sphere();
        this.#buffers.bound(part.geometry, count, update, part.box);
      }
    });
  }

  close() {
    this.#closed = true;
    this.#stream?.close();
    this.resolve();
  }
}

/** The names that a primitive's attributes have in a geometry: others of the mesh's primitives are not for its material. */
function attributesOf({ attributes, targets = [] }) {
  const names = new Set(Object.keys(attributes).map(nameOf));
  names.add('position');
  for (const target of targets) for (const semantic of Object.keys(target)) names.add(semantic.toLowerCase());
  return names;
}

/**
 * `loader.register((parser) => new LodestonePlugin(parser))`. What is loaded has `gltf.userData.lodestone`, its meshes that
 * refine themselves as they are rendered: see `Refinement` in gltf.d.ts. Options: `pixelError`, how many pixels a level's
 * error may cover; `onUpdate`, called when there is something new to draw; `worker` and `fetch` as LodestoneStream.open has.
 */
export class LodestonePlugin {
  #parser;
  #options;
  #meshes = [];

  constructor(parser, options = {}) {
    this.name = EXTENSION;
    this.#parser = parser;
    this.#options = { pixelError: 1, ...options };
  }

  /** GLTFLoader asks for each mesh; null at once leaves it to others. */
  loadMesh(number) {
    const definition = this.#parser.json.meshes[number];
    const extension = definition.extensions?.[EXTENSION];
    return extension?.version?.startsWith('3.') ? this.#load(number, definition, extension) : null;
  }

  async #load(number, definition, extension) {
    const object = await this.#parser.loadMesh(number);
    const objects = object.isGroup ? object.children : [object];
    const parts = definition.primitives.flatMap((primitive, i) => {
      const { geometry, isMesh } = objects[i];
      if (!isMesh) return [];
      const names = attributesOf(primitive);
      return [{ geometry, primitive: i, wanted: (name) => names.has(name), box: geometry.boundingBox?.clone() }];
    });
    const faceCount = parts.reduce((sum, { geometry }) => sum + (geometry.index ?? geometry.attributes.position).count / 3, 0);
    const shown = { deviation: extension.deviation ?? Infinity, faceCount };
    this.#meshes.push(new RefinedMesh(() => this.#locate(extension), shown, parts, this.#options));
    return object;
  }

  /** A stream beside the file is fetched part by part; one inside has arrived with it. */
  async #locate({ uri, bufferView }) {
    if (uri !== undefined) return LoaderUtils.resolveURL(uri, this.#parser.options.path);
    return URL.createObjectURL(new Blob([await this.#parser.getDependency('bufferView', bufferView)]));
  }

  /** GLTFLoader is done: what shows the meshes says from now on how it is seen. */
  afterRoot(gltf) {
    const meshes = this.#meshes;
    const options = this.#options;
    const of = new Map(meshes.flatMap((mesh) => mesh.geometries.map((geometry) => [geometry, mesh])));
    for (const scene of gltf.scenes)
      scene.traverse((object) => {
        const mesh = of.get(object.geometry);
        if (mesh) watch(object, mesh, options);
      });
    gltf.userData.lodestone = {
      meshes,
      get pixelError() {
        return options.pixelError;
      },
      set pixelError(pixels) {
        options.pixelError = pixels;
      },
      dispose: () => meshes.forEach((mesh) => mesh.close()),
    };
    return null;
  }
}

const size = new Vector2();
const sphere = new Sphere();

/** Has an object say, each time that it is rendered, how fine its mesh has to be. */
function watch(object, mesh, options) {
  const before = object.onBeforeRender;
  object.onBeforeRender = (renderer, scene, camera, geometry, ...rest) => {
    const target = renderer.getRenderTarget();
    const height = target ? target.height : renderer.getDrawingBufferSize(size).y;
    const around = object.isInstancedMesh ? (object.boundingSphere ?? (object.computeBoundingSphere(), object.boundingSphere)) : geometry.boundingSphere;
    const scale = object.matrixWorld.getMaxScaleOnAxis();
    sphere.copy(around).applyMatrix4(object.matrixWorld);
    const wanted = options.pixelError / (scale * pixelsPerUnit(camera, height, sphere));
    if (wanted >= 0) mesh.want(wanted, renderer.info.render.frame);
    before.call(object, renderer, scene, camera, geometry, ...rest);
  };
}
