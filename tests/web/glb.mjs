// What a multi-LOD file says about itself, read without any of the clients.
import { readFile } from 'node:fs/promises';

const JSON_CHUNK = 0x4e4f534a;
const BINARY_CHUNK = 0x004e4942;

/** Returns the JSON of a .glb. */
export function parseGlb(bytes) {
  if (bytes.toString('latin1', 0, 4) !== 'glTF') throw new Error('not a .glb');
  if (bytes.readUInt32LE(16) !== JSON_CHUNK) throw new Error('the first chunk is not JSON');
  return JSON.parse(bytes.toString('utf8', 20, 20 + bytes.readUInt32LE(12)));
}

/** Returns the JSON of a .glb or .gltf. */
export async function readDocument(path) {
  const bytes = await readFile(path);
  return path.endsWith('.gltf') ? JSON.parse(bytes.toString('utf8')) : parseGlb(bytes);
}

/** Returns the JSON of a .glb and a copy of its binary chunk. */
export function splitGlb(bytes) {
  const json = bytes.readUInt32LE(12);
  return { gltf: parseGlb(bytes), bin: Buffer.from(bytes.subarray(28 + json)) };
}

function chunk(type, content, filler) {
  const padding = Buffer.alloc((4 - (content.length % 4)) % 4, filler);
  const head = Buffer.alloc(8);
  head.writeUInt32LE(content.length + padding.length, 0);
  head.writeUInt32LE(type, 4);
  return Buffer.concat([head, content, padding]);
}

/** Returns a .glb of the two. */
export function joinGlb(gltf, bin) {
  const chunks = Buffer.concat([chunk(JSON_CHUNK, Buffer.from(JSON.stringify(gltf)), ' '), chunk(BINARY_CHUNK, bin, 0)]);
  const head = Buffer.from('glTF\x02\0\0\0\0\0\0\0', 'latin1');
  head.writeUInt32LE(head.length + chunks.length, 8);
  return Buffer.concat([head, chunks]);
}

/** Returns the nodes of every MSFT_lod, each list finest first: the node that has it, then its ids. */
export function lodChains(gltf) {
  const chains = gltf.nodes.flatMap((node, index) =>
    (node.extensions?.MSFT_lod ? [[index, ...node.extensions.MSFT_lod.ids]] : []));
  if (chains.length === 0) throw new Error('no node has MSFT_lod');
  return chains;
}

/** Returns the nodes of each level, finest first, where the file has one mesh: those of the first MSFT_lod. */
export function levelNodes(gltf) {
  return lodChains(gltf)[0];
}

/** Returns the triangles that a node's mesh has by its accessors; points and lines do not count. */
export function trianglesOfAccessors(gltf, node) {
  if (gltf.nodes[node].mesh === undefined) return 0;
  const triangles = gltf.meshes[gltf.nodes[node].mesh].primitives.filter(({ mode = 4 }) => mode === 4);
  return triangles.reduce((sum, primitive) => sum + gltf.accessors[primitive.indices].count / 3, 0);
}

/** Returns the nodes that a file's scene shows. */
function shownNodes(gltf) {
  const waiting = [...(gltf.scenes[gltf.scene ?? 0].nodes ?? [])];
  for (let i = 0; i < waiting.length; ++i) waiting.push(...(gltf.nodes[waiting[i]].children ?? []));
  return waiting;
}

/** Returns the triangles of the whole scene at each level, finest first; a node without MSFT_lod counts in all. */
export function trianglesOfScene(gltf) {
  const chains = shownNodes(gltf).map((node) => [node, ...(gltf.nodes[node].extensions?.MSFT_lod?.ids ?? [])]);
  const levels = Math.max(...chains.map((chain) => chain.length));
  return Array.from({ length: levels }, (_, level) => chains.reduce((sum, chain) =>
    sum + trianglesOfAccessors(gltf, chain[Math.min(level, chain.length - 1)]), 0));
}

/** Returns what a file's geometry is compressed by. */
function compressionOf({ extensionsUsed = [] }) {
  if (extensionsUsed.includes('KHR_draco_mesh_compression')) return 'draco';
  return extensionsUsed.includes('EXT_meshopt_compression') ? 'meshopt' : 'none';
}

/** Returns what the file says of its levels, finest first: node, triangles by its accessors, extras; and its compression. */
export async function readLevels(path) {
  const gltf = await readDocument(path);
  const levels = levelNodes(gltf).map((node) => ({
    node,
    triangles: trianglesOfAccessors(gltf, node),
    extras: gltf.nodes[node].extras?.lodestone ?? {},
  }));
  return { levels, compression: compressionOf(gltf) };
}
