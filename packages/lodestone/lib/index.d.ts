export { LodestoneError } from './wasm.js';

/** A part of a stream, and the level that the parts up to it lead to. */
export interface Chunk {
  /** Bytes of the stream: [byteBegin, byteEnd). */
  byteBegin: number;
  byteEnd: number;
  position: number;
  vertexCount: number;
  faceCount: number;
  /** How far that level lies from the whole mesh at most, in its units. */
  deviation: number;
}

export interface Level {
  /** How many vertices have been refined. */
  position: number;
  vertexCount: number;
  /** Of the vertex buffers, the level uses the first so many. */
  wedgeCount: number;
  faceCount: number;
  /** How far it lies from the whole mesh at most, in its units. */
  deviation: number;
}

/** A vertex attribute, as glTF has them. */
export interface AttributeFormat {
  name: string;
  componentType: 5120 | 5121 | 5122 | 5123 | 5125 | 5126;
  componentCount: number;
  normalized: boolean;
}

export type AttributeArray = Int8Array | Uint8Array | Int16Array | Uint16Array | Uint32Array | Float32Array;

/** What changed between a level and the one before it, which may be the same: then it says where the stream stands. */
export interface Update {
  level: Level;
  /** Vertices that are new: [begin, end) of the vertex buffers. */
  wedges: { begin: number; end: number; positions: Float32Array; attributes: AttributeArray[] };
  /** Vertices before those that lie elsewhere now, from `begin` on; their attributes stay. */
  moved: { begin: number; positions: Float32Array }[];
  /** By group: how many entries of its index buffer are drawn, and those that are others now. */
  groups: { count: number; ranges: { begin: number; corners: Uint32Array }[] }[];
  /** Where they were asked for: of all wedges of the level, if that is another one. */
  normals: Float32Array | null;
  /** Where it was asked for: what wedges that only the finer of the two levels has, from `begin` on, come from: wedges of the
   * coarser one, at which they begin to slide, or end where this level is the coarser one; themselves where they are to stay. */
  morph: { begin: number; origins: Uint32Array } | null;
  /** A box around all vertices that have arrived. */
  low: [number, number, number];
  high: [number, number, number];
  /** Bytes that have arrived. */
  bytes: number;
  /** Chunks that have been decoded. */
  chunksReady: number;
  /** Whether no more will come: all has, or the source has no more. */
  ended: boolean;
  /** What was given to `want`, if this level is what comes of that; else others are to follow. */
  settled: number | undefined;
}

export interface StreamOptions {
  /** What levels may deviate by at first: see `want`. Default 0. */
  deviation?: number;
  /** How many times finer than asked for a level may be before a coarser one is chosen. Default 1.3. */
  slack?: number;
  /** Work out smooth normals for each update, for streams without NORMAL. Default false. */
  normals?: boolean;
  /** Say in each update what wedges come from, for vertices to slide: see `Update.morph`. Default false. */
  morph?: boolean;
  /** What the mesh may take in memory, in bytes; one that takes more fails with LODESTONE_LIMIT_EXCEEDED. Default 192 MiB:
   * decoding takes about six times as much, and all streams of a page share 2 GiB. */
  mostBytes?: number;
  /** Read and decode in a worker. Default true where there are workers. */
  worker?: boolean;
  /** Gives it up: before it is open, `open` rejects with the signal's reason; afterwards the stream is closed. */
  signal?: AbortSignal;
  /** Milliseconds after which a request that brings nothing is given up. It is made again, and what fails three times in a row fails the stream with
   * NETWORK. One that has not been answered yet is not given up while other streams' bring something: a browser may keep it waiting for
   * a connection. Default 30,000; 0 or Infinity: no limit. */
  idleTimeout?: number;
  /** Without a worker: the WebAssembly module, where it is not the one beside this file. */
  module?: WebAssembly.Module | ArrayBuffer | ArrayBufferView | Response;
  /** Without a worker: what fetches. */
  fetch?: typeof fetch;
}

/**
 * A mesh that arrives. Iterate over it to get updates, each with what changed since the one before:
 * `for await (const update of stream)`. The next is made when it is asked for. Iteration ends when the stream is closed,
 * and throws what it fails with; a stream whose bytes have all arrived goes on, since what is wanted may change.
 */
export class LodestoneStream implements AsyncIterable<Update> {
  /** Opens a stream; resolves when it can be drawn, which is after its first kilobytes. Rejects with a LodestoneError,
   * a RangeError where an option is out of its range, or `signal`'s reason. */
  static open(url: string | URL, options?: StreamOptions): Promise<LodestoneStream>;

  readonly chunks: Chunk[];
  /** Each has an index buffer; `material` is a number of whoever made the stream. */
  readonly groups: { material: number }[];
  readonly attributes: AttributeFormat[];
  /** Of the last update, as the next. */
  readonly level: Level;
  readonly low: [number, number, number];
  readonly high: [number, number, number];
  readonly bytes: number;
  readonly chunksReady: number;
  /** Also where it has failed, or is closed. */
  readonly ended: boolean;
  readonly settled: number | undefined;
  /** Whether all of it has been decoded. */
  readonly complete: boolean;

  /** Says how far levels may lie from the whole mesh, in its units; 0 is the whole, Infinity the base mesh. What is not
   * needed is not fetched where the server answers range requests. Throws a RangeError for what is negative or NaN. */
  want(deviation: number): void;
  /** Returns the next update; undefined once the stream is closed. Several may be asked for at once. */
  next(): Promise<Update | undefined>;
  close(): void;
  [Symbol.asyncIterator](): AsyncIterator<Update>;
}
