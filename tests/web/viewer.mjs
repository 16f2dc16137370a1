// The viewer's page: it opens what it is given from servers of all kinds, does what its controls say, and fits its window.
//
//   node viewer.mjs --program PROGRAM --package FOLDER [--models FOLDER] --output FOLDER
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { existsSync, mkdirSync, readFileSync } from 'node:fs';
import { basename, join } from 'node:path';
import { openPage } from './browser.mjs';
import { serveSlowly } from './slow_server.mjs';
import { Log, openSite, readOptions, repository, skip } from './suite.mjs';

const options = readOptions();
if (!existsSync(join(options.package, 'lib', 'lodestone.wasm'))) {
  console.log(`SKIPPED: no ${options.package}: run ./run web, which needs Emscripten`);
  process.exit(77);
}
const folder = join(options.output, 'viewer');
const pageFolder = join(options.output, 'viewer-page');
mkdirSync(folder, { recursive: true });

function build(model, name, ...more) {
  if (!existsSync(model)) return skip(model);
  const path = join(folder, name);
  execFileSync(options.program, ['build', model, '-o', path, '-q', '--effort', '3', ...more], { stdio: ['ignore', 'ignore', 'ignore'] });
  return path;
}

execFileSync('node', [
  join(repository, 'tools', 'viewer', 'build.mjs'), '--package', options.package,
  '--three', join(repository, 'tests', 'web', 'node_modules', 'three'), '--output', pageFolder,
]);
const suzi = build(join(repository, 'demo', 'suzi.glb'), 'suzi.lods');
const file = build(join(repository, 'demo', 'suzi.glb'), 'suzi-file.glb', '--profile', 'stream');
const bunny = build(join(options.models, 'paper', 'stanford-bunny.obj'), 'bunny.lods');
const helmet = build(join(options.models, 'gltf', 'FlightHelmet', 'FlightHelmet.gltf'), 'helmet.glb', '--profile', 'stream');

const site = await openSite({ ...options, more: { viewer: pageFolder } });
const server = await serveSlowly(folder, {});
const DESKTOP = { width: 1280, height: 800 };
const PHONE = { width: 390, height: 844 };
const PATIENCE = 60_000; // milliseconds in which something has to change
let page;

/** Opens the page anew; its files come from the server as it behaves. */
async function openViewer({ behaviour = {}, size = DESKTOP, dark = false, query = '' } = {}) {
  await page?.page.close();
  server.change({ ranges: 'yes', rate: undefined, piece: undefined, drop: undefined, swap: false, limit: undefined, ...behaviour });
  page = await openPage(site.browser, `${site.address}/viewer/index.html${query}`);
  await page.page.setViewportSize(size);
  await page.page.emulateMedia({ colorScheme: dark ? 'dark' : 'light' });
}

const addressOf = (path) => `${server.address}/${basename(path)}`;
const queryOf = (paths, more = '') => `?${paths.map((path) => `url=${encodeURIComponent(addressOf(path))}`).join('&')}${more}`;
const state = () => page.ask(() => window.viewer.state);
const picture = (label) => page.page.screenshot({ path: join(options.output, `viewer-${label}.png`) });

/** Waits until the page says that something is so, for as long as what it says changes: a busy machine takes its time. */
async function until(isTrue, what) {
  let last;
  for (let end = Date.now() + PATIENCE; Date.now() < end; await new Promise((resolve) => setTimeout(resolve, 50))) {
    const now = await state();
    if (isTrue(now)) return now;
    if (JSON.stringify(now) !== JSON.stringify(last)) end = Date.now() + PATIENCE;
    last = now;
  }
  throw new Error(`not ${what}: ${JSON.stringify(last)}`);
}

const still = (count = 1) => until(({ isStill, models }) => isStill && models.length === count && models.every(({ faces }) => faces > 0), 'still');
const isWhole = ({ models }) => models.length > 0 && models.every(({ faces, total }) => total && faces === total.faces);

async function fits() {
  const { scroll, width, right } = await page.ask(() => ({
    scroll: document.documentElement.scrollWidth, width: innerWidth,
    right: Math.max(...[...document.querySelectorAll('#panel *')].map((element) => element.getBoundingClientRect().right)),
  }));
  assert.ok(scroll <= width && right <= width + 1, `${scroll} and ${right} of ${width} pixels`);
}

