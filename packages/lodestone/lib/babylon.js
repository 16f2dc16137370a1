// An extension for Babylon.js's loader of glTF: meshes of files that `lodestone build --profile stream` has written refine
// themselves by how they are seen. What the file shows at first is a mesh as any other, in whose geometry its stream's levels
// come.
import { Buffer, VertexBuffer } from '@babylonjs/core/Buffers/buffer.js';
import '@babylonjs/core/Engines/Extensions/engine.dynamicBuffer.js';
import { Vector3 } from '@babylonjs/core/Maths/math.vector.js';
import { registerGLTFExtension, unregisterGLTFExtension } from '@babylonjs/loaders/glTF/2.0/glTFLoaderExtensionRegistry.js';
import { GrowingArray } from './growing_array.js';
import { EXTENSION, RefinedMesh, Refinement, ownAttributes, streamOf, targetOf } from './refined_mesh.js';
import { Slides, wayOf } from './slides.js';
import { pixelsOfInstances, pixelsThrough } from './view.js';
import { checkRange } from './wasm.js';

const KINDS = {
  POSITION: VertexBuffer.PositionKind,
  NORMAL: VertexBuffer.NormalKind,
  TANGENT: VertexBuffer.TangentKind,
  TEXCOORD_0: VertexBuffer.UVKind,
  TEXCOORD_1: VertexBuffer.UV2Kind,
  TEXCOORD_2: VertexBuffer.UV3Kind,
  TEXCOORD_3: VertexBuffer.UV4Kind,
  TEXCOORD_4: VertexBuffer.UV5Kind,
  TEXCOORD_5: VertexBuffer.UV6Kind,
  COLOR_0: VertexBuffer.ColorKind,
  JOINTS_0: VertexBuffer.MatricesIndicesKind,
  WEIGHTS_0: VertexBuffer.MatricesWeightsKind,
  JOINTS_1: VertexBuffer.MatricesIndicesExtraKind,
  WEIGHTS_1: VertexBuffer.MatricesWeightsExtraKind,
};

const SET_TARGET = { POSITION: 'setPositions', NORMAL: 'setNormals', COLOR_0: 'setColors' };
const POSITIONS = { name: 'POSITION', componentType: VertexBuffer.FLOAT, componentCount: 3, normalized: false };

/** A buffer of vertices that grows: of what `write` is given no more is uploaded, but for when it grows. */
class GrowingBuffer {
  #engine;
  #array;
  #format;
  #stale = false; // `vertices` are not of the array
  vertices; // Babylon's buffer; undefined before `make`

  constructor(engine, format, likely) {
    this.#engine = engine;
    this.#format = format;
    this.#array = new GrowingArray(format.componentCount, likely);
  }

  get kind() {
    return KINDS[this.#format.name];
  }

  get array() {
    return this.#array.array;
  }

  get itemSize() {
    return this.#format.componentCount;
  }

  /** Whether its values slide where vertices do: joints are numbers of bones, which mean nothing in between, and so weights stay, too. */
  get slides() {
    const { name, normalized, componentType } = this.#format;
    return !/^(JOINTS|WEIGHTS)_/.test(name) && (normalized || componentType === VertexBuffer.FLOAT);
  }

  write(begin, values) {
    this.#stale = this.#array.write(begin, values) || this.#stale;
    this.#upload(begin, values);
  }

  /** Has elements uploaded that were written to the array. */
  touch(begin, count) {
    this.#upload(begin, this.array.subarray(begin * this.itemSize, (begin + count) * this.itemSize));
  }

  #upload(begin, values) {
    if (!this.vertices || this.#stale || values.length === 0) return;
    // Not by the buffer's own function, which then forgets what it has in memory: rays ask for that.
    this.#engine.updateDynamicVertexBuffer(this.vertices.getBuffer(), values, begin * this.#stride, values.byteLength);
  }

  get #stride() {
    return this.#format.componentCount * this.#array.array.BYTES_PER_ELEMENT;
  }

