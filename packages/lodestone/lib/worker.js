// The worker: one runtime, a session for each stream that the page has open.
import { Session } from './session.js';
import { load } from './wasm.js';

let shared; // a promise of the runtime
const sessions = new Map(); // with the promise of the runtime that each is of

/** One runtime for all streams, and another where that has failed. */
function sharedRuntime() {
  shared ??= load().catch((error) => {
    shared = undefined;
    throw error;
  });
  return shared;
}

/** Ends all that a runtime without memory has been used for. */
function abandon(runtime, error) {
  if (shared === runtime) shared = undefined;
  for (const [id, { session, of }] of sessions) {
    if (of !== runtime) continue;
    sessions.delete(id);
    session.lose(error);
  }
}

function open({ id, url, options }) {
  const of = sharedRuntime();
  const post = (message, transferred = []) => {
    self.postMessage({ id, ...message }, transferred);
    if (message.code === 'LODESTONE_OUT_OF_MEMORY') abandon(of, message);
  };
  const session = new Session(of, url, options, post);
  sessions.set(id, { session, of });
  session.run().finally(() => sessions.delete(id));
}

self.onmessage = ({ data }) => {
  const session = sessions.get(data.id)?.session;
  if (data.type === 'open') open(data);
  else if (data.type === 'want') session?.want(data.deviation);
  else if (data.type === 'acknowledge') session?.acknowledge();
  else if (data.type === 'close') session?.close();
};