/** What share of the pixels of two screenshots of the picture alone differ. */
async function differs(act) {
  const shoot = () => page.page.locator('#picture').screenshot();
  const before = await shoot();
  await act();
  await still();
  const after = await shoot();
  return page.ask(async (images) => {
    const [a, b] = await Promise.all(images.map(async (image) => {
      const bitmap = await createImageBitmap(await (await fetch(`data:image/png;base64,${image}`)).blob());
      const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext('2d');
      context.drawImage(bitmap, 0, 0);
      return context.getImageData(0, 0, bitmap.width, bitmap.height).data;
    }));
    let count = 0;
    for (let i = 0; i < a.length; i += 4) count += Math.abs(a[i] - b[i]) + Math.abs(a[i + 1] - b[i + 1]) + Math.abs(a[i + 2] - b[i + 2]) > 24;
    return (4 * count) / a.length;
  }, [before, after].map((image) => image.toString('base64')));
}

const servers = {
  'of ranges': {},
  'that is slow': { rate: 60_000, piece: 2000 },
  'without ranges': { ranges: 'no', piece: 1500 },
  'that answers other ranges': { ranges: 'wrong' },
  'that answers the first bytes': { ranges: 'first' },
  'whose connections break': { drop: 9000, piece: 1000 },
};

const checksOfServers = Object.fromEntries(Object.entries(servers).map(([name, behaviour]) => [`a server ${name}`, async () => {
  await openViewer({ behaviour, query: queryOf([suzi], '&error=1e-6') });
  const { models: [model] } = await until(isWhole, 'whole');
  assert.ok(model.points > 1, `${model.points} points of the curve`);
  return `${model.faces} triangles, ${model.bytes} bytes, ${model.points} points of the curve`;
}]));