  /** Makes `vertices` where there are none for all that was written; returns whether they are others now. */
  make() {
    if (!this.#stale || !this.kind) return false;
    this.#stale = false;
    const { componentType: type, componentCount: size, normalized } = this.#format;
    const stride = this.#stride;
    const buffer = new Buffer(this.#engine, this.#array.array, true, stride, false, false, true);
    const options = { updatable: true, stride, size, type, normalized, useBytes: true, takeBufferOwnership: true };
    this.vertices = new VertexBuffer(this.#engine, buffer, this.kind, options);
    return true;
  }

  /** The numbers of the first so many elements. */
  numbers(count) {
    return this.#array.array.subarray(0, count * this.#format.componentCount);
  }
}

/** What a mesh's stream is drawn from: the geometries of its primitives, which all meshes that show them share. */
class GeometryBuffers {
  #stream;
  #parts; // { geometry, primitive, own, box }
  #buffers; // of positions, then of the stream's attributes
  #indices; // by group
  #wedges = 0;
  #level; // that has been written last
  #slides; // undefined where nothing slides
  #moved = false; // there are vertices that targets do not have, or have elsewhere

  /** `morph`: milliseconds in which vertices slide from level to level; `onStep` is called when they have. */
  constructor(stream, engine, parts, json, primitives, { morph, onStep }) {
    const whole = stream.chunks.at(-1);
    this.#stream = stream;
    this.#parts = parts.map((part) => ({ ...part, own: ownAttributes(json, primitives[part.primitive], stream.attributes) }));
    this.#buffers = [POSITIONS, ...stream.attributes].map((format) => new GrowingBuffer(engine, format, whole.vertexCount));
    this.#indices = stream.groups.map(() => new GrowingArray(1, 3 * whole.faceCount));
    // Targets would have to slide along, all of them in each frame: they lie where they move vertices to.
    if (morph > 0 && !stream.attributes.some(({ name }) => targetOf(name))) this.#slides = new Slides(morph, onStep);
  }

  get #sliding() {
    return this.#buffers.filter(({ slides }) => slides);
  }

  /** Has vertices slide to a coarser level, before that is written; resolves when they are there. */
  async leave(update) {
    if (this.#slides && wayOf(this.#level, update) < 0) await this.#slides.coarsen(update, this.#sliding);
  }

  /** Takes an update, from whose level before, where that `isShown`, vertices slide. */
  write(update, isShown) {
    const slides = isShown && this.#slides && wayOf(this.#level, update) > 0;
    this.#level = update.level;
    if (slides) this.#slides.refine(update, this.#sliding, () => this.#write(update));
    else this.#write(update);
  }

  /** Moves what slides to where it is by now: for who draws. */
  step() {
    if (!this.#slides || this.#slides.isIdle) return;
    this.#slides.step();
    for (const { geometry } of this.#parts) geometry._resetPointsArrayCache?.(); // of what rays are asked for
  }

  /** Has what slides be where it is to be. */
  finish() {
    this.#slides?.finish();
  }

  #write({ wedges, moved, groups }) {
    if (wedges.end > wedges.begin) {
      [wedges.positions, ...wedges.attributes].forEach((values, i) => this.#buffers[i].write(wedges.begin, values));
      this.#wedges = wedges.end;
      this.#moved = true;
    }
    for (const { begin, positions } of moved) this.#buffers[0].write(begin, positions);
    this.#moved ||= moved.length > 0;
    groups.forEach(({ ranges }, i) => {
      for (const { begin, corners } of ranges) this.#indices[i].write(begin, corners);
    });
  }

  show(update, isFirst) {
    const made = this.#buffers.map((buffer) => buffer.make());
    const moved = this.#moved || isFirst;
    this.#moved = false;
    update.groups.forEach(({ count, ranges }, group) => {
      for (const part of this.#parts) {
        if (this.#stream.groups[group].material !== part.primitive || part.geometry.isDisposed()) continue;
        if (isFirst) this.#clear(part);
        this.#putVertices(part, made, isFirst);
        if (moved || ranges.length > 0 || count !== part.geometry.getTotalIndices()) this.#putIndices(part.geometry, group, count);
        if (moved) this.#putTargets(part);
        if (moved) this.#bound(part, update);
      }
    });
  }

  #has({ own }, i) {
    return i === 0 || own[i - 1];
  }

  /** Lets go of what the file's own level has and the stream does not. */
  #clear(part) {
    const kinds = new Set(this.#buffers.filter((_, i) => this.#has(part, i)).map(({ kind }) => kind));
    for (const kind of Object.values(KINDS))
      if (!kinds.has(kind) && part.geometry.isVerticesDataPresent(kind)) part.geometry.removeVerticesData(kind);
    for (const mesh of part.geometry.meshes) mesh.isUnIndexed = false;
  }

  #putVertices(part, made, all) {
    this.#buffers.forEach(({ vertices }, i) => {
      if (vertices && (all || made[i]) && this.#has(part, i)) part.geometry.setVerticesBuffer(vertices, this.#wedges);
    });
  }

  /** Indices are uploaded as a whole, for Babylon.js does not do it otherwise. */
  #putIndices(geometry, group, count) {
    const corners = this.#indices[group].array?.subarray(0, count) ?? new Uint32Array(0);
    for (const { subMeshes } of geometry.meshes) for (const subMesh of subMeshes) subMesh.indexCount = Math.min(subMesh.indexCount, count);
    geometry.setIndices(corners, this.#wedges, true, true);
    for (const mesh of geometry.meshes) {
      const [subMesh] = mesh.subMeshes;
      if (!subMesh) continue;
      subMesh.indexCount = count;
      subMesh.verticesCount = this.#wedges;
      mesh.synchronizeInstances();
    }
    geometry._resetPointsArrayCache?.(); // of what rays are asked for
  }

  /** Targets lie where they move vertices to, not by how far. */
  #putTargets({ geometry, own }) {
    const managers = new Set(geometry.meshes.map(({ morphTargetManager }) => morphTargetManager).filter(Boolean));
    if (managers.size === 0) return;
    const values = this.#targetValues(own);
    for (const manager of managers) {
      manager.areUpdatesFrozen = true;
      for (const { target, set, numbers } of values) manager.getTarget(target)?.[set](numbers);
      manager.areUpdatesFrozen = false;
      manager.synchronize();
    }
  }

  #targetValues(own) {
    return this.#stream.attributes.flatMap(({ name, componentCount }, i) => {
      const { target, semantic } = targetOf(name) ?? {};
      const base = this.#stream.attributes.findIndex((format, other) => format.name === semantic && own[other]);
      const set = SET_TARGET[semantic];
      if (!own[i] || !set || (base < 0 && semantic !== 'POSITION')) return [];
      const numbers = Float32Array.from(this.#buffers[1 + i].numbers(this.#wedges));
      const moved = this.#buffers[1 + base].vertices.getFloatData(this.#wedges);
      for (let k = 0; k < numbers.length; ++k) numbers[k] += moved[k];
      return [{ target, set, numbers: semantic === 'COLOR_0' && componentCount === 3 ? withAlpha(numbers) : numbers }];
    });
  }

