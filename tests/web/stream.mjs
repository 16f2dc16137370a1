// The npm package: the runtime in WebAssembly gives what the native one gives, byte for byte; streams are read from servers
// of all kinds; and a page of three.js draws one while it arrives.
//
//   node stream.mjs --program PROGRAM --sums PROGRAM --package FOLDER [--models FOLDER] --output FOLDER
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { existsSync, mkdirSync, readFileSync } from 'node:fs';
import { basename, join } from 'node:path';
import { gzipSync } from 'node:zlib';
import { serveSlowly } from './slow_server.mjs';
import { Log, openSite, readOptions, repository, skip, until, withinTime } from './suite.mjs';

const MOST_MODULE_BYTES = 120_000; // compressed
const PATIENCE = 20_000; // milliseconds, with what is to be given up at once

const options = readOptions();
if (!existsSync(join(options.package, 'lib', 'lodestone.wasm'))) {
  console.log(`SKIPPED: no ${options.package}: run ./run web, which needs Emscripten`);
  process.exit(77);
}
const { load } = await import(join(options.package, 'lib', 'wasm.js'));
const { LodestoneStream } = await import(join(options.package, 'lib', 'index.js'));
const wasm = readFileSync(join(options.package, 'lib', 'lodestone.wasm'));
const folder = join(options.output, 'streams');
mkdirSync(folder, { recursive: true });

/** Builds the streams of the models that are there. */
function buildStreams() {
  const wanted = [
    [join(repository, 'demo', 'suzi.glb')],
    [join(repository, 'demo', 'suzi.glb'), 'fast'],
    [join(options.models, 'paper', 'stanford-bunny.obj')],
    [join(options.models, 'mesh', 'spot', 'spot_triangulated.obj')],
  ];
  return wanted.flatMap(([model, coding = 'small']) => {
    if (!existsSync(model)) return skip(model) ?? [];
    const path = join(folder, `${basename(model).replace(/\..*/, '')}${coding === 'small' ? '' : `-${coding}`}.lods`);
    execFileSync(options.program, ['build', model, '-o', path, '-q', '--stream-coding', coding], { stdio: ['ignore', 'ignore', 'ignore'] });
    return [path];
  });
}

function addToSum(sum, array) {
  for (const byte of new Uint8Array(array.buffer, array.byteOffset, array.byteLength)) sum = Math.imul(sum ^ byte, 16777619);
  return sum;
}

/** Returns the module with a memory that ends at so many pages of 64 KiB. */
function withMemory(pages) {
  const bytes = Uint8Array.from(wasm);
  let at = 8;
  const number = () => {
    for (let value = 0, shift = 0; ; shift += 7) {
      value += (bytes[at] & 127) << shift;
      if (bytes[at++] < 128) return value;
    }
  };
  for (;;) {
    const id = bytes[at++];
    const next = number() + at;
    if (id === 5) break; // the section of memories: their number, flags, least, most
    at = next;
  }
  assert.deepEqual([number(), number()], [1, 1]);
  number();
  const begin = at;
  assert.equal(number(), 32768); // three bytes, which hold any number of pages
  bytes.set([(pages & 127) | 128, ((pages >> 7) & 127) | 128, pages >> 14], begin);
  return bytes;
}

let workers = 0;

/**
 * Loads worker.js here, with a module of so much memory, which is there once `loaded` is; returns what opens a stream there, and the messages
 * by stream.
 */
async function startWorker(pages, loaded = Promise.resolve()) {
  const fetchAsEver = globalThis.fetch;
  globalThis.fetch = (url, ...more) => (String(url).endsWith('/lodestone.wasm') ? loaded.then(() => new Response(withMemory(pages))) : fetchAsEver(url, ...more));
  const messages = new Map();
  let changed = () => {};
  const self = {
    postMessage({ id, ...message }) {
      messages.set(id, [...(messages.get(id) ?? []), message]);
      if (message.type === 'update') setTimeout(() => self.onmessage({ data: { id, type: 'acknowledge' } }));
      changed();
    },
  };
  globalThis.self = self;
  await import(`${join(options.package, 'lib', 'worker.js')}?${++workers}`);
  return {
    messages,
    send: (data) => self.onmessage({ data }),
    /** Resolves once a stream's messages are as wanted. */
    async until(id, isWanted) {
      const end = Date.now() + 20_000;
      while (!isWanted(messages.get(id) ?? [])) {
        assert.ok(Date.now() < end, `stream ${id}: ${messages.get(id)?.map(({ type }) => type)}`);
        await new Promise((resolve) => {
          changed = resolve;
          setTimeout(resolve, 1000);
        });
      }
      return messages.get(id);
    },
    close() {
      globalThis.fetch = fetchAsEver;
      delete globalThis.self;
    },
  };
}

