// Opens the pages that `lodestone compare --html` and `lodestone build --html` write, as a reader would.
//
//   node html_report.mjs --program PROGRAM --output FOLDER     write the pages of the demo's model, then check them
//   node html_report.mjs --output FOLDER PAGE.html …           check pages that are there already
import assert from 'node:assert/strict';
import { execFile } from 'node:child_process';
import { mkdir, stat } from 'node:fs/promises';
import { basename, join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { promisify } from 'node:util';
import { Log, openBrowser, readOptions, repository } from './suite.mjs';

const demoModel = join(repository, 'demo', 'suzi.glb');

const VIEWS = [
  { name: 'light', viewport: { width: 1280, height: 900 }, colorScheme: 'light' },
  { name: 'dark', viewport: { width: 1280, height: 900 }, colorScheme: 'dark' },
  { name: 'phone', viewport: { width: 390, height: 844 }, colorScheme: 'light', isMobile: true, hasTouch: true },
  { name: 'phone-dark', viewport: { width: 390, height: 844 }, colorScheme: 'dark', isMobile: true, hasTouch: true },
];

async function writePages({ program, output }) {
  const run = (...args) => promisify(execFile)(program, args);
  const files = ['report-build.html', 'report-compare.html'].map((name) => join(output, name));
  const asset = join(output, 'report-suzi.glb'), level = join(output, 'report-level.glb');
  await run('build', demoModel, '-o', asset, '--html', files[0], '--quiet');
  await run('extract', asset, '--ratio', '0.05', '-o', level, '--quiet');
  await run('compare', demoModel, level, '--html', files[1]);
  return files;
}

/** Opens a page, waits for its first picture and hands it to `job`; returns what it complained about or asked of the network. */
async function open(browser, file, view, job) {
  const { name, ...settings } = view;
  const context = await browser.newContext(settings);
  const page = await context.newPage();
  page.setDefaultTimeout(180_000);
  const problems = [];
  page.on('pageerror', (error) => problems.push(error.message));
  page.on('console', (message) => ['error', 'warning'].includes(message.type()) && !message.text().includes('GPU stall')
    && problems.push(message.text()));
  page.on('request', (request) => /^(file|data|blob):/.test(request.url()) || problems.push(`asks for ${request.url()}`));
  try {
    await page.goto(pathToFileURL(file).href);
    await page.locator('html[data-ready]').waitFor({ state: 'attached' }); // the page forbids what waitForFunction does
    await picture(page);
    await job(page);
    return problems;
  } finally {
    await context.close();
  }
}

/** Returns what the canvas shows, once it has been drawn: the pixels as text, and how many colours there are. */
async function picture(page) {
  return page.evaluate(() => new Promise((done) => {
    requestAnimationFrame(() => requestAnimationFrame(() => {
      viewer.draw();
      const copy = Object.assign(document.createElement('canvas'), { width: 160, height: 90 });
      const context = copy.getContext('2d');
      context.drawImage(viewer.canvas, 0, 0, 160, 90);
      const { data } = context.getImageData(0, 0, 160, 90);
      const colours = new Set();
      for (let i = 0; i < data.length; i += 4) colours.add(data[i] << 16 | data[i + 1] << 8 | data[i + 2]);
      done({ pixels: data.join(), colours: colours.size });
    }));
  }));
}

async function drawsAndTurns(page) {
  const first = await picture(page);
  assert.ok(first.colours > 200, `the canvas has ${first.colours} colours`);
  await page.locator('#canvas').focus();
  let before = first;
  for (const key of ['ArrowLeft', 'Shift+ArrowUp', '+', 's', 'c']) {
    await page.keyboard.press(key);
    const after = await picture(page);
    assert.notEqual(after.pixels, before.pixels, `${key} changes nothing`);
    before = after;
  }
  for (const key of ['0', 'c', 's', 's', 's']) await page.keyboard.press(key);
  assert.equal((await picture(page)).pixels, first.pixels, '0 does not lead back');
  const { x, y, width } = await page.locator('#canvas').boundingBox();
  await page.mouse.move(x + width / 4, y + 150);
  await page.mouse.down();
  await page.mouse.move(x + width / 4 + 60, y + 180);
  await page.mouse.up();
  const dragged = await picture(page);
  assert.notEqual(dragged.pixels, first.pixels, 'dragging changes nothing');
  await page.mouse.wheel(0, -200);
  assert.notEqual((await picture(page)).pixels, dragged.pixels, 'the wheel changes nothing');
  await page.locator('#reset').click();
  return `${first.colours} colours`;
}

/** Every level can be chosen, by list and by key, and the table stays that of the data. */
async function choosesLevels(page) {
  const lists = await page.locator('.pane select').count();
  const rows = await page.locator('#table tbody tr').count();
  assert.equal(rows, await page.evaluate(() => pictures.length));
  if (lists === 0) return `${rows} surfaces`;
  for (let level = 0; level < rows; ++level) {
    await page.locator('#right').selectOption(String(level));
    await page.evaluate(() => showPanes());
    assert.ok((await picture(page)).colours > 50, `level ${level} is not drawn`);
  }
  await page.locator('#canvas').focus();
  await page.keyboard.press('[');
  assert.equal(await page.locator('#right').inputValue(), String(rows - 2));
  return `${rows} levels`;
}

/** The decoded geometry is the whole of it: as many faces as were announced, all corners of all of them there. */
async function unpacks(page) {
  return page.evaluate(async () => {
    for (const { data, shown_faces: count, errors } of pictures) {
      const { positions, faces } = decodeGeometry(await readBlob(data));
      if (faces.length !== 3 * count) throw new Error(`${faces.length / 3} faces of ${count}`);
      const vertices = positions.length / 3, used = new Uint8Array(vertices);
      for (const v of faces) used[v] = 1;
      if (used.includes(0)) throw new Error('a vertex has no face');
      if (errors && (await readBlob(errors.data)).length === 0) throw new Error('no errors');
    }
    return `${pictures.map(({ shown_faces: count }) => count).join(' ')} faces`;
  });
}

/** Nothing is wider than the screen: a phone scrolls the page up and down only. */
async function fits(page) {
  const { inner, outer } = await page.evaluate(() => ({ inner: document.documentElement.scrollWidth, outer: innerWidth }));
  assert.ok(inner <= outer, `${inner} pixels wide on a screen of ${outer}`);
  return `${inner} pixels wide`;
}

/** A picture of the whole page, for a person to look at. */
function takesPicture(path) {
  return (page) => page.screenshot({ path, fullPage: true }).then(() => path);
}

/** Runs the checks of one page as one reader sees it; the last is that it never complained. */
async function checkView(log, browser, file, view, output) {
  const name = basename(file, '.html');
  const checks = {
    takesPicture: takesPicture(join(output, `${name}-${view.name}.png`)),
    fits,
    ...(view.name === 'light' && { unpacks, drawsAndTurns, choosesLevels }),
  };
  const subject = `${name} ${view.name}`;
  await log.run(subject, {
    'no complaints': async () => {
      const problems = await open(browser, file, view, (page) => log.run(subject, Object.fromEntries(
        Object.entries(checks).map(([what, check]) => [what, () => check(page)]))));
      assert.deepEqual(problems, []);
      return 'none';
    },
  });
}

async function main() {
  const options = readOptions();
  const browser = await openBrowser();
  await mkdir(options.output, { recursive: true });
  const files = options.files.length > 0 ? options.files.map((file) => resolve(file)) : await writePages(options);
  const log = new Log();
  for (const file of files) {
    for (const view of VIEWS) await checkView(log, browser, file, view, options.output);
    console.log(`       ${basename(file, '.html')}: ${(await stat(file)).size} bytes`);
  }
  await browser.close();
  log.close();
}

await main();
