import { pace } from './pace.js';

/** Looks at frames that a context draws for so long; returns what `look` found at each. */
export async function watchFrames(look, context, milliseconds) {
  const seen = [];
  for (const end = performance.now() + milliseconds; performance.now() < end; ) {
    seen.push(look());
    await pace(context, 5);
  }
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