const checksOfPage = {
  ...checksOfServers,
  'several answers in another order': async () => {
    const paths = [suzi, file, bunny].filter(Boolean);
    await openViewer({ behaviour: { swap: true }, query: queryOf(paths, '&error=1e-6') });
    const { models } = await until((now) => now.models.length === paths.length && isWhole(now), 'whole');
    return models.map(({ faces }) => faces).join(' ');
  },
  'what fails is told, beside what does not': async () => {
    await openViewer();
    await page.page.locator('#url').fill(`${server.address}/none.lods`);
    await page.page.locator('#open button').click();
    await page.page.waitForFunction(() => !document.querySelector('#message').hidden);
    await page.page.locator('#url').fill(addressOf(suzi));
    await page.page.keyboard.press('Enter');
    const { models } = await until(({ models: all }) => all[1]?.faces > 0, 'open');
    await page.page.waitForTimeout(100);
    assert.match(models[0].message, /404/);
    await page.page.locator('#models button').first().click();
    assert.equal((await state()).models.length, 1);
    return models[0].message.replace(/.*: /, '');
  },
  'a stream that breaks off for good stays as far as it came': async () => {
    const bytes = readFileSync(suzi).length;
    await openViewer({ behaviour: { ranges: 'no', drop: Math.floor(bytes / 2), piece: 500 }, query: queryOf([suzi], '&error=1e-6') });
    const { models: [model] } = await until(({ models: [first] }) => first?.message, 'told');
    assert.ok(model.faces > 0 && model.faces < model.total.faces);
    return `${model.faces} of ${model.total.faces} triangles`;
  },
  'files are dropped': async () => {
    await openViewer();
    await page.ask(async ({ stream, glb }) => {
      const list = new DataTransfer();
      for (const [name, base64] of [['a.lods', stream], ['b.glb', glb]])
        list.items.add(new File([Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0))], name));
      document.dispatchEvent(new DragEvent('drop', { dataTransfer: list, bubbles: true, cancelable: true }));
    }, { stream: readFileSync(suzi).toString('base64'), glb: readFileSync(file).toString('base64') });
    await page.ask(() => window.viewer.setMode('error', 1e-6));
    const { models } = await until((now) => now.models.length === 2 && isWhole(now), 'whole');
    assert.equal(models[0].faces, models[1].faces);
    await page.page.locator('#files').setInputFiles(suzi);
    await still(3);
    return models.map(({ faces }) => faces).join(' ');
  },
  'the slider goes by pixels, error and faces': async () => {
    await openViewer({ query: queryOf([suzi]) });
    const faces = {};
    for (const [name, ...amounts] of [['pixels', 20, 2, 0.3], ['error', 0.03, 0.003, 1e-6], ['faces', 1000, 4000, 14_000]]) {
      faces[name] = [];
      for (const amount of amounts) {
        await page.ask(([mode, number]) => window.viewer.setMode(mode, number), [name, amount]);
        const { models: [model], error } = await still();
        faces[name].push(model.faces);
        if (name === 'error') assert.ok(model.shown <= amount, `${model.shown} of ${amount}`);
        if (name === 'faces') assert.ok(model.faces <= amount, `${model.faces} of ${amount}`);
        if (name === 'pixels') assert.equal(error, amount);
      }
      assert.ok(faces[name][0] < faces[name][1] && faces[name][1] < faces[name][2], `${name}: ${faces[name]}`);
    }
    return Object.values(faces).map((list) => list.join(' ')).join(', ');
  },
  'far away is coarser, by pixels': async () => {
    await openViewer({ query: queryOf([suzi]) });
    const near = (await still()).models[0].faces;
    await page.ask(() => window.viewer.turn(0, 0, 10));
    const far = (await still()).models[0].faces;
    assert.ok(far < 0.5 * near, `${far} of ${near}`);
    return `${far} of ${near} triangles`;
  },
  'keys do what the page says': async () => {
    await openViewer({ query: queryOf([suzi], '&pixels=4') });
    await still();
    await page.page.locator('#picture').focus();
    const turned = await differs(() => page.page.keyboard.press('ArrowLeft'));
    const wire = await differs(() => page.page.keyboard.press('w'));
    const plain = await differs(() => page.page.keyboard.press('w'));
    assert.ok(turned > 0.02 && wire > 0.02 && plain > 0.02, `${turned} ${wire} ${plain}`);
    await page.page.keyboard.press('g');
    assert.ok(await page.ask(() => document.querySelector('input[value="faces"]').checked));
    const before = await page.ask(() => document.querySelector('#amount').value);
    await page.page.keyboard.press('[');
    assert.ok((await page.ask(() => document.querySelector('#amount').value)) > before);
    for (let i = 0; i < 5; ++i) await page.page.keyboard.press('Tab'); // on to the controls
    assert.notEqual(await page.ask(() => document.activeElement.tagName), 'BODY');
    return `${(100 * turned).toFixed(0)}, ${(100 * wire).toFixed(0)} % of the picture`;
  },
  'the error map measures what is shown': async () => {
    await openViewer({ query: queryOf([suzi], '&error=1e-6') });
    await until(isWhole, 'whole');
    await page.ask(() => window.viewer.setMode('error', 0.01));
    await still();
    const coloured = await differs(() => page.page.keyboard.press('h'));
    const { models: [coarse] } = await until(({ models: [model] }) => model.isMeasured && model.worstHeat > 0, 'measured');
    await picture('heat');
    // It is of vertices, the deviation of all points: it cannot be larger, and where much is missing it is not far smaller.
    assert.ok(coarse.worstHeat <= coarse.shown && coarse.worstHeat > 0.1 * coarse.shown, `${coarse.worstHeat} of ${coarse.shown}`);
    assert.ok(coloured > 0.02);
    await page.ask(() => window.viewer.setMode('error', 1e-6));
    await until((now) => isWhole(now) && now.models[0].isMeasured && now.models[0].worstHeat === 0, 'without error');
    return `${coarse.worstHeat.toExponential(1)} of ${coarse.shown.toExponential(1)}`;
  },
  'models share triangles': async () => {
    const paths = [suzi, file, bunny, helmet].filter(Boolean);
    await openViewer({ query: queryOf(paths, '&faces=30000') });
    const { models, drawn } = await still(paths.length);
    assert.ok(drawn <= 30_000 && drawn > 10_000, `${drawn} triangles`);
    await picture('desktop');
    await fits();
    await page.page.emulateMedia({ colorScheme: 'dark' });
    await page.page.keyboard.press('w');
    await still(paths.length);
    await picture('desktop-dark');
    return `${models.map(({ faces }) => faces).join(' ')} of 30000`;
  },
  'fits a phone': async () => {
    for (const dark of [false, true]) {
      await openViewer({ size: PHONE, dark, query: queryOf([suzi, bunny].filter(Boolean)) });
      await still(bunny ? 2 : 1);
      await picture(`phone${dark ? '-dark' : ''}`);
      await fits();
      const small = await page.ask(() => [...document.querySelectorAll('button, .button span, input[type="range"], .choice span')]
        .filter((element) => element.getBoundingClientRect().height < 30).length);
      assert.equal(small, 0, `${small} controls are too low for a finger`);
    }
    return `${PHONE.width} pixels wide`;
  },
};

const log = new Log();
await log.run('viewer', checksOfPage);
await site.close();
await server.close();
log.close();
