// A glTF scene in three.js whose levels can be put in place one after the other: GLTFLoader knows nothing of MSFT_lod.
import { DRACOLoader } from 'three/addons/loaders/DRACOLoader.js';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { MeshoptDecoder } from 'three/addons/libs/meshopt_decoder.module.js';

/** A loader that has a decoder for one compression alone: 'draco', 'meshopt' or 'none'. */
export function makeLoader(compression) {
  const loader = new GLTFLoader();
  if (compression === 'meshopt') loader.setMeshoptDecoder(MeshoptDecoder);
  if (compression === 'draco') {
    const draco = new DRACOLoader();
    draco.setDecoderPath('/node_modules/three/examples/jsm/libs/draco/gltf/');
    loader.setDRACOLoader(draco);
  }
  return loader;
}

/** Returns the objects of every MSFT_lod that the scene shows, each list finest first, and what they hang from. */
async function loadChains(gltf) {
  const nodes = (gltf.parser.json.nodes ?? []).map((node, index) => ({ index, ids: node.extensions?.MSFT_lod?.ids }));
  const chains = await Promise.all(nodes.filter(({ ids }) => ids).map(({ index, ids }) =>
    Promise.all([index, ...ids].map((id) => gltf.parser.getDependency('node', id)))));
  return chains.map((objects) => ({ objects, holder: objects[0].parent })).filter(({ holder }) => holder);
}

/** A loaded file; `show` puts one level of every chain in place. */
export class LevelScene {
  constructor(gltf, chains) {
    this.root = gltf.scene;
    this.animations = gltf.animations;
    this.chains = chains;
    this.levelCount = Math.max(1, ...chains.map(({ objects }) => objects.length));
  }

  /** Chains that are shorter show their coarsest. */
  show(level) {
    for (const { objects, holder } of this.chains) {
      holder.remove(...objects);
      holder.add(objects[Math.min(level, objects.length - 1)]);
    }
    this.root.updateMatrixWorld(true);
  }

  meshes() {
    const found = [];
    this.root.traverse((object) => object.isMesh && found.push(object));
    return found;
  }

  dispose() {
    for (let level = 0; level < this.levelCount; ++level) {
      this.show(level);
      this.meshes().forEach(disposeMesh);
    }
  }
}

function disposeMesh({ geometry, material, skeleton }) {
  geometry.dispose();
  skeleton?.dispose();
  for (const value of Object.values(material)) {
    if (!value?.isTexture) continue;
    value.dispose();
    value.source.data?.close?.(); // an ImageBitmap, which would stay in memory
  }
  material.dispose();
}

/** Opens a glTF file as `makeLoader` says. */
export async function openScene(url, compression) {
  const gltf = await makeLoader(compression).loadAsync(url);
  return new LevelScene(gltf, await loadChains(gltf));
}
