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
await log.run('streams', { 'share what there is': shareStreams });
log.close();
