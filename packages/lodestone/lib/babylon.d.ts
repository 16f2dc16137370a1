import type { Geometry } from '@babylonjs/core/Meshes/geometry.js';
import type { Node } from '@babylonjs/core/node.js';
import type * as refined from './refined_mesh.js';

/** A mesh of the file that refines itself. */
export type RefinedMesh = refined.RefinedMesh<Geometry>;

/** What `refinementOf` returns. */
export type Refinement = refined.Refinement<Geometry>;

export interface ExtensionOptions extends refined.RefinementOptions {
  /** Milliseconds in which vertices slide from level to level, instead of jumping; those of meshes with morph targets jump. Default 0: none. */
  morph?: number;
  /** Called when a file has been loaded that refines itself. */
  onLoad?: (refinement: Refinement) => void;
}

/**
 * Has all files that Babylon.js loads from now on refine themselves which `lodestone build --profile stream` has written: call
 * it once, before. A load may have options of its own:
 * `ImportMeshAsync(url, scene, { pluginOptions: { gltf: { extensionOptions: { LODESTONE_removal_stream: { pixelError: 2 } } } } })`.
 */
export function registerLodestone(options?: ExtensionOptions): void;

/** Returns the meshes of the file that a node of the scene, or one below it, is from; undefined for others. */
export function refinementOf(node: Node): Refinement | undefined;
