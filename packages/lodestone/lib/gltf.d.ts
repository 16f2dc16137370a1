import type { BufferGeometry } from 'three';
import type { GLTF, GLTFLoaderPlugin, GLTFParser } from 'three/addons/loaders/GLTFLoader.js';
import type * as refined from './refined_mesh.js';

export interface PluginOptions extends refined.RefinementOptions {
  /** Milliseconds in which vertices slide from level to level, instead of jumping. Default 0: none. */
  morph?: number;
}

/** A mesh of the file that refines itself. */
export type RefinedMesh = refined.RefinedMesh<BufferGeometry>;

/** What `gltf.userData.lodestone` is. */
export type Refinement = refined.Refinement<BufferGeometry>;

/**
 * For three.js's GLTFLoader: `loader.register((parser) => new LodestonePlugin(parser))`. Meshes of files that
 * `lodestone build --profile stream` has written refine themselves as they are rendered.
 */
export class LodestonePlugin implements GLTFLoaderPlugin {
  constructor(parser: GLTFParser, options?: PluginOptions);
  readonly name: string;
  afterRoot(gltf: GLTF): null;
}
