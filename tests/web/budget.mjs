// Meshes that share a budget: it is held and used, their errors in pixels are alike, and bytes go to the greatest first.
//
//   node budget.mjs --program PROGRAM --package FOLDER [--models FOLDER] --output FOLDER
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { existsSync, mkdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { serveSlowly } from './slow_server.mjs';
import { Log, readOptions, repository } from './suite.mjs';

const options = readOptions();
if (!existsSync(join(options.package, 'lib', 'lodestone.wasm'))) {
  console.log(`SKIPPED: no ${options.package}: run ./run web, which needs Emscripten`);
  process.exit(77);
}
const { DetailBudget } = await import(join(options.package, 'lib', 'budget.js'));
const { LodestoneStream } = await import(join(options.package, 'lib', 'index.js'));
const { Session } = await import(join(options.package, 'lib', 'session.js'));

/** A mesh whose levels have about as many faces as the inverse of their deviation, by a power; it takes what it is given at once. */
class Model {
  bytes = 0;
  wanted = Infinity;
  #power;
  #step; // by which levels differ, in faces

  constructor(faceCount, { size = 1, power = 1, step = 1 } = {}) {
    this.#power = power;
    this.#step = step;
    const shares = [0.01, 0.03, 0.1, 0.3, 1];
    this.chunks = shares.map((share, i) => ({
      byteBegin: i === 0 ? 0 : 8 * faceCount * shares[i - 1], byteEnd: 8 * faceCount * share,
      faceCount: Math.round(faceCount * share), deviation: share === 1 ? 0 : size * 0.001 * share ** (-1 / power),
    }));
    this.faceCount = faceCount;
    this.size = size;
    this.receive();
  }

  want(deviation) {
    this.wanted = deviation;
  }

  /** A chunk arrives where it is waited for. */
  receive() {
    const ready = this.chunksReady ?? 0;
    if (ready === 0 || (ready < this.chunks.length && this.chunks[ready - 1].deviation > this.wanted)) {
      this.chunksReady = ready + 1;
      this.bytes = this.chunks[ready].byteEnd;
    }
    const arrived = this.chunks[this.chunksReady - 1];
    let share = Math.min(1, Math.max(0.01, (this.wanted / (this.size * 0.001)) ** -this.#power));
    if (this.#step > 1) share = Math.min(1, 0.01 * this.#step ** Math.ceil(Math.log(share / 0.01) / Math.log(this.#step) - 1e-9));
    const whole = this.wanted < 0.001 * this.size || this.wanted === 0;
    const faces = whole ? this.faceCount : Math.ceil(share * this.faceCount);
    this.level = faces >= arrived.faceCount ? { ...arrived } : { faceCount: faces, deviation: this.size * 0.001 * share ** (-1 / this.#power) };
    return this.chunksReady > ready;
  }
}

const errorOf = ({ model, pixels }) => pixels * model.level.deviation;

/** Makes frames until all is settled; returns in which order chunks came, with the errors of all before each. */
function settle(budget, seen, frames = 300) {
  const order = [];
  for (let frame = 0; frame < frames; ++frame) {
    for (const { model, pixels, places = 1 } of seen) budget.see(model, pixels, places);
    budget.update(1000 + 16 * frame);
    const before = seen.map(({ model, pixels }) => pixels * model.chunks[model.chunksReady - 1].deviation);
    seen.forEach(({ model }, i) => {
      if (model.receive()) order.push({ i, before });
    });
  }
  return order;
}

function crowd(budget, list) {
  const seen = list.map(([faceCount, pixels, more = {}]) => ({ model: new Model(faceCount, more), pixels, places: more.places }));
  for (const { model } of seen) budget.add(model);
  return seen;
}

const LIST = [[100_000, 1000], [40_000, 4000], [300_000, 200], [20_000, 900, { size: 3, power: 0.7 }], [70_000, 3000, { power: 1.3 }]];

const checksOfModels = {
  'is held, and used': () => {
    const used = [5_000, 50_000, 200_000, 400_000].map((triangles) => {
      const budget = new DetailBudget({ triangles, pixelError: 0 });
      const seen = crowd(budget, LIST);
      settle(budget, seen);
      const drawn = seen.reduce((sum, { model }) => sum + model.level.faceCount, 0);
      const least = seen.reduce((sum, { model }) => sum + model.chunks[0].faceCount, 0);
      assert.equal(budget.drawn, drawn);
      assert.ok(drawn <= Math.max(triangles, least), `${drawn} of ${triangles}`);
      assert.ok(triangles < least || drawn > 0.85 * triangles, `${drawn} of ${triangles}`);
      return (drawn / triangles).toFixed(2);
    });
    return used.join(' ');
  },
  'is held where levels lie far apart': () => {
    const used = [3_000, 20_000, 60_000, 100_000].map((triangles) => {
      const budget = new DetailBudget({ triangles, pixelError: 0 });
      const seen = crowd(budget, LIST.slice(0, 2).map(([faceCount, pixels], i) => [faceCount, pixels, { step: [1.9, 1.4][i] }]));
      settle(budget, seen);
      assert.ok(budget.drawn <= triangles && budget.drawn > 0.4 * triangles, `${budget.drawn} of ${triangles}`);
      return (budget.drawn / triangles).toFixed(2);
    });
    return used.join(' ');
  },
  'errors in pixels are alike': () => {
    const budget = new DetailBudget({ triangles: 60_000, pixelError: 0 });
    const seen = crowd(budget, LIST);
    settle(budget, seen);
    const errors = seen.filter(({ model }) => model.level.deviation > 0 && model.level.faceCount > model.chunks[0].faceCount).map(errorOf);
    assert.ok(errors.length >= 3);
    assert.ok(Math.max(...errors) < 1.15 * Math.min(...errors), errors.map((error) => error.toFixed(2)).join(' '));
    return errors.map((error) => error.toFixed(2)).join(' ');
  },
  'no error is smaller than needed': () => {
    const budget = new DetailBudget({ pixelError: 2 });
    const seen = crowd(budget, LIST);
    settle(budget, seen);
    assert.equal(budget.error, 2);
    assert.ok(seen.every((entry) => errorOf(entry) <= 2 * 1.05));
    assert.ok(seen.some(({ model }) => model.bytes < model.chunks.at(-1).byteEnd), 'all of all is fetched');
    return `${budget.drawn} triangles`;
  },
  'the greatest error is fetched first': () => {
    for (const atOnce of [1, 2]) {
      const budget = new DetailBudget({ pixelError: 0.5, atOnce });
      const order = settle(budget, crowd(budget, LIST));
      assert.ok(order.length > 10);
      for (const { i, before } of order) {
        const greater = before.filter((error) => error > before[i]).length;
        assert.ok(greater < atOnce, `chunk of the ${greater + 1}th greatest error`);
      }
    }
    return 'one or two at once';
  },
  'a chunk that leads to a coarser level than the one before it is passed': () => {
    const budget = new DetailBudget({ pixelError: 0, atOnce: 1 });
    const seen = crowd(budget, LIST.slice(0, 3));
    for (const { model } of seen) model.chunks[2].deviation = 1.5 * model.chunks[1].deviation;
    settle(budget, seen);
    assert.ok(seen.every(({ model }) => model.chunksReady === model.chunks.length), seen.map(({ model }) => model.chunksReady).join(' '));
    return 'all of all';
  },
  'a chunk that leads to hardly a finer level than the one before it comes': () => {
    const budget = new DetailBudget({ pixelError: 0, atOnce: 1 });
    const seen = crowd(budget, LIST.slice(0, 3));
    for (const { model } of seen) model.chunks[2].deviation = 0.97 * model.chunks[1].deviation;
    settle(budget, seen);
    assert.ok(seen.every(({ model }) => model.chunksReady === model.chunks.length), seen.map(({ model }) => model.chunksReady).join(' '));
    return 'all of all';
  },
  'who gets no more keeps nobody waiting': () => {
    const budget = new DetailBudget({ pixelError: 0 });
    const seen = crowd(budget, LIST.slice(0, 3));
    seen.sort((a, b) => errorOf(b) - errorOf(a));
    const [first, second, { model }] = seen;
    for (const entry of [first, second]) entry.model.ended = true;
    settle(budget, [{ model: first.model, pixels: first.pixels }, { model: second.model, pixels: second.pixels }], 1);
    for (const entry of [first, second]) entry.model.receive = () => false;
    settle(budget, seen);
    assert.equal(model.chunksReady, model.chunks.length);
    assert.ok(!budget.isWaiting);
    return 'all of the third';
  },
  'levels that come late mislead nobody': () => {
    const budget = new DetailBudget({ triangles: 30_000, pixelError: 0 });
    const [{ model, pixels }] = crowd(budget, [[100_000, 1000]]);
    const receive = () => {
      model.receive();
      model.settled = model.wanted;
    };
    model.settled = undefined;
    const frames = (first, count, act) => {
      for (let frame = first; frame < first + count; ++frame) {
        budget.see(model, pixels);
        budget.update(10_000 + 16 * frame);
        act();
      }
    };
    frames(0, 100, receive);
    budget.triangles = 12_000;
    frames(100, 60, () => {}); // a second without any answer
    budget.triangles = 25_000;
    frames(160, 300, receive);
    assert.ok(model.level.faceCount > 0.95 * 25_000 && model.level.faceCount <= 25_000, `${model.level.faceCount}`);
    return `${model.level.faceCount} of 25000`;
  },
  'bytes are held': () => {
    const budget = new DetailBudget({ bytes: 600_000, pixelError: 0 });
    const seen = crowd(budget, LIST);
    settle(budget, seen);
    assert.ok(budget.fetched <= 600_000 && budget.fetched > 300_000, `${budget.fetched}`);
    return `${budget.fetched} of 600000`;
  },
  'places count': () => {
    const budget = new DetailBudget({ triangles: 50_000, pixelError: 0 });
    const seen = crowd(budget, [[100_000, 1000, { places: 10 }]]);
    settle(budget, seen);
    assert.ok(seen[0].model.level.faceCount <= 5000 && seen[0].model.level.faceCount > 4000, `${seen[0].model.level.faceCount}`);
    return `${seen[0].model.level.faceCount} faces at 10 places`;
  },
  'what is not seen makes room': () => {
    const budget = new DetailBudget({ triangles: 50_000, pixelError: 0 });
    const seen = crowd(budget, [[100_000, 1000], [100_000, 1000]]);
    settle(budget, seen);
    const [before] = seen.map(({ model }) => model.level.faceCount);
    for (let frame = 0; frame < 60; ++frame) {
      budget.see(seen[0].model, 1000);
      budget.update(10_000 + 16 * frame);
      for (const { model } of seen) model.receive();
    }
    const [first, second] = seen.map(({ model }) => model.level.faceCount);
    assert.equal(second, 1000);
    assert.ok(first > 1.7 * before && first + second <= 50_000, `${before}, then ${first}`);
    return `${before}, then ${first} faces`;
  },
  'what is removed is let alone': () => {
    const budget = new DetailBudget();
    const [{ model }] = crowd(budget, [[1000, 100]]);
    budget.remove(model);
    budget.see(model, 100);
    budget.update();
    assert.equal(model.wanted, Infinity);
    return 'nothing is wanted';
  },
};

/** A runtime whose streams have chunks of a hundred bytes, which lead to levels of these deviations, and no mesh. */
const runtimeOf = (deviations) => ({
  createStream() {
    const chunks = deviations.map((deviation, i) => ({ byteBegin: 100 * i, byteEnd: 100 * (i + 1), position: i, faceCount: 100 * (i + 1), deviation }));
    let [bytes, position] = [0, 0];
    const ready = () => Math.floor(bytes / 100);
    const none = () => [];
    return {
      get state() {
        const dueEnd = Math.min(100 * (ready() + 1), 100 * chunks.length);
        return { dueBegin: bytes, dueEnd, chunkCount: bytes > 0 ? chunks.length : 0, chunksReady: ready(), groupCount: 0, attributeCount: 0, low: [0, 0, 0], high: [1, 1, 1] };
      },
      chunk: (i) => chunks[i],
      append: (offset, { length }) => (bytes = Math.max(bytes, offset + length)),
      finish: none,
      destroy: none,
      createCursor: () => ({
        get level() {
          return { ...chunks[position] };
        },
        choose: (deviation) => {
          const at = chunks.findIndex((chunk) => chunk.deviation <= deviation);
          return at < 0 || at >= ready() ? ready() - 1 : at;
        },
        seek: (to) => (position = to),
        newWedges: () => ({ begin: 0, end: 0 }),
        positions: () => new Float32Array(0),
        movedWedges: none,
        destroy: none,
      }),
    };
  },
});

/** What fetches so many bytes, whose answers come in pieces that end where `cut` says, and then some. */
const fetchOf = (length, cut) => async (_, { headers }) => {
  const [first, last] = headers.Range.match(/\d+/g).map(Number);
  if (first >= length) return new Response(null, { status: 416 });
  const end = Math.min(last + 1, length);
  let at = first;
  const body = new ReadableStream({
    async pull(controller) {
      await new Promise(setImmediate);
      if (at === end) return void controller.close();
      const to = Math.min(end, Math.max(at + 1, cut(at)));
      controller.enqueue(new Uint8Array(to - at));
      at = to;
    },
  }, { highWaterMark: 0 });
  return new Response(body, { status: 206, headers: { 'content-range': `bytes ${first}-${end - 1}/${length}` } });
};

/** A session as a budget has it; each of its updates is dealt with a little later. */
function memberOf(deviations, fetcher) {
  const member = { ended: false };
  const session = new Session(runtimeOf(deviations), 'none', { deviation: Infinity, fetch: fetcher }, (message) => {
    if (message.type === 'error') member.error = message;
    Object.assign(member, message);
    if (message.type === 'update') setImmediate(() => session.acknowledge());
  });
  member.want = (deviation) => session.want(deviation);
  member.close = () => session.close();
  session.run();
  return member;
}

/** Makes frames until nothing is waited for, or for long. */
async function settleMembers(budget, members, isDone) {
  for (let frame = 0; frame < 1000 && !isDone(); ++frame) {
    for (const member of members) budget.see(member, 1);
    budget.update(1000 + 16 * frame);
    await new Promise(setImmediate);
  }
  for (const member of members) member.close();
}

const random = (seed) => () => {
  seed = (Math.imul(seed, 1664525) + 1013904223) >>> 0;
  return seed / 2 ** 32;
};

const checksOfSessions = {
  // Chunks that are no finer than others before them arrive without a level that could tell of them.
  'all arrives, in whatever pieces': async () => {
    for (let seed = 0; seed < 300; ++seed) {
      const next = random(seed);
      const deviations = Array.from({ length: 10 }, (_, i) => (i === 9 ? 0 : 1.09 ** (Math.round(8 * next()) - 3 * i)));
      const cuts = Array.from({ length: 1 + Math.floor(4 * next()) }, () => Math.floor(1000 * next())).sort((a, b) => a - b);
      const pieces = (at) => cuts.find((cut) => cut > at) ?? 1000;
      const budget = new DetailBudget({ pixelError: 1e-9, atOnce: 1 });
      const members = [memberOf(deviations, fetchOf(1000, pieces)), memberOf(deviations, fetchOf(1000, (at) => at + 37))];
      for (const member of members) budget.add(member);
      await settleMembers(budget, members, () => members.every(({ chunksReady }) => chunksReady === 10));
      const ready = members.map(({ chunksReady }) => chunksReady);
      assert.deepEqual(ready, [10, 10], `${ready} of 10 chunks, ${deviations.map((deviation) => deviation.toFixed(2))}, cut at ${cuts}`);
    }
    return '300 pairs of streams';
  },
  'a stream that ends early keeps nobody waiting': async () => {
    const deviations = [8, 4, 2, 1, 0];
    const budget = new DetailBudget({ pixelError: 1e-9, atOnce: 1 });
    const members = [memberOf(deviations, fetchOf(200, (at) => at + 37)), memberOf(deviations.map((deviation) => deviation / 8), fetchOf(500, (at) => at + 37))];
    for (const member of members) budget.add(member);
    await settleMembers(budget, members, () => members[1].chunksReady === 5);
    assert.deepEqual(members.map(({ chunksReady, ended }) => [chunksReady, ended]), [[2, true], [5, true]]);
    return '2 and 5 of 5 chunks';
  },
  'an answer is read to its end while nobody asks for its bytes': async () => {
    let left = 10_000;
    const pull = async (controller) => {
      await new Promise(setImmediate);
      controller.enqueue(new Uint8Array(50));
      if ((left -= 50) === 0) controller.close();
    };
    const member = memberOf([8, 4, 2, 1, 0], async () => new Response(new ReadableStream({ pull }, { highWaterMark: 0 })));
    for (let i = 0; i < 2000 && left > 0; ++i) await new Promise(setImmediate);
    member.close();
    assert.equal(left, 0);
    assert.equal(member.chunksReady, 1);
    return '10,000 bytes, of which one chunk is decoded';
  },
  'no more is fetched than what a level before the last needs': async () => {
    const asked = [];
    const deviations = [8, 2, 6, 4, 2, 1, 0];
    const fetcher = fetchOf(700, (at) => (at < 400 ? 400 : at + 1));
    const member = memberOf(deviations, (url, request) => (asked.push(request.headers.Range), fetcher(url, request)));
    member.want(2);
    for (let i = 0; i < 100; ++i) await new Promise(setImmediate);
    member.close();
    assert.equal(member.chunksReady, 4);
    assert.equal(member.level.deviation, 2);
    return `${member.chunksReady} chunks`;
  },
};

/** Two streams of a slow server: the near one comes first, and the triangles of both are held. */
async function shareStreams() {
  const folder = join(options.output, 'budget');
  mkdirSync(folder, { recursive: true });
  execFileSync(options.program, ['build', join(repository, 'demo', 'suzi.glb'), '-o', join(folder, 'suzi.lods'), '-q'], { stdio: 'ignore' });
  const server = await serveSlowly(folder, { rate: 2e5, piece: 2000 });
  try {
    const wasm = readFileSync(join(options.package, 'lib', 'lodestone.wasm'));
    const open = () => LodestoneStream.open(`${server.address}/suzi.lods`, { worker: false, module: wasm, deviation: Infinity, slack: 1 });
    const streams = await Promise.all([open(), open()]);
    const [near, far] = streams;
    const most = 0.6 * near.chunks.at(-1).faceCount;
    const budget = new DetailBudget({ triangles: most, pixelError: 0 });
    for (const stream of streams) {
      budget.add(stream);
      (async () => {
        for await (const _ of stream);
      })();
    }
    for (let frame = 0, still = 0, drawn = -1; still < 60 && frame < 3000; ++frame, still = budget.drawn === drawn && budget.drawn > 0.5 * most && budget.drawn <= most ? still + 1 : 0) {
      drawn = budget.drawn;
      budget.see(near, 1000);
      budget.see(far, 100);
      budget.update();
      await new Promise((resolve) => setTimeout(resolve, 10));
    }
    const faces = streams.map(({ level }) => level.faceCount);
    streams.forEach((stream) => stream.close());
    assert.ok(faces[0] + faces[1] <= most, `${faces} of ${most}`);
    assert.ok(faces[0] > 3 * faces[1] && faces[1] > 0, `${faces}`);
    return `${faces.join(' and ')} faces of ${Math.floor(most)}`;
  } finally {
    await server.close();
  }
}

const log = new Log();
await log.run('budget', checksOfModels);
await log.run('sessions', checksOfSessions);
await log.run('streams', { 'share what there is': shareStreams });
log.close();
