// A scene of our own that has what the demo's model lacks: a tube with a texture, a skin, a morph target, animations.
import { deflateSync } from 'node:zlib';
import { joinGlb } from './glb.mjs';

const around = 48;
const along = 64;
const length = 4; // along y, from 0; the joint in the middle bends it
const joint = length / 2;

function crc32(bytes) {
  let crc = ~0;
  for (const byte of bytes) {
    crc ^= byte;
    for (let bit = 0; bit < 8; ++bit) crc = (crc >>> 1) ^ (0xedb88320 & -(crc & 1));
  }
  return ~crc >>> 0;
}

function pngChunk(type, content) {
  const body = Buffer.concat([Buffer.from(type, 'latin1'), content]);
  const framed = Buffer.alloc(body.length + 8);
  framed.writeUInt32BE(content.length, 0);
  body.copy(framed, 4);
  framed.writeUInt32BE(crc32(body), body.length + 4);
  return framed;
}

/** A .png of bands of different greys and widths: no part of it looks like another. */
function makeTexture(size) {
  const rows = Buffer.alloc(size * (size + 1));
  for (let y = 0; y < size; ++y) {
    for (let x = 0; x < size; ++x) rows[y * (size + 1) + 1 + x] = ((x * x) / 512 + y) % 64 < 32 ? 40 + (y / size) * 80 : 230;
  }
  const header = Buffer.from([0, 0, 0, 0, 0, 0, 0, 0, 8, 0, 0, 0, 0]); // eight bits of grey
  header.writeUInt32BE(size, 0);
  header.writeUInt32BE(size, 4);
  const signature = Buffer.from([0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a]);
  const parts = [pngChunk('IHDR', header), pngChunk('IDAT', deflateSync(rows)), pngChunk('IEND', Buffer.alloc(0))];
  return Buffer.concat([signature, ...parts]);
}

/** Collects buffer views and accessors. */
class Store {
  bufferViews = [];
  accessors = [];
  parts = [];
  size = 0;

  view(bytes) {
    const padded = Buffer.concat([bytes, Buffer.alloc((4 - (bytes.length % 4)) % 4)]);
    this.bufferViews.push({ buffer: 0, byteOffset: this.size, byteLength: bytes.length });
    this.parts.push(padded);
    this.size += padded.length;
    return this.bufferViews.length - 1;
  }

  accessor(array, type, extra = {}) {
    const width = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4, MAT4: 16 }[type];
    const componentType = { Float32Array: 5126, Uint16Array: 5123, Uint8Array: 5121 }[array.constructor.name];
    const bufferView = this.view(Buffer.from(array.buffer));
    this.accessors.push({ bufferView, componentType, count: array.length / width, type, ...extra });
    return this.accessors.length - 1;
  }

  floats(rows, type, bounded) {
    const list = rows.map((row) => [row].flat());
    const extreme = (pick) => list[0].map((_, axis) => Math.fround(pick(...list.map((row) => Math.fround(row[axis])))));
    const bounds = bounded ? { min: extreme(Math.min), max: extreme(Math.max) } : {};
    return this.accessor(Float32Array.from(list.flat()), type, bounds);
  }
}

/** Calls `job` for every vertex: its share of the turn and of the length. The seam's vertices are there twice. */
function overVertices(job) {
  const results = [];
  for (let row = 0; row <= along; ++row) {
    for (let column = 0; column <= around; ++column) results.push(job(column / around, row / along));
  }
  return results;
}

const angle = (turn) => 2 * Math.PI * (turn % 1); // both sides of the seam at exactly one place
const radius = (share) => 0.5 + 0.15 * Math.sin(6 * share);

function makeIndices() {
  const indices = [];
  for (let row = 0; row < along; ++row) {
    for (let column = 0; column < around; ++column) {
      const at = row * (around + 1) + column;
      indices.push(at, at + around + 1, at + 1, at + 1, at + around + 1, at + around + 2);
    }
  }
  return Uint16Array.from(indices);
}

/** Makes every third row too short and every seventh nothing. */
function flawed(rows) {
  return rows.map((row, i) => row.map((value) => value * (i % 7 === 0 ? 0 : i % 3 === 0 ? 0.7 : 1)));
}

function makePrimitive(store, spoil) {
  const normal = (turn) => [Math.cos(angle(turn)), 0, Math.sin(angle(turn))];
  const place = (turn, share) => [radius(share) * normal(turn)[0], length * share, radius(share) * normal(turn)[2]];
  const upper = (share) => Math.min(1, Math.max(0, 0.5 + 3 * (share - 0.5)));
  const joints = (turn, share) => (upper(share) === 0 ? [0, 0, 0, 0] : upper(share) === 1 ? [1, 0, 0, 0] : [0, 1, 0, 0]);
  const weights = (turn, share) => (upper(share) % 1 === 0 ? [1, 0, 0, 0] : [1 - upper(share), upper(share), 0, 0]);
  const swell = (turn, share) => normal(turn).map((value) => 0.3 * Math.sin(Math.PI * share) ** 2 * value);
  return {
    attributes: {
      POSITION: store.floats(overVertices(place), 'VEC3', true),
      NORMAL: store.floats(spoil(overVertices(normal)), 'VEC3'),
      TEXCOORD_0: store.floats(overVertices((turn, share) => [turn, share]), 'VEC2'),
      JOINTS_0: store.accessor(Uint8Array.from(overVertices(joints).flat()), 'VEC4'),
      WEIGHTS_0: store.floats(spoil(overVertices(weights)), 'VEC4'),
    },
    targets: [{ POSITION: store.floats(overVertices(swell), 'VEC3', true) }],
    indices: store.accessor(makeIndices(), 'SCALAR'),
    material: 0,
  };
}