/** As stream_sums.c has it. */
function sumOfLevel(stream, cursor, position) {
  cursor.seek(position);
  const { groupCount, attributeCount } = stream.state;
  const { wedgeCount, deviation } = cursor.level;
  let sum = 2166136261;
  for (let group = 0; group < groupCount; ++group) sum = addToSum(sum, cursor.corners(group));
  sum = addToSum(sum, cursor.positions(0, wedgeCount));
  for (let i = 0; i < attributeCount; ++i) sum = addToSum(sum, stream.attributeValues(i, 0, wedgeCount));
  return addToSum(sum, new Float32Array([deviation])) >>> 0;
}

/** The sums after each chunk, read in pieces of some length. */
function sumsOf(runtime, bytes, length) {
  const stream = runtime.createStream();
  const sums = [];
  let cursor;
  for (let at = 0; at < bytes.length; at += length) {
    for (let begin = at; begin < Math.min(at + length, bytes.length); ) {
      const end = Math.min(at + length, bytes.length, stream.state.dueEnd);
      stream.append(begin, bytes.subarray(begin, end));
      begin = end;
      const { chunksReady, recordCount } = stream.state;
      if (chunksReady === sums.length) continue;
      cursor ??= stream.createCursor();
      sums.push([sumOfLevel(stream, cursor, recordCount), sumOfLevel(stream, cursor, Math.floor(recordCount / 2))]);
    }
  }
  stream.finish();
  cursor.destroy();
  stream.destroy();
  return sums;
}

/** Reads a stream to its end and puts its updates together; returns the sum of its finest level. */
async function follow(url, more = {}) {
  const stream = await LodestoneStream.open(url, { worker: false, module: wasm, ...more });
  const pieces = [];
  let places = new Float32Array();
  const groups = stream.groups.map(() => []);
  let updates = 0;
  let wedges = 0;
  for await (const update of stream) {
    ++updates;
    assert.equal(update.wedges.begin, wedges);
    wedges = update.wedges.end;
    pieces.push(update.wedges);
    places = Float32Array.from([...places, ...update.wedges.positions]);
    for (const { begin, positions } of update.moved) places.set(positions, 3 * begin);
    update.groups.forEach(({ count, ranges }, group) => {
      for (const { begin, corners } of ranges) corners.forEach((corner, i) => (groups[group][begin + i] = corner));
      groups[group].length = count;
    });
    if (stream.complete && update.level.position === stream.chunks.at(-1).position) break;
  }
  stream.close();
  let sum = 2166136261;
  for (const corners of groups) sum = addToSum(sum, Uint32Array.from(corners));
  sum = addToSum(sum, places);
  stream.attributes.forEach((_, i) => {
    for (const { attributes } of pieces) sum = addToSum(sum, attributes[i]);
  });
  return { sum: addToSum(sum, new Float32Array([stream.level.deviation])) >>> 0, updates, bytes: stream.bytes };
}

function checksOfModule() {
  return {
    'compressed size': () => {
      const bytes = gzipSync(wasm, { level: 9 }).length;
      assert.ok(bytes <= MOST_MODULE_BYTES, `${bytes} bytes`);
      return `${bytes} bytes of ${wasm.length}`;
    },
    'errors have codes and words': async () => {
      const runtime = await load(wasm);
      const stream = runtime.createStream();
      assert.throws(() => stream.createCursor(), { code: 'LODESTONE_NOT_READY' });
      assert.throws(() => stream.append(0, new Uint8Array(16)), { code: 'LODESTONE_MALFORMED', message: /magic/ });
      const removal = readFileSync(join(repository, 'tests', 'golden', 'stream-1.0.lds'));
      assert.throws(() => runtime.createStream().append(0, removal), { code: 'LODESTONE_UNSUPPORTED', message: /version 1, where 3 to 3/ });
      return 'magic, version, no chunk yet';
    },
    'numbers out of range are refused': async () => {
      const runtime = await load(wasm);
      for (const mostBytes of [NaN, -1, 0, 0.5, Infinity]) assert.throws(() => runtime.createStream({ mostBytes }), RangeError);
      for (const offset of [NaN, -1, 2 ** 64]) assert.throws(() => runtime.createStream().append(offset, new Uint8Array(1)), RangeError);
      for (const wrong of [{ deviation: NaN }, { deviation: -1 }, { mostBytes: 0 }])
        await assert.rejects(LodestoneStream.open('http://localhost/', { worker: false, module: wasm, ...wrong }), RangeError);
      return 'mostBytes, offset, deviation';
    },
  };
}

