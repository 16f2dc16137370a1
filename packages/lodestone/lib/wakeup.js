/** What one waits for until somebody calls `wake`, which may be before. */
export class Wakeup {
  #woken = false;
  #wake;

  async wait() {
    if (!this.#woken) {
      await new Promise((resolve) => {
        this.#wake = resolve;
      });
    }
    this.#woken = false;
  }

  wake() {
    this.#woken = true;
    this.#wake?.();
  }
}
