// Files of `build --profile stream` in a page that refines them: by how they are seen, and in the end they look like what they
// were made of, in any pose.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { existsSync, mkdirSync, writeFileSync } from 'node:fs';
import { basename, dirname, extname, join } from 'node:path';
import { openPage } from './browser.mjs';
import { readDocument, trianglesOfScene } from './glb.mjs';
import { makeCrowd, makeMixedTube, makeTube } from './made.mjs';
import { serveSlowly } from './slow_server.mjs';
import { Log, openSite, readOptions, repository, skip, until } from './suite.mjs';

const leastLikeness = 0.98; // of 1: what differs is rounded to the stream's grids
const slideTime = 400; // milliseconds
const mostHoles = 0.002; // of the pixels that are covered; none of them near an outline
const leastNear = 0.85; // of 1: what is less like the original may leave out parts of it, where no crack is
const mostWorse = 0.005; // by how much a picture may be less like the original than one of fewer bytes
const leastAtPixel = 0.97; // of 1: no surface lies farther off than a pixel

const options = readOptions();
if (!existsSync(join(options.package, 'lib', 'lodestone.wasm'))) {
  console.log(`SKIPPED: no ${options.package}: run ./run web, which needs Emscripten`);
  process.exit(77);
}

/** The models that are there, or those of them that are named: a .glb has its streams in it, a .gltf beside it. */
function subjects(folder) {
  const made = (name, bytes) => {
    const path = join(folder, `${name}-input.glb`);
    writeFileSync(path, bytes);
    return path;
  };
  const wanted = [
    [join(repository, 'demo', 'suzi.glb'), 'glb'],
    [made('tube', makeTube()), 'gltf'],
    [made('mixed', makeMixedTube()), 'glb'],
    [made('crowd', makeCrowd()), 'gltf'],
    [join(options.models, 'gltf', 'FlightHelmet', 'FlightHelmet.gltf'), 'gltf'],
    [join(options.models, 'skin-morph', 'Knight.glb'), 'glb'],
    [join(options.models, 'skin-morph', 'MorphStressTest.gltf'), 'glb'],
  ];
  return wanted.flatMap(([model, format]) => {
    if (!existsSync(model)) return skip(model) ?? [];
    const name = basename(model, extname(model));
    if (options.files.length > 0 && !options.files.includes(name)) return [];
    const build = (...place) => {
      const path = join(folder, name, ...place);
      mkdirSync(dirname(path), { recursive: true });
      execFileSync(options.program, ['build', model, '-o', path, '-q', '--profile', 'stream', '--effort', '3'],
        { stdio: ['ignore', 'ignore', 'ignore'] });
      return path;
    };
    const path = build(`${name}.${format}`);
    return [{ name, model, path, slides: !model.startsWith(options.models), beside: format === 'gltf' ? path : build('beside', `${name}.gltf`) }];
  });
}

