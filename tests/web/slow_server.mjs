// A server of one folder that sends slowly, in pieces, holds back, drops connections and answers ranges wrongly, as it is
// told: for what reads while bytes arrive.
import { EventEmitter } from 'node:events';
import { readFile } from 'node:fs/promises';
import { createServer } from 'node:http';
import { join, normalize, sep } from 'node:path';
import { setImmediate as nextTurn, setTimeout as sleep } from 'node:timers/promises';

/**
 * Starts it. `behaviour` may be changed at any time: ranges 'yes' | 'no' | 'wrong' | 'first', which is the first half whatever
 * is asked for; piece, bytes sent at once; rate, bytes a second of each answer; line, bytes a second of all together; delay,
 * milliseconds before an answer begins; limit, bytes of a file before which it stops; share, the same of a stream's (.lods) bytes, of 1; drop, bytes
 * after which each connection breaks; swap, whether every other answer waits for the one after it, 200 ms at most.
 */
export async function serveSlowly(folder, behaviour) {
  const asked = [];
  let underWay = 0;
  const waiting = new Set();
  const answered = new EventEmitter();
  let lineFree = 0; // when what was sent last is through
  /**
   * Waits until a piece is through that could begin at `begin`, and returns when that was due: the next piece begins there, so that a line is
   * no slower where timers are late on a busy machine.
   */
  const sent = async (length, begin) => {
    const { rate = Infinity, line = Infinity } = behaviour;
    if (rate === Infinity && line === Infinity) return sleep(1).then(() => performance.now());
    lineFree = Math.max(lineFree, begin) + (1000 * length) / line;
    const through = Math.max(lineFree, begin + (1000 * length) / rate);
    const left = through - performance.now();
    await (left > 0 ? sleep(left) : nextTurn());
    return through;
  };
  const limitOf = (path, bytes) =>
    Math.min(behaviour.limit ?? Infinity, path.endsWith('.lods') && behaviour.share < 1 ? Math.ceil(behaviour.share * bytes.length) : Infinity);
  const moved = () => new Promise((resolve) => waiting.add(resolve));

  async function respond(request, response) {
    if (request.method === 'OPTIONS')
      return void response.writeHead(204, { 'access-control-allow-origin': '*', 'access-control-allow-headers': 'range' }).end();
    const path = normalize(join(folder, decodeURIComponent(new URL(request.url, 'http://localhost').pathname)));
    const bytes = path.startsWith(folder + sep) ? await readFile(path).catch(() => undefined) : undefined;
    if (!bytes) return void response.writeHead(404, { 'access-control-allow-origin': '*' }).end();
    const match = behaviour.ranges === 'no' ? null : /^bytes=(\d+)-(\d+)$/.exec(request.headers.range ?? '');
    let [first, end] = match ? [Number(match[1]), Math.min(Number(match[2]) + 1, bytes.length)] : [0, bytes.length];
    if (match && first >= bytes.length) return void response.writeHead(416, { 'access-control-allow-origin': '*' }).end();
    asked.push({ first, end, ranged: Boolean(match) });
    if (match && behaviour.ranges === 'first') [first, end] = [0, Math.ceil(bytes.length / 2)];
    if (match && behaviour.ranges === 'wrong') first = Math.min(first + 100, end - 1);
    response.writeHead(match ? 206 : 200, {
      'content-type': 'application/octet-stream',
      'content-length': end - first,
      'access-control-allow-origin': '*',
      'access-control-expose-headers': 'content-range',
      ...(match && { 'content-range': `bytes ${first}-${end - 1}/${bytes.length}` }),
    });
    if (behaviour.swap && asked.length % 2 === 1)
      await Promise.race([new Promise((resolve) => answered.once('answer', resolve)), sleep(200)]);
    let through = performance.now() + (behaviour.delay ?? 0); // what was sent last, or could have been
    if (behaviour.delay) await sleep(behaviour.delay);
    const { drop = Infinity } = behaviour;
    for (let at = first; at < end && !response.destroyed; ) {
      while (at >= limitOf(path, bytes) && !response.destroyed) {
        await Promise.race([moved(), new Promise((resolve) => response.once('close', resolve))]);
        through = performance.now();
      }
      const length = Math.min(behaviour.piece ?? 1 << 16, end - at, limitOf(path, bytes) - at);
      if (at + length - first > drop) return void response.destroy();
      response.write(bytes.subarray(at, at + length));
      at += length;
      through = await sent(length, through);
    }
    response.end();
    answered.emit('answer');
  }

  const server = createServer(async (request, response) => {
    ++underWay;
    await respond(request, response).catch(() => response.destroy());
    --underWay;
  });
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  return {
    asked,
    /** How many answers have not been sent to their end, to who still wants them. */
    get underWay() {
      return underWay;
    },
    address: `http://127.0.0.1:${server.address().port}`,
    /** Changes the behaviour. */
    change(changes) {
      Object.assign(behaviour, changes);
      for (const resolve of waiting) resolve();
      waiting.clear();
    },
    close: () => new Promise((resolve) => {
      server.close(resolve);
      server.closeAllConnections();
    }),
  };
}