  /** What is there, as far around it as what is to come may lie, and what lay there before, where targets may move it. */
  #bound({ geometry, box }, { low, high }) {
    const farthest = this.#stream.chunks[this.#stream.chunksReady - 1].deviation;
    const least = Vector3.FromArray(low).subtractFromFloats(farthest, farthest, farthest).minimizeInPlace(box.minimum);
    const most = Vector3.FromArray(high).addInPlaceFromFloats(farthest, farthest, farthest).maximizeInPlace(box.maximum);
    geometry.useBoundingInfoFromGeometry = false; // which is of the file's own level
    for (const mesh of geometry.meshes) {
      // Where the loader, or the page, has had vertices posed for rays to meet them, the new ones are, too.
      if (mesh._internalAbstractMeshDataInfo?._positions) mesh.refreshBoundingInfo({ applySkeleton: true, applyMorph: true });
      mesh.buildBoundingInfo(least, most, mesh.getWorldMatrix());
      if (mesh.hasThinInstances) {
        mesh.rawBoundingInfo = null;
        mesh.thinInstanceRefreshBoundingInfo(true);
      }
      for (const instance of mesh.instances) instance.buildBoundingInfo(least, most, instance.getWorldMatrix());
    }
  }
}

/** Colours of targets have four numbers in Babylon.js. */
function withAlpha(colours) {
  return Float32Array.from({ length: (4 * colours.length) / 3 }, (_, i) => (i % 4 === 3 ? 1 : colours[3 * (i >> 2) + (i % 4)]));
}

