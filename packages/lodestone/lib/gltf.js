// A plugin for three.js's GLTFLoader: meshes of files that `lodestone build --profile stream` has written refine themselves
// by how they are seen. What the file shows at first is a mesh as any other, in place of which its stream's levels come.
import { Box3, LoaderUtils, Sphere, Vector2 } from 'three';
import { EXTENSION, RefinedMesh, Refinement, ownAttributes, streamOf } from './refined_mesh.js';
import { StreamBuffers, ballOf, viewOf } from './three_buffers.js';
import { pixelsOfInstances, pixelsThrough } from './view.js';
import { checkRange } from './wasm.js';

/** What a mesh's stream is drawn from: the geometries of its primitives. */
class GeometryBuffers {
  #stream;
  #buffers;
  #parts; // { geometry, primitive, own, box }
  #grown = false;

  constructor(stream, parts, json, primitives, sliding) {
    this.#stream = stream;
    this.#buffers = new StreamBuffers(stream, sliding);
    this.#parts = parts.map((part) => ({ ...part, own: ownAttributes(json, primitives[part.primitive], stream.attributes) }));
  }

  leave(update) {
    return this.#buffers.leave(update);
  }

  write(update, isShown) {
    this.#grown = this.#buffers.write(update, isShown);
  }

  step() {
    this.#buffers.step();
  }

  finish() {
    this.#buffers.finish();
  }

  show(update, isFirst) {
    update.groups.forEach(({ count }, group) => {
      for (const { geometry, primitive, own, box } of this.#parts) {
        if (this.#stream.groups[group].material !== primitive) continue;
        if (isFirst || this.#grown) this.#buffers.put(geometry, group, own);
        geometry.boundingBox ??= new Box3();
        geometry.boundingSphere ??= new Sphere();
        this.#buffers.bound(geometry, count, update, box);
      }
    });
  }
}

/**
 * `loader.register((parser) => new LodestonePlugin(parser))`. What is loaded has `gltf.userData.lodestone`, its meshes that
 * refine themselves as they are rendered: see `Refinement` in gltf.d.ts. Options: `pixelError`, how many pixels a level's
 * error may cover; `budget`, a DetailBudget that says so in its place; `morph`, milliseconds in which vertices slide from level
 * to level, 0: none; `onUpdate`, called when there is something new to draw;
 * `worker`, `idleTimeout` and `fetch` as LodestoneStream.open has.
 */
export class LodestonePlugin {
  #parser;
  #options;
  #meshes = []; // { mesh, geometries }

  constructor(parser, options = {}) {
    this.name = EXTENSION;
    this.#parser = parser;
    this.#options = { pixelError: 1, morph: 0, ...options };
    checkRange('morph', this.#options.morph, 0, Number.MAX_SAFE_INTEGER);
  }

  /** GLTFLoader asks for each mesh; null at once leaves it to others. */
  loadMesh(number) {
    const definition = this.#parser.json.meshes[number];
    const extension = streamOf(definition);
    return extension ? this.#load(number, definition, extension) : null;
  }

  async #load(number, definition, extension) {
    const object = await this.#parser.loadMesh(number);
    const objects = object.isGroup ? object.children : [object];
    const parts = definition.primitives.flatMap((_, primitive) => {
      const { geometry, isMesh } = objects[primitive];
      return isMesh ? [{ geometry, primitive, box: geometry.boundingBox?.clone() }] : [];
    });
    const faceCount = parts.reduce((sum, { geometry }) => sum + (geometry.index ?? geometry.attributes.position).count / 3, 0);
    const shown = { deviation: extension.deviation, faceCount };
    const sliding = { morph: this.#options.morph, onStep: () => this.#options.onUpdate?.(mesh) };
    const makeBuffers = (stream) => new GeometryBuffers(stream, parts, this.#parser.json, definition.primitives, sliding);
    const mesh = new RefinedMesh(() => this.#locate(extension), shown, this.#options, makeBuffers);
    mesh.geometries = parts.map(({ geometry }) => geometry);
    mesh.primitiveCount = parts.length;
    mesh.geometries.forEach((geometry) => addBones(mesh.bones, geometry.attributes));
    this.#meshes.push(mesh);
    return object;
  }

  /** A stream beside the file is fetched part by part; one inside has arrived with it. */
  async #locate({ uri, bufferView }) {
    const { manager, path } = this.#parser.options;
    if (uri !== undefined) return manager.resolveURL(LoaderUtils.resolveURL(uri, path));
    return URL.createObjectURL(new Blob([await this.#parser.getDependency('bufferView', bufferView)]));
  }

  /** GLTFLoader is done: what shows the meshes says from now on how it is seen. */
  afterRoot(gltf) {
    const of = new Map(this.#meshes.flatMap((mesh) => mesh.geometries.map((geometry) => [geometry, mesh])));
    for (const scene of gltf.scenes)
      scene.traverse((object) => {
        const mesh = of.get(object.geometry);
        if (mesh) watch(object, mesh);
      });
    gltf.userData.lodestone = new Refinement(this.#meshes, this.#options);
    return null;
  }
}

/** Numbers of an attribute one after the other, as they lie, in whatever way they are stored. */
function numbersOf(attribute) {
  const numbers = new Float32Array(attribute.count * attribute.itemSize);
  for (let i = 0; i < numbers.length; ++i) numbers[i] = attribute.getComponent(Math.floor(i / attribute.itemSize), i % attribute.itemSize);
  return numbers;
}

function addBones(bones, { position, skinIndex, skinWeight }) {
  if (skinIndex && skinWeight) bones.add(numbersOf(position), numbersOf(skinIndex), numbersOf(skinWeight));
}

const size = new Vector2();

/** How many pixels a unit of the mesh covers at most where an object shows it. */
function pixelsOf(object, geometry, mesh, view) {
  const world = object.matrixWorld.elements;
  const ball = ballOf(geometry.boundingSphere);
  if (object.isInstancedMesh) return pixelsOfInstances(view, world, object.instanceMatrix.array, object.count, ball);
  if (!object.isSkinnedMesh || mesh.bones.isEmpty) return pixelsThrough(view, world, ball);
  const around = object.matrixWorld.clone().multiply(object.bindMatrixInverse).elements;
  return mesh.bones.pixels(view, around, object.skeleton.boneMatrices, mesh.farthest, object.bindMatrix.elements);
}

/** Has an object say, each time that it is rendered, how fine its mesh has to be. */
function watch(object, mesh) {
  const before = object.onBeforeRender;
  object.onBeforeRender = (renderer, scene, camera, geometry, ...rest) => {
    const target = renderer.getRenderTarget();
    const view = viewOf(camera, target ? target.height : renderer.getDrawingBufferSize(size).y);
    mesh.see(pixelsOf(object, geometry, mesh, view), renderer.info.render.frame, object.isInstancedMesh ? object.count : 1);
    before.call(object, renderer, scene, camera, geometry, ...rest);
  };
}
