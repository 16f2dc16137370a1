// The bytes of a URL, from wherever they are wanted on: by range requests where the server answers them, else by the body
// of the whole, in its order.
import { LodestoneError } from './wasm.js';

const LEAST_REQUEST = 1 << 15; // bytes: a request for less is hardly faster
const MOST_FAILURES = 3; // in a row, without a byte that was wanted in between
const FIRST_PAUSE = 100; // ms, after a failure; after each further one four times as long

/** Returns which bytes of the file a response has, { first, last }; undefined where it does not say. */
function rangeOf(response) {
  const match = /^bytes (\d+)-(\d+)\/(\d+|\*)$/.exec(response.headers.get('content-range') ?? '');
  return match ? { first: Number(match[1]), last: Number(match[2]) } : undefined;
}

export class Source {
  #url;
  #fetch;
  #abort = new AbortController();
  #reader; // of the response at hand
  #at = 0; // its next byte's place in the file
  #gave = false; // bytes that were wanted, that response
  #ranges = true; // until the server has answered otherwise
  #failures = 0;

  constructor(url, fetcher) {
    this.#url = url;
    this.#fetch = fetcher;
  }

  close() {
    this.#abort.abort();
  }

  /** Returns `{ offset, bytes }`, some bytes that begin at or before `begin` and end behind it; null where the file ends there. */
  async read(begin, end) {
    for (;;) {
      try {
        if (!this.#reader || this.#at > begin) {
          if (!(await this.#request(begin, end))) return null;
        }
        const { done, value } = await this.#reader.read();
        if (!done) {
          this.#at += value.length;
          if (this.#at <= begin) continue; // what was there before, once more: no progress
          this.#gave = true;
          this.#failures = 0;
          return { offset: this.#at - value.length, bytes: value };
        }
        this.#reader = undefined;
        if (!this.#ranges) return null;
        if (!this.#gave) throw new Error('answers with fewer bytes than it says');
      } catch (error) {
        this.#reader = undefined;
        if (error instanceof LodestoneError || this.#abort.signal.aborted) throw error;
        if (++this.#failures >= MOST_FAILURES) throw new LodestoneError('NETWORK', `${this.#url}: ${error.message}`);
        await new Promise((resolve) => setTimeout(resolve, FIRST_PAUSE * 4 ** (this.#failures - 1)));
        if (this.#abort.signal.aborted) throw error;
      }
    }
  }

  /** Asks for bytes; false where the file has none there. */
  async #request(begin, end) {
    await this.#reader?.cancel().catch(() => {});
    this.#reader = undefined;
    const headers = this.#ranges ? { Range: `bytes=${begin}-${Math.max(end, begin + LEAST_REQUEST) - 1}` } : {};
    const response = await this.#fetch(this.#url, { headers, signal: this.#abort.signal });
    if (response.status === 416) return false;
    if (!response.ok) throw new LodestoneError('NETWORK', `${this.#url}: ${response.status} ${response.statusText}`);
    const range = response.status === 206 ? rangeOf(response) : { first: 0, last: Infinity };
    if (!range || range.first > begin || range.last < begin) {
      // What it says is not what was asked for: such ranges are not for relying on.
      await response.body.cancel().catch(() => {});
      if (!this.#ranges) throw new LodestoneError('NETWORK', `${this.#url}: answers other ranges than asked for`);
      this.#ranges = false;
      return this.#request(begin, end);
    }
    if (response.status !== 206) this.#ranges = false;
    this.#reader = response.body.getReader();
    this.#at = range.first;
    this.#gave = false;
    return true;
  }
}