function checksOf(site, page, { name, model, path, beside }, prefix) {
  const picture = (label) => page.page.screenshot({ path: join(options.output, `${prefix}-${name}-${label}.png`) });
  const settle = () => page.ask(() => window.settle());
  let whole;
  let shown;
  return {
    'opens with what every viewer shows': async () => {
      await page.ask(() => window.forget());
      await page.ask((url) => window.openFile(url, 'draco', false), site.url(model));
      whole = await settle();
      await page.ask(() => window.keepPicture());
      await picture('original');
      assert.equal(await page.ask((url) => window.openFile(url, 'draco', true), site.url(model)), 0);
      assert.equal((await settle()).drawn, whole.drawn, 'an ordinary file is another with the plugin');
      const meshes = await page.ask((url) => window.openFile(url, 'draco', true), site.url(path));
      assert.ok(meshes > 0);
      await page.ask(() => {
        window.setPixelError(1e9);
        window.drawFrame();
      });
      shown = await settle();
      assert.equal(shown.bytes, 0, 'what nobody asked for is fetched');
      assert.equal(shown.refined, 0);
      [shown.triangles] = trianglesOfScene(await readDocument(path));
      await picture('first');
      return `${meshes} meshes, ${shown.drawn} of ${whole.drawn} triangles drawn`;
    },
    'refines to a pixel': async () => {
      await page.ask(() => window.setPixelError(1));
      const state = await settle();
      assert.ok(state.refined > 0 && state.drawn > shown.drawn, `${state.drawn} triangles`);
      await picture('pixel');
      const likeness = await page.ask(() => window.likeKept());
      assert.ok(likeness >= leastAtPixel, `similarity ${likeness.toFixed(4)}`);
      return `${state.drawn} triangles, ${state.bytes} bytes, similarity ${likeness.toFixed(4)}`;
    },
    'is coarser from afar': async () => {
      const near = await settle();
      await page.ask(() => window.moveTo(40));
      const far = await settle();
      await page.ask(() => window.moveTo(3.4));
      const again = await settle();
      assert.ok(far.drawn < 0.7 * near.drawn, `${far.drawn} of ${near.drawn} triangles`);
      // More may have arrived since, by which it is known better where it lies.
      assert.ok(again.drawn >= 0.6 * near.drawn && again.drawn > 1.2 * far.drawn, `${again.drawn} of ${near.drawn} triangles again`);
      return `${far.drawn} of ${near.drawn} triangles`;
    },
    'ends as the original': async () => {
      const state = await page.ask(() => window.finish());
      assert.equal(state.drawn, whole.drawn);
      const likeness = await page.ask(() => window.likeKept());
      await picture('whole');
      assert.ok(likeness >= leastLikeness, `similarity ${likeness.toFixed(4)}`);
      return `${state.drawn} triangles, ${state.bytes} bytes, similarity ${likeness.toFixed(4)}`;
    },
    'is hit by rays': async () => {
      const refined = await page.ask(() => window.hit());
      await page.ask((url) => window.openFile(url, 'draco', false), site.url(model));
      const original = await page.ask(() => window.hit());
      assert.equal(refined === null, original === null);
      assert.ok(original === null || Math.abs(refined - original) < 0.01 * original, `${refined} and ${original}`);
      return original === null ? 'passes both' : refined.toPrecision(4);
    },
    "casts the original's shadow": async () => {
      await page.ask((url) => window.openFile(url, 'draco', false), site.url(model));
      await page.ask(() => window.castShadows(true));
      await page.ask(() => window.keepPicture());
      await page.ask((url) => window.openFile(url, 'draco', true), site.url(path));
      await page.ask(() => window.castShadows(true));
      const coarse = await page.ask(() => window.likeKept());
      await page.ask(() => window.finish());
      const likeness = await page.ask(() => window.likeKept());
      await picture('shadow');
      await page.ask(() => window.castShadows(false));
      assert.ok(likeness >= leastLikeness && likeness > coarse, `similarity ${coarse.toFixed(4)}, then ${likeness.toFixed(4)}`);
      return `similarity ${coarse.toFixed(4)}, then ${likeness.toFixed(4)}`;
    },
    'holds a budget': async () => {
      const most = Math.round(Math.max(0.4 * whole.drawn, 1.5 * shown.drawn));
      await page.ask(([url, triangles]) => window.openFile(url, 'draco', true, triangles), [site.url(path), most]);
      let state = await settle();
      for (let tries = 0; tries < 5 && state.drawn > most; ++tries) state = await settle(); // it takes a while to be known
      assert.ok(state.drawn <= most && state.drawn > shown.drawn, `${state.drawn} of ${most} triangles`);
      await page.ask(() => window.closeFile());
      return `${state.drawn} of ${most} triangles`;
    },
    'moves as the original': async () => {
      for (const time of [0.4, 1.1]) {
        await page.ask((url) => window.openFile(url, 'draco', false), site.url(model));
        await page.ask((at) => {
          window.pose(at);
          window.keepPicture();
        }, time);
        await page.ask((url) => window.openFile(url, 'draco', true), site.url(path));
        await page.ask(() => window.finish());
        const likeness = await page.ask((at) => {
          window.pose(at);
          return window.likeKept();
        }, time);
        await picture(`pose-${time}`);
        assert.ok(likeness >= leastLikeness, `similarity ${likeness.toFixed(4)} at ${time} s`);
      }
      await page.ask(() => window.closeFile());
      return 'two poses';
    },
    'asks for no more once it is closed': async () => {
      const line = await serveSlowly(dirname(beside), { share: 0 });
      try {
        await page.ask((url) => window.openFile(url, 'draco', true), `${line.address}/${basename(beside)}`);
        await page.ask(() => {
          window.setPixelError(0);
          window.drawFrame();
        });
        await until(() => line.underWay > 0, 'asked for');
        const { underWay } = line;
        await page.ask(() => window.closeFile());
        await until(() => line.underWay === 0, 'given up');
        return `${underWay} requests without an answer`;
      } finally {
        await line.close();
      }
    },
    'shows more the more bytes there are': async () => {
      const line = await serveSlowly(dirname(beside), { share: 0, piece: 1000 });
      await page.ask((url) => window.openFile(url, 'draco', false), site.url(model));
      await page.ask(() => window.settle(50));
      const covered = await page.ask(() => window.keepPicture());
      await page.ask((url) => window.openFile(url, 'draco', true), `${line.address}/${basename(beside)}`);
      const seen = [];
      for (const percent of [5, 25, 100]) {
        line.change({ share: percent / 100 });
        await page.ask(() => window.setPixelError(0));
        const { drawn } = percent === 100 ? await page.ask(() => window.finish()) : await page.ask(() => window.settle(400));
        await picture(`${percent}-percent`);
        const [likeness, holes] = await page.ask(async () => [await window.likeKept(), await window.holes()]);
        seen.push({ percent, drawn, likeness, holes });
      }
      await page.ask(() => window.closeFile());
      await line.close();
      const text = seen.map(({ percent, drawn, likeness, holes }) => `${percent} %: ${drawn} triangles, ${likeness.toFixed(4)}, ${holes} holes`).join('; ');
      seen.forEach(({ drawn, likeness, holes }, i) => {
        assert.ok(likeness < leastNear || holes <= mostHoles * covered, text);
        assert.ok(i === 0 || (drawn >= seen[i - 1].drawn && likeness >= seen[i - 1].likeness - mostWorse), text);
      });
      assert.ok(seen[2].likeness >= leastLikeness && seen[0].drawn < seen[2].drawn, text);
      return text;
    },
  };
}

