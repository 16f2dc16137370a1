// The runtime itself: the WebAssembly module with classes around it. Calls do their work at once, in the thread they are
// made in; index.js has them made in a worker. What streams, cursors and their numbers are: lodestone/lodestone.h.

/** What a stream fails with. `code` is a name of lodestone.h, such as LODESTONE_MALFORMED, or NETWORK. */
export class LodestoneError extends Error {
  constructor(code, message) {
    super(message);
    this.name = 'LodestoneError';
    this.code = code;
  }
}

/** Throws a RangeError for a number that is below `least` or above `most`, or none: the module would end at it. */
export function checkRange(name, number, least, most) {
  if (!(number >= least && number <= most)) throw new RangeError(`${name} is ${number}`);
}

const MOST_BYTES = 192 << 20; // of a mesh: decoding takes about six times as much, and the module's memory ends at 2 GiB

const COMPONENTS = { 5120: Int8Array, 5121: Uint8Array, 5122: Int16Array, 5123: Uint16Array, 5125: Uint32Array, 5126: Float32Array };

/** Compiles the module: the one beside this file, or what is given as bytes, a Response or a WebAssembly.Module. */
async function compile(source) {
  if (source instanceof WebAssembly.Module) return source;
  if (source instanceof ArrayBuffer || ArrayBuffer.isView(source)) return WebAssembly.compile(source);
  const response = source ?? (await fetch(new URL('lodestone.wasm', import.meta.url)));
  if (!response.ok) {
    response.body?.cancel().catch(() => {}); // its connection is for others
    throw new LodestoneError('NETWORK', `${response.url}: ${response.status} ${response.statusText}`);
  }
  return WebAssembly.compile(await response.arrayBuffer());
}

/** Loads the runtime. Each has a memory of its own. */
export async function load(source) {
  return new Runtime(await compile(source));
}

/** The module at work. */
export class Runtime {
  #failure; // what it ended with

  constructor(module) {
    const imports = {};
    for (const { module: from, name, kind } of WebAssembly.Module.imports(module)) {
      if (kind !== 'function') continue;
      imports[from] ??= {};
      // It grows its memory and, where there is none left, ends; it opens and prints nothing.
      imports[from][name] = name === 'emscripten_notify_memory_growth' ? () => {} : () => 52; // "not supported"
    }
    this.exports = new WebAssembly.Instance(module, imports).exports;
    this.call('_initialize');
    this.resultsAt = this.exports.results();
  }

