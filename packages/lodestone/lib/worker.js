// The worker: one runtime, a session for each stream that the page has open.
import { Session } from './session.js';
import { load } from './wasm.js';

let runtime;
const sessions = new Map();

/** One runtime for all streams, and another where that has failed. */
function sharedRuntime() {
  runtime ??= load().catch((error) => {
    runtime = undefined;
    throw error;
  });
  return runtime;
}

async function open({ id, url, options }) {
  try {
    const session = new Session(await sharedRuntime(), url, options, (message, transferred = []) => {
      if (message.code === 'LODESTONE_OUT_OF_MEMORY') runtime = undefined;
      self.postMessage({ id, ...message }, transferred);
    });
    sessions.set(id, session);
    await session.run();
  } catch (error) {
    self.postMessage({ id, type: 'error', code: error.code ?? 'UNKNOWN', message: error.message });
  }
  sessions.delete(id);
}

self.onmessage = ({ data }) => {
  const session = sessions.get(data.id);
  if (data.type === 'open') open(data);
  else if (data.type === 'want') session?.want(data.deviation);
  else if (data.type === 'acknowledge') session?.acknowledge();
  else if (data.type === 'close') session?.close();
};