/** How a camera of Babylon.js sees: see pixelsAt. */
function viewOf(camera, engine) {
  const { m } = camera.getProjectionMatrix();
  const target = camera.outputRenderTarget;
  const height = (target ? target.getRenderHeight() : engine.getRenderHeight()) * camera.viewport.height;
  return { scale: m[5], isOrthographic: m[15] === 1, height, eye: camera.globalPosition.asArray(), near: camera.minZ };
}

/** How many pixels a unit of the mesh covers at most where one of Babylon's meshes shows it, and at how many places that is. */
function seenBy(shape, mesh, ball, view) {
  const world = shape.computeWorldMatrix().m;
  if (shape.hasThinInstances) {
    const matrices = shape._thinInstanceDataStorage.matrixData;
    return { pixels: pixelsOfInstances(view, world, matrices, shape.thinInstanceCount, ball), places: shape.thinInstanceCount };
  }
  if (!shape.skeleton || mesh.bones.isEmpty) return { pixels: pixelsThrough(view, world, ball), places: 1 };
  return { pixels: mesh.bones.pixels(view, world, shape.skeleton.getTransformMatrices(shape), mesh.farthest), places: 1 };
}

/** The ball around what a mesh of Babylon's draws, before it is moved. */
function ballOf(shape) {
  const { minimum, maximum } = shape.rawBoundingInfo ?? shape.getBoundingInfo();
  return { center: Vector3.Center(minimum, maximum).asArray(), radius: Vector3.Distance(minimum, maximum) / 2 };
}

/** Has all that shows the meshes say, for each camera and frame, how fine they have to be; ends with the last of it. */
function watch(scene, meshes) {
  const see = (camera) => {
    const view = viewOf(camera, scene.getEngine());
    for (const mesh of meshes) {
      for (const shape of mesh.geometries.flatMap((geometry) => geometry.meshes)) {
        const ball = ballOf(shape);
        for (const shown of [shape, ...shape.instances]) {
          if (!isSeen(shown, camera, scene)) continue;
          const { pixels, places } = seenBy(shown, mesh, ball, view);
          mesh.see(pixels, scene.getFrameId(), places);
        }
      }
      if (mesh.geometries.every((geometry) => geometry.isDisposed())) mesh.close();
    }
    if (!meshes.every(({ isClosed }) => isClosed)) return;
    scene.onBeforeCameraRenderObservable.remove(seeing);
    scene.onDisposeObservable.remove(closing);
  };
  const seeing = scene.onBeforeCameraRenderObservable.add(see);
  const closing = scene.onDisposeObservable.add(() => meshes.forEach((mesh) => mesh.close()));
}

function isSeen(shape, camera, scene) {
  if (!shape.isEnabled() || !shape.isVisible || (shape.layerMask & camera.layerMask) === 0) return false;
  return shape.alwaysSelectAsActiveMesh || shape.isInFrustum(scene.frustumPlanes);
}

const refinements = new WeakMap(); // by geometry

/** Returns the Refinement of the file that a mesh of the scene is from, or any below it; undefined for others. */
export function refinementOf(node) {
  const found = [node, ...node.getChildMeshes(false)].map(({ geometry, sourceMesh }) => refinements.get(geometry ?? sourceMesh?.geometry));
  return found.find(Boolean);
}

/** What the loader makes for each file that has streams. */
class LodestoneExtension {
  #loader;
  #options;
  #found = new Map(); // by the number of a mesh: { definition, extension, shapes }

