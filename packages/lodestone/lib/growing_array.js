// What streams' updates are gathered in, for engines to upload from.

/** A typed array that grows, of elements of several numbers each. */
export class GrowingArray {
  /** `likely`: the elements that it comes to in the end, as far as is known. */
  constructor(itemSize, likely) {
    this.itemSize = itemSize;
    this.likely = likely;
    this.array = undefined;
    this.end = 0; // behind the last element that was written
  }

  /** Writes numbers at an element; returns whether the array is another one now. */
  write(begin, values) {
    const end = begin + values.length / this.itemSize;
    const grows = !this.array || end * this.itemSize > this.array.length;
    if (grows) this.#grow(end, values.constructor);
    this.array.set(values, begin * this.itemSize);
    this.end = Math.max(this.end, end);
    return grows;
  }

  #grow(end, Type) {
    const old = this.array;
    // What a file says that it comes to is believed no further than twice what is there.
    const count = Math.max(end, Math.min(this.likely, 2 * Math.max((old?.length ?? 0) / this.itemSize, end)));
    this.array = new Type(count * this.itemSize);
    if (old) this.array.set(old);
  }
}
