import type { Chunk, Level } from './index.js';

/**
 * What a budget can be shared by: a LodestoneStream, which should be opened with `slack: 1`, or a mesh of a file that refines
 * itself.
 */
export interface BudgetMember {
  /** Undefined before it is opened. */
  readonly chunks?: Chunk[];
  /** How many of them have been decoded. */
  readonly chunksReady?: number;
  /** What is drawn; undefined where that is none of its stream's levels. */
  readonly level?: Level;
  /** What is drawn then. */
  readonly shown?: { deviation: number; faceCount: number };
  /** Of what has been decoded. */
  readonly bytes?: number;
  /** Whether no more will come: whoever waits for what will not would keep others from coming. */
  readonly ended?: boolean;
  /** What was given to `want`, if what is drawn is what comes of that. A member without it is thought to take 0.15 s. */
  readonly settled?: number;
  want(deviation: number): void;
}

export interface BudgetOptions {
  /** How many triangles may be drawn, at all places together. Default Infinity. What is coarsest is drawn, even where it has more. */
  triangles?: number;
  /** How many bytes may be decoded. Default Infinity. What meshes begin with counts, but is not held back. */
  bytes?: number;
  /** No error needs to be smaller, in pixels. Default 1. */
  pixelError?: number;
  /** For how many meshes bytes may be on their way at once. Default 2. */
  atOnce?: number;
}

/**
 * Several meshes that share what may be drawn and fetched. All get the same error in pixels, the smallest for which there are
 * triangles enough, and the next chunks are fetched for those meshes whose error in pixels is the greatest.
 *
 * In each frame, say by `see` how large each mesh is in the picture (LodestoneMesh and the loaders of glTF do, where they
 * were given a budget), then call `update`. How many faces a level has that has not been drawn yet is estimated, so that it
 * takes some updates until the triangles drawn are as many as they may be.
 */
export class DetailBudget {
  constructor(options?: BudgetOptions);
  /** May be changed at any time, as the next three. */
  triangles: number;
  bytes: number;
  pixelError: number;
  atOnce: number;

  add(member: BudgetMember): void;
  remove(member: BudgetMember): void;
  /** Says that a mesh is seen, at so many places: `pixels` are those that a unit of it covers at most. */
  see(member: BudgetMember, pixels: number, places?: number): void;
  /** Says to each mesh how fine it may be. Those that have not been seen for 0.3 s are let go coarse. */
  update(): void;

  /** The error that all meshes may have, in pixels, by the last update; those whose bytes are still to come have a greater one. */
  readonly error: number;
  /** Triangles that are drawn, where all that was seen last is. */
  readonly drawn: number;
  /** Bytes that have been decoded. */
  readonly fetched: number;
  /** Whether bytes that are wanted are still to come: what is drawn then is not yet what it will be. */
  readonly isWaiting: boolean;
}
