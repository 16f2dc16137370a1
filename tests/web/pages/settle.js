import { pace } from './pace.js';

/** Has a context draw frames until as many as `patience` have been like the one before, which `isSame` says of what `drawFrame` returns. */
export async function settle(drawFrame, context, isSame, patience = 100) {
  let state = drawFrame();
  for (let still = 0; still < patience; ) {
    await pace(context, 10);
    const next = drawFrame();
    still = isSame(next, state) ? still + 1 : 0;
    state = next;
  }
  return state;
}