  constructor(loader, options) {
    this.name = EXTENSION;
    this.enabled = true;
    this.#loader = loader;
    this.#options = { pixelError: 1, morph: 0, ...options, ...loader.parent.extensionOptions[EXTENSION] };
    checkRange('morph', this.#options.morph, 0, Number.MAX_SAFE_INTEGER);
  }

  dispose() {
    this.#loader = undefined;
    this.#found.clear();
  }

  /** Primitives are loaded as ever; what they become is remembered. */
  _loadMeshPrimitiveAsync(context, name, node, definition, primitive, assign) {
    const extension = streamOf(definition);
    if (!extension) return null;
    if (!this.#found.has(definition.index)) this.#found.set(definition.index, { definition, extension, shapes: [] });
    const { shapes } = this.#found.get(definition.index);
    return this.#loader._loadMeshPrimitiveAsync(context, name, node, definition, primitive, (shape) => {
      if (!shape.isAnInstance) shapes.push({ shape, primitive: primitive.index });
      assign(shape);
    });
  }

  /** All is there: what shows the meshes says from now on how it is seen. */
  onReady() {
    const meshes = [...this.#found.values()].map((found) => this.#refine(found));
    if (meshes.length === 0) return;
    const refinement = new Refinement(meshes, this.#options);
    for (const geometry of meshes.flatMap(({ geometries }) => geometries)) refinements.set(geometry, refinement);
    watch(this.#loader.babylonScene, meshes);
    this.#options.onLoad?.(refinement);
  }

  #refine({ definition, extension, shapes }) {
    const loader = this.#loader;
    const geometries = new Map(shapes.filter(({ shape }) => shape.geometry).map(({ shape, primitive }) => [shape.geometry, { shape, primitive }]));
    const parts = [...geometries].map(([geometry, { shape, primitive }]) => {
      const { minimum, maximum } = shape.rawBoundingInfo ?? shape.getBoundingInfo();
      return { geometry, primitive, box: { minimum: minimum.clone(), maximum: maximum.clone() } };
    });
    // Nodes that each load the mesh for themselves show the same faces.
    const faces = new Map(parts.map(({ geometry, primitive }) => [primitive, (geometry.getTotalIndices() || geometry.getTotalVertices()) / 3]));
    const shown = { deviation: extension.deviation, faceCount: [...faces.values()].reduce((sum, count) => sum + count, 0) };
    // The loader is gone when its stream is opened.
    const { gltf } = loader;
    const engine = loader.babylonScene.getEngine();
    const sliding = { morph: this.#options.morph, onStep: () => this.#options.onUpdate?.(mesh) };
    const makeBuffers = (stream) => new GeometryBuffers(stream, engine, parts, gltf, definition.primitives, sliding);
    const mesh = new RefinedMesh(this.#locate(extension), shown, this.#options, makeBuffers);
    mesh.geometries = parts.map(({ geometry }) => geometry);
    mesh.primitiveCount = faces.size;
    for (const geometry of mesh.geometries) addBones(mesh.bones, geometry);
    return mesh;
  }

  /** A stream beside the file is fetched part by part; one inside has arrived with it. */
  #locate({ uri, bufferView }) {
    const loader = this.#loader;
    if (uri !== undefined) {
      const { href } = new URL(uri, new URL(loader.rootUrl, globalThis.location?.href));
      return async () => href;
    }
    const bytes = loader.loadBufferViewAsync(`/bufferViews/${bufferView}`, loader.gltf.bufferViews[bufferView]);
    bytes.catch(() => {}); // is told where it is awaited
    return async () => URL.createObjectURL(new Blob([await bytes]));
  }
}

function addBones(bones, geometry) {
  const [joints, weights] = [VertexBuffer.MatricesIndicesKind, VertexBuffer.MatricesWeightsKind].map((kind) => geometry.getVerticesData(kind));
  if (joints && weights) bones.add(geometry.getVerticesData(VertexBuffer.PositionKind), joints, weights);
}

/**
 * Has all files that Babylon.js loads from now on refine themselves: call it once, before. Options, see babylon.d.ts, are
 * those of each file; a load may have its own, `pluginOptions: { gltf: { extensionOptions: { LODESTONE_removal_stream: … } } }`.
 */
export function registerLodestone(options = {}) {
  unregisterGLTFExtension(EXTENSION);
  registerGLTFExtension(EXTENSION, true, (loader) => new LodestoneExtension(loader, options));
}