/** What happens where the module has no memory left: too little for the one stream, enough for the other. */
function checksOfMemory(large, small) {
  return {
    'the module without memory says so': async () => {
      const runtime = await load(withMemory(256));
      const stream = runtime.createStream();
      const bytes = new Uint8Array(readFileSync(large));
      const append = () => {
        for (let begin = 0; begin < bytes.length; begin = stream.state.dueBegin) stream.append(begin, bytes.subarray(begin, stream.state.dueEnd));
      };
      assert.throws(append, { code: 'LODESTONE_OUT_OF_MEMORY', message: /^stream_append/ });
      assert.throws(() => stream.state, { code: 'LODESTONE_OUT_OF_MEMORY', message: /^stream_append/ });
      return 'from then on';
    },
    'all streams of its worker fail, and the next has another': async () => {
      const server = await serveSlowly(folder, {});
      const worker = await startWorker(256);
      try {
        const open = (id, path, more = {}) => worker.send({ type: 'open', id, url: `${server.address}/${basename(path)}`, options: more });
        const isWhole = (messages) => messages.at(-1)?.level?.deviation === 0;
        const hasFailed = (messages) => messages.at(-1)?.code === 'LODESTONE_OUT_OF_MEMORY';
        open(1, small);
        await worker.until(1, isWhole);
        open(2, large);
        await worker.until(2, hasFailed);
        await worker.until(1, hasFailed);
        open(3, small);
        assert.equal((await worker.until(3, isWhole)).filter(({ type }) => type === 'error').length, 0);
        worker.send({ type: 'close', id: 3 });
        return 'two, then one';
      } finally {
        worker.close();
        await server.close();
      }
    },
    'what its streams are told while it loads the module holds': async () => {
      const server = await serveSlowly(folder, {});
      let release;
      const worker = await startWorker(1024, new Promise((resolve) => (release = resolve)));
      try {
        for (const id of [1, 2]) worker.send({ type: 'open', id, url: `${server.address}/${basename(small)}`, options: {} });
        worker.send({ type: 'close', id: 1 });
        worker.send({ type: 'want', id: 2, deviation: Infinity });
        release();
        const { level } = (await worker.until(2, (messages) => messages.at(-1)?.settled === Infinity)).at(-1);
        worker.send({ type: 'close', id: 2 });
        assert.equal(level.position, 0);
        assert.equal(worker.messages.get(1), undefined);
        assert.equal(server.asked.length, 1);
        return 'a close and a want';
      } finally {
        worker.close();
        await server.close();
      }
    },
  };
}

