import { holesIn, similarity } from './ssim.js';

/** A picture that later ones are compared with. */
export class KeptPicture {
  #take;
  #width;
  #height;
  #kept;

  /** `take`: returns the picture as it is now, { rgba, covered }, or a promise of it; both by pixel, `covered` 0 at the background. */
  constructor(take, width, height) {
    this.#take = take;
    this.#width = width;
    this.#height = height;
  }

  /** Keeps the picture as it is now; returns how many pixels are covered. */
  async keep() {
    this.#kept = await this.#take();
    return this.#kept.covered.reduce((sum, one) => sum + one, 0);
  }

  async likeness() {
    return similarity(this.#kept, await this.#take(), this.#width, this.#height);
  }

  /** How many pixels show the background where the picture that is kept does not, nor around there. */
  async holes() {
    return holesIn(this.#kept, await this.#take(), this.#width, this.#height);
  }
}
