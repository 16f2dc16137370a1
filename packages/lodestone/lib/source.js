// The bytes of a URL, from wherever they are wanted on: by range requests where the server answers them, else by the body
// of the whole, in its order.
import { LodestoneError } from './wasm.js';

const LEAST_REQUEST = 1 << 15; // bytes: a request for less is hardly faster
const MOST_FAILURES = 3; // in a row, without a byte in between

/** Returns where a response's body begins in the file, and how long that is; undefined where it does not say. */
function rangeOf(response) {
  const match = /^bytes (\d+)-\d+\/(\d+|\*)$/.exec(response.headers.get('content-range') ?? '');
  return match ? Number(match[1]) : undefined;
}

export class Source {
  #url;
  #fetch;
  #abort = new AbortController();
  #reader; // of the response at hand
  #at = 0; // its next byte's place in the file
  #ranges = true; // until the server has answered otherwise
  #failures = 0;

  constructor(url, fetcher) {
    this.#url = url;
    this.#fetch = fetcher;
  }

  /** Whether parts of the file can be left out for now. */
  get hasRanges() {
    return this.#ranges;
  }

  close() {
    this.#abort.abort();
  }

  /** Returns `{ offset, bytes }`, some bytes that begin at or before `begin`; null where the file ends there. */
  async read(begin, end) {
    for (;;) {
      try {
        if (!this.#reader || this.#at > begin) {
          if (!(await this.#request(begin, end))) return null;
        }
        const { done, value } = await this.#reader.read();
        if (!done && value.length > 0) {
          this.#failures = 0;
          this.#at += value.length;
          return { offset: this.#at - value.length, bytes: value };
        }
        if (!done) continue;
        this.#reader = undefined;
        if (!this.#ranges) return null;
        if (this.#at < end && ++this.#failures >= MOST_FAILURES) return null;
      } catch (error) {
        this.#reader = undefined;
        if (error instanceof LodestoneError || this.#abort.signal.aborted) throw error;
        if (++this.#failures >= MOST_FAILURES) throw new LodestoneError('NETWORK', `${this.#url}: ${error.message}`);
      }
    }
  }

  /** Asks for bytes; false where the file has none there. */
  async #request(begin, end) {
    await this.#reader?.cancel().catch(() => {});
    const headers = this.#ranges ? { Range: `bytes=${begin}-${Math.max(end, begin + LEAST_REQUEST) - 1}` } : {};
    const response = await this.#fetch(this.#url, { headers, signal: this.#abort.signal });
    if (response.status === 416) return false;
    if (!response.ok) throw new LodestoneError('NETWORK', `${this.#url}: ${response.status} ${response.statusText}`);
    const first = response.status === 206 ? rangeOf(response) : 0;
    if (response.status === 206 && !(first <= begin)) {
      // What it says is not what was asked for: such ranges are not for relying on.
      await response.body.cancel().catch(() => {});
      if (++this.#failures >= MOST_FAILURES) throw new LodestoneError('NETWORK', `${this.#url}: answers other ranges than asked for`);
      this.#ranges = false;
      return this.#request(0, end);
    }
    if (response.status !== 206) this.#ranges = false;
    this.#reader = response.body.getReader();
    this.#at = first;
    return true;
  }
}
