import { Wakeup } from './wakeup.js';

const MOST_AHEAD = 1 << 26; // bytes that are kept before somebody asks for them

/**
 * What an answer brings. It is read on while nobody asks for it: a browser has six connections to a host, and one whose answer is not read to
 * its end is kept from everything else that the page wants of that host. How far browsers read on by themselves is theirs to say (Chromium: some
 * 50 MB).
 */
export class Body {
  #pieces = [];
  #ahead = 0; // bytes, of the pieces
  #over = false;
  #error; // that it broke off with
  #came = new Wakeup();
  #taken = new Wakeup();

  /** `arrived` is called for each piece. */
  constructor(stream, arrived) {
    const fail = (error) => {
      this.#error = error;
    };
    this.#fill(stream.getReader(), arrived).catch(fail).finally(() => {
      this.#over = true;
      this.#came.wake();
    });
  }

  async #fill(reader, arrived) {
    for (let next = await reader.read(); !next.done; next = await reader.read()) {
      this.#pieces.push(next.value);
      this.#ahead += next.value.length;
      this.#came.wake();
      arrived();
      while (this.#ahead >= MOST_AHEAD) await this.#taken.wait();
    }
  }

  /** Returns the next piece, undefined behind the last one; throws what it broke off with, once all that had come is taken. */
  async read() {
    while (this.#pieces.length === 0 && !this.#over) await this.#came.wait();
    const piece = this.#pieces.shift();
    if (!piece && this.#error) throw this.#error;
    this.#ahead -= piece?.length ?? 0;
    this.#taken.wake();
    return piece;
  }
}
