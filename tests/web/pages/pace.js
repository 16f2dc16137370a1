// Frames in software take longer than it takes to ask for them. Those that nobody waits for pile up in the browser's other
// processes until one call waits for all of them, for a minute where they are hundreds.

const pause = (milliseconds) => new Promise((resolve) => setTimeout(resolve, milliseconds));

/**
 * Resolves after so many milliseconds, and not before a WebGL 2 context has drawn all that it has been told to; the event loop turns
 * meanwhile. Turns of it that are held for longer than the timer that they wait for are told to `turned(milliseconds)`.
 */
export async function pace(context, milliseconds, turned = () => {}) {
  const fence = context.fenceSync(context.SYNC_GPU_COMMANDS_COMPLETE, 0);
  context.flush();
  do {
    const begin = performance.now();
    await pause(milliseconds);
    turned(performance.now() - begin - milliseconds);
  } while (context.getSyncParameter(fence, context.SYNC_STATUS) !== context.SIGNALED);
  context.deleteSync(fence);
}
