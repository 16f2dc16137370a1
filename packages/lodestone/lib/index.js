// Streams of meshes for pages: LodestoneStream.open(url), then levels as they arrive.
import { LodestoneError, checkRange, load } from './wasm.js';
import { Session } from './session.js';

export { LodestoneError };

/** The one worker of a page, made when it is needed; its streams by number. */
const shared = { worker: undefined, streams: new Map(), last: 0 };

function sharedWorker() {
  if (shared.worker) return shared.worker;
  const worker = new Worker(new URL('./worker.js', import.meta.url), { type: 'module' });
  worker.onmessage = ({ data }) => {
    const receive = shared.streams.get(data.id);
    if (data.type === 'error') shared.streams.delete(data.id);
    receive?.(data);
  };
  worker.onerror = worker.onmessageerror = (event) => {
    worker.terminate();
    shared.worker = undefined;
    const streams = [...shared.streams.values()];
    shared.streams.clear();
    for (const receive of streams) receive({ type: 'error', code: 'UNKNOWN', message: event.message ?? 'the worker failed' });
  };
  shared.worker = worker;
  return worker;
}

/** Talks to a session in the worker. */
function connectWorker(url, options, receive) {
  const id = ++shared.last;
  const worker = sharedWorker();
  const send = (message) => worker.postMessage({ id, ...message });
  const { deviation, slack, normals, morph, mostBytes, idleTimeout } = options; // what can be sent
  send({ type: 'open', url, options: { deviation, slack, normals, morph, mostBytes, idleTimeout } });
  shared.streams.set(id, receive);
  return {
    want: (deviation) => send({ type: 'want', deviation }),
    acknowledge: () => send({ type: 'acknowledge' }),
    close: () => {
      send({ type: 'close' });
      shared.streams.delete(id);
    },
  };
}

/** Has the session here, in this thread. */
function connectHere(url, options, receive) {
  const session = new Session(load(options.module), url, options, receive);
  session.run();
  return session;
}

/**
 * A mesh that arrives. Iterate over it to get updates, each with what changed since the one before:
 * `for await (const update of stream)`. The next is made when it is asked for. Iteration ends when the stream is closed,
 * and throws what it fails with; a stream whose bytes have all arrived goes on, since what is wanted may change.
 */
export class LodestoneStream {
  #session;
  #queue = [];
  #waiting = []; // for an update, in their order
  #error;
  #closed = false;
  #owes = false; // an acknowledgement
  #opened;
  #over = new AbortController(); // when it is closed or has failed
  ended = false; // no more bytes come

  /** Opens a stream; resolves when it can be drawn, which is after its first kilobytes. */
  static async open(url, options = {}) {
    checkRange('deviation', options.deviation ?? 0, 0, Infinity);
    checkRange('mostBytes', options.mostBytes ?? 1, 1, Number.MAX_SAFE_INTEGER);
    checkRange('idleTimeout', options.idleTimeout ?? 0, 0, Infinity);
    options.signal?.throwIfAborted();
    const stream = new LodestoneStream();
    const base = globalThis.location?.href;
    await stream.#start(String(new URL(url, base)), options);
    return stream;
  }

  #start(url, { worker = typeof Worker !== 'undefined', signal, ...options }) {
    return new Promise((resolve, reject) => {
      const abort = () => {
        reject(signal.reason); // of no effect once it is open
        this.close();
      };
      signal?.addEventListener('abort', abort, { signal: this.#over.signal });
      this.#opened = { resolve, reject };
      this.#session = (worker ? connectWorker : connectHere)(url, options, (message) => this.#receive(message));
    });
  }

  #receive(message) {
    if (this.#closed) return;
    if (message.type === 'open') {
      const { chunks, groups, attributes, low, high } = message;
      Object.assign(this, { chunks, groups, attributes, low, high });
      this.#opened.resolve();
    } else if (message.type === 'update') {
      const { level, low, high, bytes, chunksReady, ended, settled } = message;
      Object.assign(this, { level, low, high, bytes, chunksReady, ended, settled });
      this.#queue.push(message);
    } else if (message.type === 'error') {
      this.#error = new LodestoneError(message.code, message.message);
      this.ended = true;
      this.#over.abort();
      this.#opened.reject(this.#error);
    }
    this.#wake();
  }

  /** Has those who wait look again. */
  #wake() {
    for (const resolve of this.#waiting.splice(0)) resolve();
  }

  /** Whether all of it has been decoded. */
  get complete() {
    return this.chunks !== undefined && this.chunksReady === this.chunks.length;
  }

  /** Says how far levels may lie from the whole mesh, in its units. 0, the default, is the whole; Infinity is the base mesh. */
  want(deviation) {
    checkRange('deviation', deviation, 0, Infinity);
    this.#session.want(deviation);
  }

  close() {
    this.#closed = true;
    this.ended = true;
    this.#over.abort();
    this.#session.close();
    this.#wake();
  }

  /** Returns the next update; undefined once the stream is closed. */
  async next() {
    while (this.#queue.length === 0) {
      if (this.#closed) return undefined;
      if (this.#error) throw this.#error;
      if (this.#owes) {
        this.#owes = false;
        this.#session.acknowledge();
      }
      await new Promise((resolve) => this.#waiting.push(resolve));
    }
    this.#owes = true;
    return this.#queue.shift();
  }

  async *[Symbol.asyncIterator]() {
    for (let update = await this.next(); update; update = await this.next()) yield update;
  }
}