function makeAnimation(store, name, node, path, times, values, type) {
  const input = store.floats(times, 'SCALAR', true);
  const output = store.floats(values, type);
  return { name, channels: [{ sampler: 0, target: { node, path } }], samplers: [{ input, output }] };
}

/** Returns the tube as a .glb; `spoil` makes rows of normals and weights of what they ought to be. */
export function makeTube(spoil = (rows) => rows, material = {}) {
  const store = new Store();
  const primitive = makePrimitive(store, spoil);
  const moved = (y) => [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -y, 0, 1];
  const gltf = {
    asset: { version: '2.0' },
    scene: 0,
    scenes: [{ nodes: [0, 1] }],
    nodes: [
      { name: 'tube', mesh: 0, skin: 0 },
      { name: 'lower', children: [2] },
      { name: 'upper', translation: [0, joint, 0] },
    ],
    meshes: [{ name: 'tube', primitives: [primitive], weights: [0] }],
    skins: [{ joints: [1, 2], inverseBindMatrices: store.floats([moved(0), moved(joint)], 'MAT4') }],
    animations: [
      makeAnimation(store, 'Bend', 2, 'rotation', [0, 1], [[0, 0, 0, 1], [0, 0, Math.sin(0.5), Math.cos(0.5)]], 'VEC4'),
      makeAnimation(store, 'Swell', 0, 'weights', [0, 1], [0, 1], 'SCALAR'),
    ],
    materials: [{ ...material, doubleSided: true, pbrMetallicRoughness: { baseColorTexture: { index: 0 }, metallicFactor: 0 } }],
    textures: [{ source: 0 }],
    images: [{ mimeType: 'image/png', bufferView: store.view(makeTexture(256)) }],
    bufferViews: store.bufferViews,
    accessors: store.accessors,
    buffers: [{ byteLength: store.size }],
  };
  return joinGlb(gltf, Buffer.concat(store.parts));
}

/** Parts of a document, joined to a .glb. */
function join(store, parts) {
  const gltf = { asset: { version: '2.0' }, scene: 0, ...parts, bufferViews: store.bufferViews, accessors: store.accessors, buffers: [{ byteLength: store.size }] };
  return joinGlb(gltf, Buffer.concat(store.parts));
}

/** Returns the tube in two halves whose joints have different types, under bones that make it five times as large. */
export function makeMixedTube() {
  const store = new Store();
  const whole = makePrimitive(store, (rows) => rows);
  const [indices] = store.parts.slice(-1);
  const half = (begin, end) => store.accessor(new Uint16Array(indices.buffer.slice(indices.byteOffset + begin, indices.byteOffset + end)), 'SCALAR');
  const middle = indices.length / 2;
  const narrow = store.parts[store.accessors[whole.attributes.JOINTS_0].bufferView];
  const wide = store.accessor(Uint16Array.from(narrow), 'VEC4');
  const moved = (y) => [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -y, 0, 1];
  return join(store, {
    scenes: [{ nodes: [0, 1] }],
    nodes: [
      { name: 'tube', mesh: 0, skin: 0 },
      { name: 'lower', children: [2], scale: [5, 5, 5] },
      { name: 'upper', translation: [0, joint, 0] },
    ],
    meshes: [{
      name: 'tube',
      primitives: [
        { ...whole, targets: undefined, indices: half(0, middle), material: 0 },
        { ...whole, targets: undefined, attributes: { ...whole.attributes, JOINTS_0: wide }, indices: half(middle, indices.length), material: 1 },
      ],
    }],
    skins: [{ joints: [1, 2], inverseBindMatrices: store.floats([moved(0), moved(joint)], 'MAT4') }],
    animations: [makeAnimation(store, 'Bend', 2, 'rotation', [0, 1], [[0, 0, 0, 1], [0, 0, Math.sin(0.5), Math.cos(0.5)]], 'VEC4')],
    materials: [[0.9, 0.3, 0.2, 1], [0.3, 0.5, 0.9, 1]].map((baseColorFactor) => ({ pbrMetallicRoughness: { baseColorFactor, metallicFactor: 0 } })),
  });
}

/** Returns a row of tubes from small to large, instances of one node, and two nodes beside that share the mesh. */
export function makeCrowd() {
  const store = new Store();
  const { attributes: { POSITION, NORMAL, TEXCOORD_0 }, indices } = makePrimitive(store, (rows) => rows);
  const places = [0, 1, 2, 3, 4];
  return join(store, {
    extensionsUsed: ['EXT_mesh_gpu_instancing'],
    extensionsRequired: ['EXT_mesh_gpu_instancing'],
    scenes: [{ nodes: [0, 1, 2] }],
    nodes: [
      {
        mesh: 0,
        extensions: {
          EXT_mesh_gpu_instancing: {
            attributes: {
              TRANSLATION: store.floats(places.map((i) => [2 * i * i, 0, 0]), 'VEC3'),
              SCALE: store.floats(places.map((i) => [1 + i, 1 + i, 1 + i]), 'VEC3'),
            },
          },
        },
      },
      { mesh: 1, translation: [-2, 0, 3], scale: [0.5, 0.5, 0.5] },
      { mesh: 1, translation: [6, 0, 12], scale: [2, 2, 2] },
    ],
    meshes: [0, 1].map((material) => ({ primitives: [{ attributes: { POSITION, NORMAL, TEXCOORD_0 }, indices, material }] })),
    materials: [[0.9, 0.6, 0.2, 1], [0.3, 0.8, 0.5, 1]].map((baseColorFactor) => ({ pbrMetallicRoughness: { baseColorFactor, metallicFactor: 0 } })),
  });
}

/** Returns the tube with normals and weights that are off, and a normal map without tangents. */
export function makeFlawedTube() {
  return makeTube(flawed, { normalTexture: { index: 0 } });
}
