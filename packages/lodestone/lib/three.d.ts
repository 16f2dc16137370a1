import type { Camera, Group, Material, Sphere } from 'three';
import type { DetailBudget } from './budget.js';
import type { Level, LodestoneStream, StreamOptions } from './index.js';

/** `deviation` is that before the first `update`: Infinity where nothing is said, so that only the beginning is fetched. */
export interface MeshOptions extends Omit<StreamOptions, 'morph'> {
  /** A material, or a function that makes one of a group's number; none: a plain one. */
  material?: Material | ((number: number) => Material);
  /** How many pixels of the picture the error of the level may cover. Default 1; 0: all detail. */
  pixelError?: number;
  /** Says what is wanted in place of `pixelError`: see budget.d.ts. */
  budget?: DetailBudget;
  /** Milliseconds in which vertices slide from level to level, instead of jumping. Default 0: none. */
  morph?: number;
  /** Called when the object has changed: for pages that render only then. */
  onUpdate?: (mesh: LodestoneMesh) => void;
}

/**
 * A mesh that arrives while it is drawn: a group with a mesh for each material. Call `update(camera, height)` before each
 * frame; the level then is the coarsest whose error covers at most `pixelError` pixels of the picture.
 */
export class LodestoneMesh extends Group {
  /** Opens a stream; resolves when its first level can be drawn. */
  static load(url: string | URL, options?: MeshOptions): Promise<LodestoneMesh>;

  pixelError: number;
  /** Rejects with what the stream fails with after it was opened; resolves when the object is disposed of, or `signal` aborted. */
  readonly complete: Promise<void>;
  readonly level: Level;
  readonly stream: LodestoneStream;

  /** How many pixels of a picture of so many pixels' height a unit of the object covers at most. */
  pixelsPerUnit(camera: Camera, height: number): number;
  /** Says how the object is seen: by which camera, in a picture of how many pixels' height. */
  update(camera: Camera, height: number): void;
  /** Stops reading and frees what the object holds, but for its materials. */
  dispose(): void;
}

/** How many pixels a unit of the world covers at a sphere's nearest point. */
export function pixelsPerUnit(camera: Camera, height: number, sphere: Sphere): number;
