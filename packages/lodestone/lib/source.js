// The bytes of a URL, from wherever they are wanted on: by range requests where the server answers them, else by the body
// of the whole, in its order.
import { Body } from './body.js';
import { LodestoneError } from './wasm.js';

const LEAST_REQUEST = 1 << 15; // bytes: a request for less is hardly faster
const MOST_FAILURES = 3; // in a row, without a byte that was wanted in between
const FIRST_PAUSE = 100; // ms, after a failure; after each further one four times as long
const IDLE_TIMEOUT = 30_000; // ms

let lastArrival = 0; // when something came, to whatever source

/** Returns which bytes of the file a response has, { first, last }; undefined where it does not say. */
function rangeOf(response) {
  const match = /^bytes (\d+)-(\d+)\/(\d+|\*)$/.exec(response.headers.get('content-range') ?? '');
  return match ? { first: Number(match[1]), last: Number(match[2]) } : undefined;
}

export class Source {
  #url;
  #fetch;
  #idleTimeout;
  #closed = false;
  #abort; // the request at hand
  #body; // of its answer
  #at = 0; // its next byte's place in the file
  #gave = false; // bytes that were wanted, that answer
  #ranges = true; // until the server has answered otherwise
  #failures = 0;

  constructor(url, options) {
    this.#url = url;
    this.#fetch = options.fetch ?? ((...request) => fetch(...request));
    this.#idleTimeout = (options.idleTimeout ?? IDLE_TIMEOUT) || Infinity;
  }

  close() {
    this.#closed = true;
    this.#letGo();
  }

  /** Gives the request at hand up, and its connection back. */
  #letGo() {
    this.#abort?.abort();
    this.#body = undefined;
  }

  /** Returns `{ offset, bytes }`, some bytes that begin at or before `begin` and end behind it; null where the file ends there. */
  async read(begin, end) {
    for (;;) {
      try {
        if (!this.#body || this.#at > begin) {
          if (!(await this.#request(begin, end))) return null;
        }
        const bytes = await this.#inTime(this.#body.read(), false);
        if (bytes) {
          this.#at += bytes.length;
          if (this.#at <= begin) continue; // what was there before, once more: no progress
          this.#gave = true;
          this.#failures = 0;
          return { offset: this.#at - bytes.length, bytes };
        }
        this.#body = undefined;
        if (!this.#ranges) return null;
        if (!this.#gave) throw new Error('answers with fewer bytes than it says');
      } catch (error) {
        this.#letGo();
        if (error instanceof LodestoneError || this.#closed) throw error;
        if (++this.#failures >= MOST_FAILURES) throw new LodestoneError('NETWORK', `${this.#url}: ${error.message}`);
        await new Promise((resolve) => setTimeout(resolve, FIRST_PAUSE * 4 ** (this.#failures - 1)));
        if (this.#closed) throw error;
      }
    }
  }

  /** Asks for bytes; false where the file has none there. */
  async #request(begin, end) {
    this.#letGo();
    this.#abort = new AbortController();
    const headers = this.#ranges ? { Range: `bytes=${begin}-${Math.max(end, begin + LEAST_REQUEST) - 1}` } : {};
    const response = await this.#inTime(this.#fetch(this.#url, { headers, signal: this.#abort.signal }), true);
    if (response.status === 416) {
      this.#letGo();
      return false;
    }
    if (!response.ok) throw new LodestoneError('NETWORK', `${this.#url}: ${response.status} ${response.statusText}`);
    const range = response.status === 206 ? rangeOf(response) : { first: 0, last: Infinity };
    if (!range || range.first > begin || range.last < begin) {
      // What it says is not what was asked for: such ranges are not for relying on.
      if (!this.#ranges) throw new LodestoneError('NETWORK', `${this.#url}: answers other ranges than asked for`);
      this.#ranges = false;
      return this.#request(begin, end);
    }
    if (response.status !== 206) this.#ranges = false;
    this.#body = new Body(response.body, () => {
      lastArrival = performance.now();
    });
    this.#at = range.first;
    this.#gave = false;
    return true;
  }

  /**
   * Waits for what the request at hand brings, and throws where nothing comes for too long. An answer that has not begun may yet wait for one of
   * the browser's connections: while other sources get something, it is waited for.
   */
  #inTime(promise, mayQueue) {
    let timer;
    const late = new Promise((_, reject) => {
      const begin = performance.now();
      const look = () => {
        const left = (mayQueue ? Math.max(begin, lastArrival) : begin) + this.#idleTimeout - performance.now();
        if (left > 0) timer = setTimeout(look, Math.min(left, 1e9)); // a timer takes no more
        else reject(new Error(`nothing comes for ${this.#idleTimeout / 1000} s`));
      };
      look();
    });
    return Promise.race([promise, late]).finally(() => clearTimeout(timer));
  }
}
