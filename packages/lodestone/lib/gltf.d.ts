import type { BufferGeometry } from 'three';
import type { GLTF, GLTFLoaderPlugin, GLTFParser } from 'three/addons/loaders/GLTFLoader.js';
import type { Level } from './index.js';

export interface PluginOptions {
  /** How many pixels of the picture the error of a mesh may cover. Default 1; 0: all detail. */
  pixelError?: number;
  /** Called when a mesh has changed: for pages that render only then. */
  onUpdate?: (mesh: RefinedMesh) => void;
  /** Whether to decode in a worker. Default: where there are workers. */
  worker?: boolean;
  /** In place of the page's own; without a worker only. */
  fetch?: typeof fetch;
}

/** A mesh of the file that refines itself. */
export interface RefinedMesh {
  readonly geometries: BufferGeometry[];
  /** The level of its stream that is drawn; undefined while it is the one that the file shows by itself. */
  readonly level: Level | undefined;
  /** How many bytes of the stream have been decoded. */
  readonly bytes: number;
  /** Resolves when all of the stream has been decoded, which need not be wanted, or nothing more is read; rejects with what it fails with. */
  readonly complete: Promise<void>;
}

/** What `gltf.userData.lodestone` is. */
export interface Refinement {
  readonly meshes: RefinedMesh[];
  pixelError: number;
  /** Stops reading; what is drawn stays, to be disposed of as all that was loaded. */
  dispose(): void;
}

/**
 * For three.js's GLTFLoader: `loader.register((parser) => new LodestonePlugin(parser))`. Meshes of files that
 * `lodestone build --profile stream` has written refine themselves as they are rendered.
 */
export class LodestonePlugin implements GLTFLoaderPlugin {
  constructor(parser: GLTFParser, options?: PluginOptions);
  readonly name: string;
  afterRoot(gltf: GLTF): null;
}
