// Vertices that slide from where they are drawn to where they are to be: geomorphs, by writing to the buffers that are drawn
// from, so that any material goes with them.

/** Of the faces of levels between which vertices slide: from much coarser ones they would come out of what looks like nothing. */
const MOST_RATIO = 32;

/** Which way vertices slide with an update from a level, if there is one: 1 to a finer one, -1 to a coarser one, 0 not at all. */
export function wayOf(from, { level, morph }) {
  if (!morph || !from) return 0;
  const ratio = level.faceCount / from.faceCount;
  return ratio < MOST_RATIO && 1 / ratio < MOST_RATIO ? Math.sign(level.position - from.position) : 0;
}

const nextFrame = globalThis.requestAnimationFrame?.bind(globalThis) ?? ((job) => setTimeout(job, 16));

/** Returns elements of a typed array, a copy. `elements`: their numbers. */
function gather(array, itemSize, elements) {
  const values = new array.constructor(elements.length * itemSize);
  elements.forEach((element, i) => {
    for (let k = 0; k < itemSize; ++k) values[i * itemSize + k] = array[element * itemSize + k];
  });
  return values;
}

/** Elements of a buffer on their way. A buffer has `array`, `itemSize` and `touch(begin, count)`. */
class Slide {
  constructor(buffer, begin, starts, ends) {
    Object.assign(this, { buffer, begin, starts, ends });
  }

  put(t) {
    const { buffer, begin, starts, ends } = this;
    const { array, itemSize } = buffer;
    if (t <= 0 || t >= 1) array.set(t <= 0 ? starts : ends, begin * itemSize);
    else for (let i = 0, at = begin * itemSize; i < ends.length; ++i, ++at) array[at] = starts[i] + (ends[i] - starts[i]) * t;
    buffer.touch(begin, ends.length / itemSize);
  }
}

/** What a stream's buffers do on the way between two levels. The first of the buffers has the positions. */
export class Slides {
  #milliseconds;
  #onStep;
  #running = []; // { slides, since, done }, the oldest first
  #ticking = false;

  /** `onStep` is called when something has moved. */
  constructor(milliseconds, onStep) {
    this.#milliseconds = milliseconds;
    this.#onStep = onStep;
  }

  get isIdle() {
    return this.#running.length === 0;
  }

  /**
   * Writes an update by `write`, and has what is new begin as the wedges of the level before that it comes from, as they are
   * drawn now. What slides already goes on.
   */
  refine({ moved, morph: { begin, origins } }, buffers, write) {
    const [positions] = buffers;
    const before = moved.map((range) => positions.array?.slice(3 * range.begin, 3 * range.begin + range.positions.length));
    write();
    const ends = buffers.map(({ array, itemSize }) => array.slice(begin * itemSize, (begin + origins.length) * itemSize));
    const slides = moved.map((range, i) => new Slide(positions, range.begin, before[i] ?? range.positions, range.positions));
    for (const slide of slides) slide.put(0); // what is new begins where its origin is drawn
    buffers.forEach((buffer, i) => {
      slides.push(new Slide(buffer, begin, gather(buffer.array, buffer.itemSize, origins), ends[i]));
      slides.at(-1).put(0);
    });
    this.#start(slides);
  }

  /**
   * Has what an update takes away slide to where that leads; resolves when it is there, for the update to be written then. What
   * slides already is there at once.
   */
  async coarsen({ moved, morph: { begin, origins } }, buffers) {
    this.finish();
    const [positions] = buffers;
    const goal = positions.array.slice(0, 3 * (begin + origins.length));
    const slides = [];
    for (const range of moved) {
      const from = 3 * range.begin;
      if (from < goal.length) goal.set(range.positions.subarray(0, goal.length - from), from);
      const to = Math.min(3 * begin, from + range.positions.length); // what goes away is dealt with below
      if (from < to) slides.push(new Slide(positions, range.begin, positions.array.slice(from, to), goal.slice(from, to)));
    }
    const gone = buffers.map((buffer) => {
      const { array, itemSize } = buffer;
      const starts = array.slice(begin * itemSize, (begin + origins.length) * itemSize);
      return new Slide(buffer, begin, starts, gather(buffer === positions ? goal : array, itemSize, origins));
    });
    await new Promise((done) => this.#start([...slides, ...gone], done));
    for (const slide of gone) slide.put(0); // as they are when they come back
  }

  /** Has all be where it is to be. */
  finish() {
    for (const { slides, done } of this.#running.splice(0)) {
      for (const slide of slides) slide.put(1);
      done?.();
    }
  }

  #start(slides, done) {
    this.#running.push({ slides, since: performance.now(), done });
    if (!this.#ticking) this.#tick();
  }

  /** For pages that draw only when they are told of changes. */
  #tick() {
    this.#ticking = true;
    nextFrame(() => {
      this.#ticking = false;
      if (this.isIdle) return;
      this.step();
      if (!this.isIdle) this.#tick();
      this.#onStep();
    });
  }

  /** Moves what slides to where it is by now; later ones have the last word where they are on the way with the same vertices. */
  step() {
    const now = performance.now();
    const all = this.#running;
    this.#running = all.filter(({ since }) => now - since < this.#milliseconds);
    for (const { slides, since, done } of all) {
      const t = Math.min(1, (now - since) / this.#milliseconds);
      for (const slide of slides) slide.put(t);
      if (t === 1) done?.();
    }
  }
}