  /** Calls an export. One that ends inside has run out of memory: the runtime is of no use any more. */
  call(name, ...values) {
    if (this.#failure) throw this.#failure;
    try {
      return this.exports[name](...values);
    } catch (error) {
      if (!(error instanceof WebAssembly.RuntimeError)) throw error;
      this.#failure = new LodestoneError('LODESTONE_OUT_OF_MEMORY', `${name}: ${error.message}`);
      throw this.#failure;
    }
  }

  get version() {
    const number = this.call('version');
    return `${Math.floor(number / 1e6)}.${Math.floor(number / 1000) % 1000}.${number % 1000}`;
  }

  /** What the last call gave, `count` numbers. */
  results(count) {
    return Array.from(new Float64Array(this.exports.memory.buffer, this.resultsAt, count));
  }

  text(at) {
    const bytes = new Uint8Array(this.exports.memory.buffer, at);
    return new TextDecoder().decode(bytes.subarray(0, bytes.indexOf(0)).slice());
  }

  /** Has `job` write `count` elements to memory of the module, and returns a copy of them. */
  take(Type, count, job) {
    const bytes = count * Type.BYTES_PER_ELEMENT;
    const at = this.allocate(bytes);
    try {
      job(at);
      return new Type(this.exports.memory.buffer, at, count).slice();
    } finally {
      this.release(at);
    }
  }

  allocate(bytes) {
    const at = this.call('allocate', Math.max(bytes, 1)) >>> 0;
    if (at === 0) throw new LodestoneError('LODESTONE_OUT_OF_MEMORY', `${bytes} bytes`);
    return at;
  }

  release(at) {
    if (!this.#failure) this.call('release', at); // where it has ended, that is what is to be told
  }

  pixelsPerUnit({ screenHeight, fieldOfView, distance, scale = 1 }) {
    return this.call('pixels_per_unit', screenHeight, fieldOfView, distance, scale);
  }

  createStream({ mostBytes = MOST_BYTES } = {}) {
    return new Stream(this, mostBytes);
  }
}

export class Stream {
  constructor(runtime, mostBytes) {
    checkRange('mostBytes', mostBytes, 1, Number.MAX_SAFE_INTEGER);
    this.runtime = runtime;
    this.handle = runtime.call('stream_create', mostBytes);
    if (this.handle === 0) throw new LodestoneError('LODESTONE_OUT_OF_MEMORY', 'no stream');
  }

  destroy() {
    if (this.handle !== 0) this.runtime.call('stream_destroy', this.handle);
    this.handle = 0;
  }

  /** Calls a function of the stream or of one of its cursors, and throws what it fails with. */
  run(name, handle, ...values) {
    const { runtime } = this;
    const code = runtime.call(name, handle, ...values);
    if (code === 0) return;
    throw new LodestoneError(runtime.text(runtime.call('code_name', code)), runtime.text(runtime.call('stream_message', this.handle)));
  }

  /** Takes bytes from `offset` on, an Uint8Array. */
  append(offset, bytes) {
    const { runtime } = this;
    checkRange('offset', offset, 0, Number.MAX_SAFE_INTEGER);
    const at = runtime.allocate(bytes.length);
    try {
      new Uint8Array(runtime.exports.memory.buffer, at, bytes.length).set(bytes);
      this.run('stream_append', this.handle, offset, at, bytes.length);
    } finally {
      runtime.release(at);
    }
  }

  finish() {
    this.run('stream_finish', this.handle);
  }

  get state() {
    this.run('stream_state', this.handle);
    const [dueBegin, dueEnd, chunkCount, chunksReady, recordCount, wedgeCount, groupCount, attributeCount, ...box] = this.runtime.results(14);
    return { dueBegin, dueEnd, chunkCount, chunksReady, recordCount, wedgeCount, groupCount, attributeCount, low: box.slice(0, 3), high: box.slice(3) };
  }

  chunk(index) {
    this.run('stream_chunk', this.handle, index);
    const [byteBegin, byteEnd, position, vertexCount, faceCount, deviation] = this.runtime.results(6);
    return { byteBegin, byteEnd, position, vertexCount, faceCount, deviation };
  }

  group(index) {
    this.run('stream_group', this.handle, index);
    const [material, faceCount] = this.runtime.results(2);
    return { material, faceCount };
  }

  attribute(index) {
    this.run('stream_attribute', this.handle, index);
    const [name, componentType, componentCount, normalized] = this.runtime.results(4);
    return { name: this.runtime.text(name), componentType, componentCount, normalized: normalized !== 0 };
  }

  /** Copies an attribute of wedges, in an array of its own type. */
  attributeValues(index, begin, end) {
    const { componentType, componentCount } = this.attribute(index);
    const Type = COMPONENTS[componentType];
    const count = componentCount * (end - begin);
    return this.runtime.take(Type, count, (at) =>
      this.run('stream_attribute_values', this.handle, index, begin, end, at, count * Type.BYTES_PER_ELEMENT));
  }

  /** Makes a cursor, once the first chunk is there. `slack`: see lodestone.h. */
  createCursor({ slack = 0 } = {}) {
    return new Cursor(this, slack);
  }
}

export class Cursor {
  constructor(stream, slack) {
    this.stream = stream;
    this.runtime = stream.runtime;
    this.handle = this.runtime.call('cursor_create', stream.handle, slack);
    if (this.handle === 0) throw new LodestoneError('LODESTONE_NOT_READY', this.runtime.text(this.runtime.call('stream_message', stream.handle)));
  }

  destroy() {
    if (this.handle !== 0) this.runtime.call('cursor_destroy', this.handle);
    this.handle = 0;
  }

  seek(position) {
    this.stream.run('cursor_seek', this.handle, position);
  }

  /** Returns where to go for levels that deviate by at most so much. */
  choose(deviation) {
    this.stream.run('cursor_choose', this.handle, deviation);
    return this.runtime.results(1)[0];
  }

  get level() {
    this.stream.run('cursor_level', this.handle);
    const [position, vertexCount, wedgeCount, faceCount, deviation] = this.runtime.results(5);
    return { position, vertexCount, wedgeCount, faceCount, deviation };
  }

  /** Shows a group's index buffer, where it lies: until the next call of anything. */
  corners(group) {
    this.stream.run('cursor_corners', this.handle, group);
    const [at, count] = this.runtime.results(2);
    return new Uint32Array(this.runtime.exports.memory.buffer, at, count);
  }

  /** Returns the ranges of a group's index buffer that may have changed since they were asked for last. */
  changes(group, gap = 1024) {
    return this.#ranges('cursor_changes', group, gap);
  }

  /** Returns the ranges of wedges whose positions may have changed since they were asked for last. */
  movedWedges(gap = 256) {
    return this.#ranges('cursor_moved_wedges', gap);
  }

  #ranges(name, ...values) {
    this.stream.run(name, this.handle, ...values);
    const [count] = this.runtime.results(1);
    const ends = this.runtime.results(1 + 2 * count);
    return Array.from({ length: count }, (_, i) => ({ begin: ends[1 + 2 * i], end: ends[2 + 2 * i] }));
  }

  /** Copies the positions that wedges of the stream have at this level, three floats each. */
  positions(begin, end) {
    const count = 3 * (end - begin);
    return this.runtime.take(Float32Array, count, (at) => this.stream.run('cursor_positions', this.handle, begin, end, at, count));
  }

  /** Returns the wedges that are to be uploaded and have not been returned before. */
  newWedges() {
    this.stream.run('cursor_new_wedges', this.handle);
    const [begin, end] = this.runtime.results(2);
    return { begin, end };
  }

  /**
   * Returns the wedges that this level has and the one at `position`, which is no finer, has not: from `begin` on what wedge of
   * that each comes from; itself where it is to stay.
   */
  origins(position) {
    this.stream.run('cursor_morph_from', this.handle, position);
    const [begin, end] = this.runtime.results(2);
    const count = end - begin;
    const origins = this.runtime.take(Uint32Array, count, (at) => this.stream.run('cursor_origins', this.handle, begin, end, at, count));
    return { begin, origins };
  }

  /** Returns smooth normals of the level, three floats for each wedge. */
  normals() {
    const count = 3 * this.level.wedgeCount;
    return this.runtime.take(Float32Array, count, (at) => this.stream.run('cursor_normals', this.handle, at, count));
  }
}