/** Vertices slide from level to level, in a page of its own, and are in the end where they are without. */
function checksOfSlides(site, page, { name, path }, prefix) {
  const picture = (label) => page.page.screenshot({ path: join(options.output, `${prefix}-${name}-${label}.png`) });
  let whole;
  const go = (pixelError, radii, milliseconds) =>
    page.ask(([pixels, distance, time]) => {
      window.setPixelError(pixels);
      window.moveTo(distance);
      return window.frames(time);
    }, [pixelError, radii, milliseconds]);
  const between = (frames) => {
    const ends = [frames[0].sum, frames.at(-1).sum];
    return new Set(frames.map(({ sum }) => sum).filter((sum) => !ends.includes(sum))).size;
  };
  let slides;
  return {
    'slides to a coarser level': async () => {
      const { meshes } = await readDocument(path);
      slides = !prefix.includes('babylon') || !meshes.some(({ primitives }) => primitives.some(({ targets }) => targets));
      await page.ask(() => window.forget());
      await page.ask((url) => window.openFile(url, 'draco', true), site.url(path));
      await page.ask(() => window.finish());
      whole = (await go(0, 3.4, 6 * slideTime)).at(-1);
      const frames = await go(1, 12, slideTime / 2);
      await go(1, 3.4, 1);
      await picture('sliding');
      frames.push(...(await go(1, 12, 6 * slideTime)));
      assert.ok(frames.at(-1).drawn < whole.drawn, `${frames.at(-1).drawn} of ${whole.drawn} triangles`);
      assert.ok(!slides || between(frames) >= 3, `${between(frames)} frames between`);
      return `${between(frames)} frames between, ${frames.at(-1).drawn} of ${whole.drawn} triangles`;
    },
    'and back, to where all was': async () => {
      const frames = await go(0, 3.4, 6 * slideTime);
      for (let tries = 0; tries < 5 && frames.at(-1).sum !== whole.sum; ++tries) frames.push(...(await go(0, 3.4, 6 * slideTime))); // a busy machine
      assert.deepEqual(frames.at(-1), whole);
      assert.ok(!slides || between(frames) >= 3, `${between(frames)} frames between`);
      await page.ask(() => window.closeFile());
      return `${between(frames)} frames between`;
    },
  };
}

/** Checks all models in a page of `pages`; `prefix` is of the names of its pictures. */
export async function checkRefined(name, prefix) {
  const folder = join(options.output, prefix);
  mkdirSync(folder, { recursive: true });
  const log = new Log();
  const found = subjects(folder);
  const site = await openSite({ ...options, more: { package: options.package } });
  const page = await openPage(site.browser, `${site.address}/pages/${name}`);
  for (const subject of found) await log.run(subject.name, checksOf(site, page, subject, prefix));
  const sliding = await openPage(site.browser, `${site.address}/pages/${name}?morph=${slideTime}`);
  for (const subject of found.filter(({ slides }) => slides)) await log.run(`${subject.name} with slides`, checksOfSlides(site, sliding, subject, prefix));
  await site.close();
  log.close();
}