function checksOfStream(path) {
  const bytes = new Uint8Array(readFileSync(path));
  const native = execFileSync(options.sums, [path], { encoding: 'utf8' }).trim().split('\n').map((line) => line.split(' ').map(Number));
  const whole = native.at(-1)[0];
  const served = async (behaviour, job) => {
    const server = await serveSlowly(folder, behaviour);
    try {
      return await job(`${server.address}/${basename(path)}`, server);
    } finally {
      await server.close();
    }
  };
  const followed = (behaviour) => () =>
    served(behaviour, async (url, server) => {
      const { sum, updates } = await follow(url);
      assert.equal(sum, whole);
      return `${updates} updates, ${server.asked.length} requests`;
    });
  return {
    'the same as natively': async () => {
      const runtime = await load(wasm);
      for (const length of [1 << 20, 1000, 7]) assert.deepEqual(sumsOf(runtime, bytes, length), native);
      return `${native.length} chunks`;
    },
    'decodes at': async () => {
      const runtime = await load(wasm);
      const times = [0, 1, 2, 3].map(() => {
        const stream = runtime.createStream();
        const start = performance.now();
        stream.append(0, bytes);
        const time = performance.now() - start;
        stream.destroy();
        return time;
      });
      const stream = runtime.createStream();
      stream.append(0, bytes);
      return `${(stream.state.recordCount / Math.min(...times) / 1000).toFixed(3)} M records/s, the first time ${times[0].toFixed(0)} ms`;
    },
    'wedges come from those of the level before': async () => {
      const runtime = await load(wasm);
      const stream = runtime.createStream();
      stream.append(0, bytes);
      const cursor = stream.createCursor();
      const { recordCount } = stream.state;
      assert.throws(() => cursor.origins(1), { code: 'LODESTONE_INVALID_ARGUMENT', message: /where the cursor's is 0/ });
      for (const [coarse, fine] of [[0, recordCount], [Math.floor(recordCount / 2), recordCount], [recordCount, recordCount], [0, 1]]) {
        cursor.seek(coarse);
        const { wedgeCount } = cursor.level;
        cursor.seek(fine);
        const { begin, origins } = cursor.origins(coarse);
        assert.equal(begin, wedgeCount);
        assert.equal(begin + origins.length, cursor.level.wedgeCount);
        origins.forEach((origin) => assert.ok(origin < begin || origins[origin - begin] === origin));
      }
      cursor.destroy();
      stream.destroy();
      return `${recordCount} records`;
    },
    'updates say what wedges come from': () =>
      served({}, async (url) => {
        const stream = await LodestoneStream.open(url, { worker: false, module: wasm, morph: true });
        let before = 0; // wedges
        const take = ({ level, morph }) => {
          const [least, most] = [before, level.wedgeCount].sort((a, b) => a - b);
          if (before > 0 && least < most) {
            assert.equal(morph.begin, least);
            assert.equal(morph.origins.length, most - least);
          }
          before = level.wedgeCount;
        };
        let update = await stream.next();
        for (; !(stream.complete && update.level.deviation === 0); update = await stream.next()) take(update);
        take(update);
        stream.want(stream.chunks[0].deviation);
        take(await stream.next());
        stream.close();
        return 'there and back';
      }),
    'a server of ranges': followed({}),
    'a server without ranges': followed({ ranges: 'no' }),
    'a server that answers other ranges': followed({ ranges: 'wrong' }),
    'a server that answers the first bytes, whatever is asked for': followed({ ranges: 'first' }),
    'connections that break': followed({ drop: 20_000, piece: 5000 }),
    'pieces of 100 bytes, without ranges': followed({ ranges: 'no', piece: 100 }),
    'what breaks at the same byte each time is given up': () =>
      served({ ranges: 'no', drop: Math.floor(bytes.length / 2), piece: 1000 }, async (url, server) => {
        const start = performance.now();
        await assert.rejects(follow(url), { code: 'NETWORK' });
        const time = performance.now() - start;
        assert.ok(server.asked.length <= 6, `${server.asked.length} requests`);
        assert.ok(time > 400, `${time} ms`);
        const half = bytes.subarray(0, Math.ceil(bytes.length / 2));
        const range = { status: 206, headers: { 'content-range': `bytes 0-${half.length - 1}/${bytes.length}` } };
        let asked = 0;
        await assert.rejects(follow(url, { fetch: async () => (++asked, new Response(half, range)) }), { code: 'NETWORK', message: /other ranges/ });
        assert.equal(asked, 3);
        return `${server.asked.length} requests in ${time.toFixed(0)} ms`;
      }),
    'requests that bring nothing are given up': async () => {
      for (const limit of [0, Math.floor(bytes.length / 2)]) {
        await served({ ranges: 'no', limit }, async (url, server) => {
          await assert.rejects(withinTime(follow(url, { idleTimeout: 300 }), PATIENCE), { code: 'NETWORK', message: /nothing comes for 0.3 s/ });
          assert.ok(server.asked.length >= 3 && server.asked.length <= 5, `${server.asked.length} requests`);
          await until(() => server.underWay === 0, 'given up');
        });
      }
      return 'unanswered, and half of the bytes';
    },
    'and made again': () =>
      served({ limit: Math.floor(bytes.length / 2) }, async (url, server) => {
        until(() => server.asked.at(-1)?.end > bytes.length / 2, 'asked for').then(() => setTimeout(() => server.change({ limit: Infinity }), 1000));
        const { sum } = await follow(url, { idleTimeout: 700 });
        assert.equal(sum, whole);
        return `${server.asked.length} requests`;
      }),
    'who asks for nothing is not out of time': () =>
      served({ ranges: 'no', limit: Math.floor(bytes.length / 2) }, async (url, server) => {
        const stream = await LodestoneStream.open(url, { worker: false, module: wasm, deviation: Infinity, idleTimeout: 500 });
        await stream.next();
        await new Promise((resolve) => setTimeout(resolve, 1200));
        server.change({ limit: Infinity });
        stream.want(0);
        for (let update = await stream.next(); !(stream.complete && update.level.deviation === 0); ) update = await stream.next();
        stream.close();
        assert.equal(server.asked.length, 1);
        return 'one request';
      }),
    'a signal gives it up': () =>
      served({ limit: 0 }, async (url, server) => {
        const open = (signal) => LodestoneStream.open(url, { worker: false, module: wasm, signal });
        const first = new AbortController();
        const opening = open(first.signal);
        opening.catch(() => {});
        await until(() => server.underWay === 1, 'asked for');
        first.abort(new Error('enough'));
        await assert.rejects(withinTime(opening, PATIENCE), { message: 'enough' });
        await until(() => server.underWay === 0, 'given up');
        await assert.rejects(withinTime(open(first.signal), PATIENCE), { message: 'enough' });
        assert.equal(server.asked.length, 1);
        server.change({ limit: Infinity });
        const second = new AbortController();
        const stream = await open(second.signal);
        second.abort();
        while (await stream.next());
        assert.ok(stream.ended && !stream.complete);
        return 'before it is open, and after that';
      }),
    'no more than what is wanted is fetched': () =>
      served({}, async (url, server) => {
        const deviation = 0.2 * (await LodestoneStream.open(url, { worker: false, module: wasm })).chunks[0].deviation;
        server.asked.length = 0;
        const stream = await LodestoneStream.open(url, { worker: false, module: wasm, deviation });
        let update = await stream.next();
        while (update.level.deviation > deviation) update = await stream.next();
        await new Promise((resolve) => setTimeout(resolve, 50));
        const fetched = Math.max(...server.asked.map(({ end }) => end));
        stream.want(0);
        while (!(stream.complete && update.level.deviation === 0)) update = await stream.next();
        stream.close();
        assert.ok(bytes.length < 50_000 || fetched < 0.6 * bytes.length, `${fetched} of ${bytes.length}`);
        return `${fetched} of ${bytes.length} bytes, then all`;
      }),
    'what is wanted while the last update is taken counts': () =>
      served({}, async (url) => {
        const stream = await LodestoneStream.open(url, { worker: false, module: wasm });
        const coarse = stream.chunks[0].deviation;
        let update = await stream.next();
        while (!stream.complete || update.level.deviation > 0) update = await stream.next();
        for (const wrong of [NaN, -1, undefined]) assert.throws(() => stream.want(wrong), RangeError);
        for (let ticks = 23; ticks >= 0; --ticks) {
          const { position } = update.level;
          const next = stream.next();
          for (let i = 0; i < ticks; ++i) await null;
          stream.want(ticks % 2 ? coarse : 0);
          const late = new Promise((_, reject) => setTimeout(reject, 5000, new Error(`nothing after ${ticks} ticks`)).unref());
          update = await Promise.race([next, late]);
          assert.notEqual(update.level.position, position);
          while (update.level.deviation !== 0 && ticks % 2 === 0) update = await stream.next();
        }
        stream.close();
        return 'at 24 moments';
      }),
    'several updates may be asked for at once': () =>
      served({}, async (url) => {
        const stream = await LodestoneStream.open(url, { worker: false, module: wasm });
        const asked = stream.chunks.map(() => stream.next());
        const late = new Promise((_, reject) => setTimeout(reject, 20_000, new Error('not all came')).unref());
        const positions = (await Promise.race([Promise.all(asked), late])).map(({ level }) => level.position);
        assert.deepEqual(positions, [...positions].sort((a, b) => a - b));
        assert.equal(new Set(positions).size, positions.length);
        const last = [stream.next(), stream.next()];
        stream.close();
        assert.deepEqual(await Promise.race([Promise.all(last), late]), [undefined, undefined]);
        return `${positions.length} updates`;
      }),
    'what is missing or broken is told': () =>
      served({}, async (url) => {
        await assert.rejects(LodestoneStream.open(`${url}.none`, { worker: false, module: wasm }), { code: 'NETWORK', message: /404/ });
        await assert.rejects(LodestoneStream.open(url, { worker: false, module: wasm, mostBytes: 100 }), { code: 'LODESTONE_LIMIT_EXCEEDED' });
        return '404, limit';
      }),
  };
}

/** Draws a stream at 5, 25 and 100 % of its bytes, and takes pictures. */
function checksOfPage(site, path) {
  const bytes = readFileSync(path).length;
  const native = execFileSync(options.sums, [path], { encoding: 'utf8' }).trim().split('\n').map((line) => line.split(' ').map(Number));
  const name = basename(path, '.lods');
  let page;
  let server;
  const picture = (label) => page.page.screenshot({ path: join(options.output, `stream-${name}-${label}.png`) });
  return {
    'opens while it arrives': async () => {
      const { openPage } = await import('./browser.mjs');
      server = await serveSlowly(folder, { limit: Math.max(4096, Math.ceil(0.01 * bytes)), piece: 1000, rate: 5e6 / 8 });
      page = await openPage(site.browser, `${site.address}/pages/stream.html`);
      const time = await page.ask(([url]) => window.openStream(url, { pixelError: 0 }), [`${server.address}/${basename(path)}`]);
      await page.ask(() => window.watchTasks());
      return `${time.toFixed(0)} ms, before more than ${Math.max(4096, Math.ceil(0.01 * bytes))} bytes`;
    },
    ...Object.fromEntries(
      [5, 25, 100].map((percent) => [
        `at ${percent} % of the bytes`,
        async () => {
          server.change({ limit: percent === 100 ? Infinity : Math.max(4096, Math.ceil((percent / 100) * bytes)) });
          const state = await page.ask((whole) => window.settle(whole), percent === 100);
          await picture(percent);
          assert.equal(state.drawn, state.faceCount);
          assert.equal(state.complete, percent === 100);
          return `${state.faceCount} faces, deviation ${state.deviation.toPrecision(3)}`;
        },
      ]),
    ),
    'ends with the buffers that the native runtime has': async () => {
      const longest = await page.ask(() => window.longestTask());
      assert.equal(await page.ask(() => window.sumOfLevel()), native.at(-1)[0]);
      return `longest task of the page ${longest.toFixed(0)} ms, drawing apart`;
    },
    'is coarser from afar, and the whole again from near': async () => {
      const near = await page.ask(() => window.drawFrame());
      const far = await page.ask(async () => {
        window.setPixelError(1);
        window.moveTo(60);
        return window.settle();
      });
      await page.ask(() => {
        window.setPixelError(0);
        window.moveTo(3.2);
        return window.settle(true);
      });
      const again = await page.ask(() => window.drawFrame());
      assert.ok(far.faceCount < 0.5 * near.faceCount, `${far.faceCount} of ${near.faceCount} faces`);
      assert.equal(again.faceCount, near.faceCount);
      assert.equal(await page.ask(() => window.sumOfLevel()), native.at(-1)[0]);
      await picture('again');
      await page.page.close();
      await server.close();
      return `${far.faceCount} of ${near.faceCount} faces`;
    },
  };
}

/** What is asked of a stream in the worker before it is open. */
function checksOfOpening(site, path) {
  const held = async (job) => {
    const { openPage } = await import('./browser.mjs');
    const server = await serveSlowly(folder, { limit: 0 });
    const page = await openPage(site.browser, `${site.address}/pages/stream.html`);
    try {
      return await job(page, server, `${server.address}/${basename(path)}`);
    } finally {
      await page.page.close();
      await server.close();
    }
  };
  return {
    'a signal gives it up': () =>
      held(async (page, server, url) => {
        await page.ask((address) => {
          window.given = new AbortController();
          window.opening = window.openStream(address, { signal: window.given.signal }).catch(({ message }) => message);
        }, url);
        await until(() => server.underWay === 1, 'asked for');
        const aborted = page.ask(() => {
          window.given.abort(new Error('enough'));
          return window.opening;
        });
        const reason = await withinTime(aborted, PATIENCE);
        assert.equal(reason, 'enough');
        await until(() => server.underWay === 0, 'given up');
        return reason;
      }),
    'and so does time': () =>
      held(async (page, server, url) => {
        const failed = page.ask((address) => window.openStream(address, { idleTimeout: 300 }).catch(({ message }) => message), url);
        const reason = await withinTime(failed, PATIENCE);
        assert.match(String(reason), /nothing comes for 0.3 s/);
        assert.equal(server.asked.length, 3);
        return `${server.asked.length} requests`;
      }),
  };
}

/** Has vertices slide from level to level. */
function checksOfSlides(site, path) {
  const native = execFileSync(options.sums, [path], { encoding: 'utf8' }).trim().split('\n').map((line) => line.split(' ').map(Number));
  let page;
  let server;
  const go = (pixelError, radii) =>
    page.ask(
      ([pixels, distance]) => {
        window.setPixelError(pixels);
        window.moveTo(distance);
        return window.frames(1500);
      },
      [pixelError, radii],
    );
  /** How many frames show something between two levels: others have the numbers of the first and the last. */
  const between = (frames) => {
    const ends = [frames[0].sum, frames.at(-1).sum];
    return new Set(frames.map(({ sum }) => sum).filter((sum) => !ends.includes(sum))).size;
  };
  const isWhole = async () => assert.equal(await page.ask(() => window.sumOfLevel()), native.at(-1)[0]);
  return {
    'ends as without slides': async () => {
      const { openPage } = await import('./browser.mjs');
      server = await serveSlowly(folder, { rate: 1e6, piece: 1000 });
      page = await openPage(site.browser, `${site.address}/pages/stream.html`);
      await page.ask(([url]) => window.openStream(url, { pixelError: 0, morph: 300 }), [`${server.address}/${basename(path)}`]);
      await page.ask(() => window.settle(true));
      await isWhole();
      await assert.rejects(page.ask(([url]) => window.openStream(url, { morph: -1 }), [`${server.address}/${basename(path)}`]), /morph is -1/);
      return 'the native buffers';
    },
    'slides to a coarser level, and then draws that': async () => {
      await page.ask(([url]) => window.openStream(url, { pixelError: 0, morph: 300 }), [`${server.address}/${basename(path)}`]);
      await page.ask(() => window.settle(true));
      const frames = await go(1, 60);
      const meanwhile = frames.filter(({ drawn, faceCount }) => drawn > faceCount).length;
      assert.ok(between(frames) >= 3 && meanwhile >= 3, `${between(frames)} between, ${meanwhile} with more faces`);
      assert.equal(frames.at(-1).drawn, frames.at(-1).faceCount);
      assert.ok(frames.at(-1).drawn < frames[0].drawn);
      return `${between(frames)} frames between`;
    },
    'and back': async () => {
      const frames = await go(0, 3.2);
      assert.ok(between(frames) >= 3, `${between(frames)} between`);
      await isWhole();
      return `${between(frames)} frames between`;
    },
    'and to and fro before it is there': async () => {
      for (let i = 0; i < 6; ++i)
        await page.ask(
          ([distance]) => {
            window.setPixelError(1);
            window.moveTo(distance);
            return window.frames(100);
          },
          [i % 2 ? 3.2 : 60],
        );
      await go(0, 3.2);
      await page.ask(() => window.settle(true));
      await isWhole();
      await page.page.close();
      await server.close();
      return 'the native buffers';
    },
  };
}

const log = new Log();
const streams = buildStreams();
await log.run('module', checksOfModule());
const [small, large] = ['spot_triangulated.lods', 'stanford-bunny.lods'].map((name) => streams.find((path) => basename(path) === name));
if (small && large) await log.run('memory', checksOfMemory(large, small));
for (const path of streams) await log.run(basename(path), checksOfStream(path));
const site = await openSite({ ...options, more: { package: options.package } });
await log.run(`${basename(streams[0])} in a worker`, checksOfOpening(site, streams[0]));
for (const path of streams) await log.run(`${basename(path)} in three.js`, checksOfPage(site, path));
for (const path of streams.filter((path) => path !== large)) await log.run(`${basename(path)} with slides`, checksOfSlides(site, path));
await site.close();
log.close();
