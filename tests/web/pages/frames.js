import { pace } from './pace.js';

const LONGEST = 50; // milliseconds between two looks: what slides is seen on the way also where drawing is slow

/** Looks at frames that a context draws for so long; returns what `look` found at each, once all are drawn. */
export async function watchFrames(look, context, milliseconds) {
  const seen = [];
  for (const end = performance.now() + milliseconds; performance.now() < end; ) {
    seen.push(look());
    await Promise.race([pace(context, 5), new Promise((resolve) => setTimeout(resolve, LONGEST))]);
  }
  await pace(context, 5);
  return seen;
}

/** A number that changes as vertices slide, whose positions these arrays are. */
export function sumOfPositions(arrays) {
  let sum = 0;
  for (const array of arrays)
    array.forEach((number) => {
      sum += Math.abs(number);
    });
  return sum;
}
