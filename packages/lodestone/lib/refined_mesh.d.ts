import type { DetailBudget } from './budget.js';
import type { Chunk, Level } from './index.js';

/** What the loaders of all engines take. */
export interface RefinementOptions {
  /** How many pixels of the picture the error of a mesh may cover. Default 1; 0: all detail. */
  pixelError?: number;
  /** Says how fine each mesh is in place of `pixelError`: see budget.d.ts. */
  budget?: DetailBudget;
  /** Called when a mesh has changed: for pages that render only then. */
  onUpdate?: (mesh: RefinedMesh) => void;
  /** Whether to decode in a worker. Default: where there are workers. */
  worker?: boolean;
  /** Milliseconds after which a request that brings nothing is given up: see `StreamOptions` in index.d.ts. Default 30,000; 0 or Infinity: no limit. */
  idleTimeout?: number;
  /** In place of the page's own; without a worker only. */
  fetch?: typeof fetch;
}

/** A mesh of the file that refines itself. */
export interface RefinedMesh<Geometry = unknown> {
  readonly geometries: Geometry[];
  /** The level of its stream that is drawn; undefined while it is the one that the file shows by itself. */
  readonly level: Level | undefined;
  /** The level that the file shows by itself. */
  readonly shown: { deviation: number; faceCount: number };
  /** Of its stream, once that has been opened. */
  readonly chunks: Chunk[] | undefined;
  /** How many of them have been decoded. */
  readonly chunksReady: number;
  /** How many bytes of the stream have been decoded. */
  readonly bytes: number;
  /** Resolves when all of the stream has been decoded, which need not be wanted, or nothing more is read; rejects with what it fails with. */
  readonly complete: Promise<void>;
  /** Whether nothing more is read, since all that shows it has been disposed of, or it has been said so. */
  readonly isClosed: boolean;
  /** Says how far it may lie from the whole, in its units: what is seen of it, or a budget, says so in each frame. */
  want(deviation: number): void;
}

/** A file's meshes. */
export interface Refinement<Geometry = unknown> {
  readonly meshes: RefinedMesh<Geometry>[];
  /** Of no effect with a budget. */
  pixelError: number;
  /** Stops reading; what is drawn stays, to be disposed of as all that was loaded. */
  dispose(): void;
}
