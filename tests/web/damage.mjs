// Spoils the coarser levels of a .glb in ways that a check of pictures must see. Only for files without Draco.
import { joinGlb, lodChains, splitGlb } from './glb.mjs';

/** A small generator with a seed: the same damage in every run. */
function makeRandom(seed) {
  let state = seed;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 2 ** 32;
  };
}

/** Returns the meshes of every level but the finest, with a length in the scene as one of theirs. */
function coarserMeshes(gltf) {
  const found = new Map();
  for (const [, ...coarser] of lodChains(gltf)) {
    coarser.forEach((node, i) => {
      const { mesh, extras } = gltf.nodes[node];
      if (mesh === undefined) return;
      found.set(mesh, { mesh: gltf.meshes[mesh], level: i + 1, scale: extras.lodestone.world_scale });
    });
  }
  return [...found.values()];
}

function floatsOf(gltf, bin, accessor) {
  const { bufferView, byteOffset = 0, count, type } = gltf.accessors[accessor];
  const view = gltf.bufferViews[bufferView];
  const width = Number(type.slice(3));
  if (gltf.accessors[accessor].componentType !== 5126) throw new Error(`accessor ${accessor} does not hold floats`);
  const stride = view.byteStride ?? 4 * width;
  const start = (view.byteOffset ?? 0) + byteOffset;
  const at = (i, component) => start + i * stride + 4 * component;
  return {
    count,
    get: (i) => Array.from({ length: width }, (_, component) => bin.readFloatLE(at(i, component))),
    set: (i, values) => values.forEach((value, component) => bin.writeFloatLE(value, at(i, component))),
  };
}

/** Permutes the texture coordinates of every coarser level. */
export function scrambleTextures(bytes) {
  const { gltf, bin } = splitGlb(bytes);
  const random = makeRandom(1);
  const accessors = new Set(coarserMeshes(gltf).flatMap(({ mesh }) =>
    mesh.primitives.map(({ attributes }) => attributes.TEXCOORD_0)).filter((accessor) => accessor !== undefined));
  for (const accessor of accessors) {
    const values = floatsOf(gltf, bin, accessor);
    for (let i = values.count - 1; i > 0; --i) {
      const j = Math.floor(random() * (i + 1));
      const kept = values.get(i);
      values.set(i, values.get(j));
      values.set(j, kept);
    }
  }
  return joinGlb(gltf, bin);
}

/** Appends an accessor like another, its positions moved; returns its index. */
function appendMoved(gltf, parts, bin, accessor, offset) {
  const source = floatsOf(gltf, bin, accessor);
  const moved = Buffer.alloc(12 * source.count);
  const plus = (value, axis) => value + offset[axis];
  for (let i = 0; i < source.count; ++i) {
    source.get(i).map(plus).forEach((value, axis) => moved.writeFloatLE(value, 12 * i + 4 * axis));
  }
  gltf.bufferViews.push({ buffer: 0, byteOffset: parts.size, byteLength: moved.length });
  parts.list.push(moved);
  parts.size += moved.length;
  const { min, max, ...rest } = gltf.accessors[accessor];
  gltf.accessors.push({
    ...rest, bufferView: gltf.bufferViews.length - 1, byteOffset: 0,
    min: min.map(plus), max: max.map(plus),
  });
  return gltf.accessors.length - 1;
}

/** Cuts a primitive into runs of triangles and takes every other one from moved positions. */
function cutPrimitive(gltf, parts, bin, primitive, offset, runs) {
  const moved = appendMoved(gltf, parts, bin, primitive.attributes.POSITION, offset);
  const indices = gltf.accessors[primitive.indices];
  const bytesEach = { 5121: 1, 5123: 2, 5125: 4 }[indices.componentType];
  const triangles = indices.count / 3;
  const edges = Array.from({ length: runs + 1 }, (_, run) => Math.round(triangles * run / runs));
  return edges.slice(1).map((end, run) => ({ run, first: edges[run], end })).filter(({ first, end }) => end > first)
    .map(({ run, first, end }) => {
      const { min, max, ...rest } = indices;
      gltf.accessors.push({
        ...rest, byteOffset: (indices.byteOffset ?? 0) + 3 * first * bytesEach, count: 3 * (end - first),
      });
      const attributes = run % 2 === 0 ? primitive.attributes : { ...primitive.attributes, POSITION: moved };
      return { ...primitive, attributes, indices: gltf.accessors.length - 1 };
    });
}

// About at right angles to where the pictures are taken from: a gap along the view is none.
const across = [1, 1, -1].map((component) => component / Math.sqrt(3));

/** Opens cracks in every coarser level, as wide as `widths` says for the level, in the scene's units. */
export function openCracks(bytes, widths) {
  const { gltf, bin } = splitGlb(bytes);
  const parts = { list: [bin], size: bin.length };
  const runs = 40;
  for (const { mesh, level, scale } of coarserMeshes(gltf)) {
    const offset = across.map((component) => component * widths[level] / scale);
    mesh.primitives = mesh.primitives.flatMap((primitive) => cutPrimitive(gltf, parts, bin, primitive, offset, runs));
  }
  gltf.buffers[0].byteLength = parts.size;
  return joinGlb(gltf, Buffer.concat(parts.list));
}
