import type { AttributeArray, AttributeFormat, Chunk, Level } from './index.js';

/** What a stream fails with. `code` is a name of lodestone.h, such as LODESTONE_MALFORMED, or NETWORK. */
export class LodestoneError extends Error {
  code: string;
  constructor(code: string, message: string);
}

/** Loads the runtime: the module beside this file, or what is given. Each has a memory of its own. */
export function load(source?: WebAssembly.Module | ArrayBuffer | ArrayBufferView | Response): Promise<Runtime>;

/** The module at work: calls do their work at once, in the thread they are made in, and throw LodestoneErrors. */
export class Runtime {
  readonly version: string;
  /** `mostBytes`: what the mesh may take in memory. Default 192 MiB. */
  createStream(options?: { mostBytes?: number }): Stream;
  /** How many pixels a unit of the mesh covers; angles in radians, distance to the object's nearest point. */
  pixelsPerUnit(view: { screenHeight: number; fieldOfView: number; distance: number; scale?: number }): number;
}

export interface StreamState {
  /** Bytes that are due next: those from `dueBegin` on, up to what completes the header or a chunk. */
  dueBegin: number;
  dueEnd: number;
  chunkCount: number;
  chunksReady: number;
  recordCount: number;
  wedgeCount: number;
  groupCount: number;
  attributeCount: number;
  low: number[];
  high: number[];
}

export class Stream {
  readonly state: StreamState;
  /** Takes bytes from `offset` on; those that were there before are skipped. */
  append(offset: number, bytes: Uint8Array): void;
  /** Says that no more bytes come; throws where the stream does not end behind a chunk. */
  finish(): void;
  chunk(index: number): Chunk;
  group(index: number): { material: number; faceCount: number };
  attribute(index: number): AttributeFormat;
  attributeValues(index: number, begin: number, end: number): AttributeArray;
  /** Makes a cursor at the base mesh, once the first chunk is there. */
  createCursor(options?: { slack?: number }): Cursor;
  /** Pre: its cursors have been destroyed. */
  destroy(): void;
}

export class Cursor {
  readonly level: Level;
  seek(position: number): void;
  /** Returns where to go for levels that deviate by at most so much. */
  choose(deviation: number): number;
  /** Shows a group's index buffer, where it lies: until the next call of anything. */
  corners(group: number): Uint32Array;
  /** Returns the ranges of a group's index buffer that may have changed since they were asked for last. */
  changes(group: number, gap?: number): { begin: number; end: number }[];
  /** Returns the ranges of wedges whose positions may have changed since they were asked for last. */
  movedWedges(gap?: number): { begin: number; end: number }[];
  /** Copies the positions that wedges of the stream have at this level, three floats each. */
  positions(begin: number, end: number): Float32Array;
  /** Returns the wedges that are to be uploaded and have not been returned before. */
  newWedges(): { begin: number; end: number };
  /** Returns the wedges that this level has and the one at `position`, which is no finer, has not: from `begin` on what wedge of that each comes from. */
  origins(position: number): { begin: number; origins: Uint32Array };
  /** Returns smooth normals of the level, three floats for each wedge. */
  normals(): Float32Array;
  destroy(): void;
}
