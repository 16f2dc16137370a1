import { pace } from './pace.js';

const LEAST_FRAMES = 10;
const nothingNew = (a, b) => a.updates === b.updates && a.bytes === b.bytes;

/**
 * Has a context draw frames until for so many milliseconds, and some frames, each has been like the one before, which `isSame` says of what
 * `drawFrame` returns.
 */
export async function settle(drawFrame, context, patience = 1000, isSame = nothingNew) {
  let state = drawFrame();
  let since = performance.now();
  for (let still = 0; still < LEAST_FRAMES || performance.now() - since < patience; ) {
    await pace(context, 10);
    const next = drawFrame();
    still = isSame(next, state) ? still + 1 : 0;
    if (still === 0) since = performance.now();
    state = next;
  }
  return state;
}
