/** Draws frames until nothing has changed for as many as `patience`. `updates()`: how often buffers were written. */
export async function settle(drawFrame, updates, patience = 100) {
  let state = drawFrame();
  let known = updates();
  for (let still = 0; still < patience; ) {
    await new Promise((resolve) => setTimeout(resolve, 10));
    const next = drawFrame();
    still = updates() === known && next.bytes === state.bytes ? still + 1 : 0;
    known = updates();
    state = next;
  }
  return state;
}
