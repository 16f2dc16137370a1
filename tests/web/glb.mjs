// What a multi-LOD .glb says about itself, read without any of the clients.
import { readFile } from 'node:fs/promises';

const JSON_CHUNK = 0x4e4f534a;

/** Returns the JSON of a .glb. */
export function parseGlb(bytes) {
  if (bytes.toString('latin1', 0, 4) !== 'glTF') throw new Error('not a .glb');
  if (bytes.readUInt32LE(16) !== JSON_CHUNK) throw new Error('the first chunk is not JSON');
  return JSON.parse(bytes.toString('utf8', 20, 20 + bytes.readUInt32LE(12)));
}

/** Returns the nodes of each level, finest first: the node that has MSFT_lod, then its ids. */
export function levelNodes(gltf) {
  const finest = gltf.nodes.findIndex((node) => node.extensions?.MSFT_lod);
  if (finest < 0) throw new Error('no node has MSFT_lod');
  return [finest, ...gltf.nodes[finest].extensions.MSFT_lod.ids];
}

function trianglesOfAccessors(gltf, node) {
  const primitives = gltf.meshes[gltf.nodes[node].mesh].primitives;
  return primitives.reduce((sum, primitive) => sum + gltf.accessors[primitive.indices].count / 3, 0);
}

/** Returns what the file says of its levels, finest first: node, triangles by its accessors, extras; and if it uses Draco. */
export async function readLevels(path) {
  const gltf = parseGlb(await readFile(path));
  const levels = levelNodes(gltf).map((node) => ({
    node,
    triangles: trianglesOfAccessors(gltf, node),
    extras: gltf.nodes[node].extras?.lodestone ?? {},
  }));
  return { levels, draco: (gltf.extensionsUsed ?? []).includes('KHR_draco_mesh_compression') };
}
