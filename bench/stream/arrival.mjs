// What a page in three.js shows when, while a model comes over a slow line: a file of `--profile stream` by the package's
// plugin, beside the whole model in one piece by Draco, by meshoptimizer and, where its npm package is named, by gltfpack -cc.
// Materials are left without their images, which would take longer than any geometry.
//
//   node bench/stream/arrival.mjs --program PROGRAM --package FOLDER --output FOLDER [--gltfpack FOLDER/cli.js] MODEL.gltf
//
// Needs what ./run web builds. All connections share one line of 5 Mbit/s with 40 ms from a request to its first byte. A frame is
// drawn once the one before it is through, since hundreds would pile up in software: a busy machine draws seldomer, which makes what
// is seen later, and all else a little. The longest turn is of the page's event loop: what the package does there with an update, and
// whatever else does not let a timer run when it is due. Neither drawing nor waiting for it is in it; on a busy machine the time
// that the page's thread waits for a core is.
import { execFileSync } from 'node:child_process';
import { copyFileSync, mkdirSync, readFileSync, statSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { openPage } from '../../tests/web/browser.mjs';
import { serveSlowly } from '../../tests/web/slow_server.mjs';
import { openSite, readOptions } from '../../tests/web/suite.mjs';

const runs = 3;

/** The model without images. */
function plainModel(model, folder) {
  const json = JSON.parse(readFileSync(model, 'utf8'));
  for (const key of ['images', 'textures', 'samplers']) delete json[key];
  for (const material of json.materials ?? []) for (const key of Object.keys(material)) if (key !== 'name' && key !== 'doubleSided') delete material[key];
  for (const { uri } of json.buffers) copyFileSync(join(dirname(model), uri), join(folder, uri));
  const path = join(folder, 'plain.gltf');
  writeFileSync(path, JSON.stringify(json));
  return path;
}

const options = readOptions();
const folder = join(options.output, 'arrival');
mkdirSync(folder, { recursive: true });
const plain = plainModel(options.files[0], folder);
const files = [
  ['stream', 'stream.glb', ['--profile', 'stream'], 'draco', true],
  ['stream, files beside', 'streams.gltf', ['--profile', 'stream'], 'draco', true],
  ['whole, Draco', 'draco.glb', ['--levels', '1', '--no-stream'], 'draco', false],
  ['whole, meshopt', 'meshopt.glb', ['--levels', '1', '--no-stream', '--compress', 'meshopt'], 'meshopt', false],
];
for (const [, name, settings] of files)
  execFileSync(options.program, ['build', plain, '-o', join(folder, name), '-q', ...settings], { stdio: ['ignore', 'ignore', 'ignore'] });
if (options.gltfpack) {
  // By itself it drops what no material uses, which is all but positions and normals once images are gone.
  for (const [name, settings] of [['gltfpack.glb', ['-cc']], ['gltfpack-kv.glb', ['-cc', '-kv']]]) {
    execFileSync('node', [options.gltfpack, '-i', plain, '-o', join(folder, name), ...settings], { stdio: ['ignore', 'ignore', 'inherit'] });
    files.push([`whole, gltfpack ${settings.join(' ')}`, name, settings, 'meshopt', false]);
  }
}

/** Of a .gltf all that it names, too. */
function bytesOf(name) {
  const path = join(folder, name);
  if (!name.endsWith('.gltf')) return statSync(path).size;
  const { buffers = [], meshes = [] } = JSON.parse(readFileSync(path, 'utf8'));
  const beside = [...buffers, ...meshes.map(({ extensions }) => extensions?.LODESTONE_removal_stream ?? {})].map(({ uri }) => uri).filter(Boolean);
  return statSync(path).size + beside.reduce((sum, uri) => sum + statSync(join(folder, decodeURIComponent(uri))).size, 0);
}

const site = await openSite({ ...options, more: { package: options.package } });
const line = await serveSlowly(folder, { line: 5e6 / 8, delay: 40, piece: 2048 });
const page = await openPage(site.browser, `${site.address}/pages/refined.html`);

/** Seconds from the request on: when something is first drawn, when nothing changes any more within a pixel, when all is there. */
async function arrive([, name, , compression, refines]) {
  await page.ask(() => window.forget());
  const times = await page.ask(async ([url, compression, refines]) => {
    const start = performance.now();
    const since = () => (performance.now() - start) / 1000;
    await window.openFile(url, compression, refines);
    window.drawFrame();
    const times = { first: since(), longest: 0 };
    if (!refines) return { ...times, pixel: times.first, end: times.first, triangles: window.drawFrame().drawn, fetched: 0 };
    window.setPixelError(1);
    let last = window.drawFrame();
    times.pixel = since();
    for (let changed = performance.now(); performance.now() - changed < 1500; ) {
      await window.pace(4, (held) => {
        times.longest = Math.max(times.longest, held);
      });
      const state = window.drawFrame();
      if (state.bytes !== last.bytes || state.drawn !== last.drawn) [times.pixel, changed] = [since(), performance.now()];
      last = state;
    }
    times.triangles = last.drawn;
    times.fetched = last.bytes;
    return times;
  }, [`${line.address}/${name}`, compression, refines]);
  if (refines) {
    await page.ask(() => window.closeFile());
    times.end = await page.ask(async ([url, compression]) => {
      const start = performance.now();
      await window.openFile(url, compression, true);
      await window.arrive();
      window.drawFrame();
      return (performance.now() - start) / 1000;
    }, [`${line.address}/${name}`, compression]);
  }
  await page.ask(() => window.closeFile());
  return times;
}

const median = (values) => values.sort((a, b) => a - b)[Math.floor(values.length / 2)];
const seen = files.map(() => []);
for (let run = 0; run < runs; ++run) for (const [i, file] of files.entries()) seen[i].push(await arrive(file));
console.log('| | bytes | first picture, s | within a pixel, s | triangles then | of streams, bytes | all, s | longest turn, ms |\n|---|---|---|---|---|---|---|---|');
for (const [i, [title, name]] of files.entries()) {
  const of = (key) => median(seen[i].map((times) => times[key]));
  console.log(`| ${title} | ${bytesOf(name)} | ${of('first').toFixed(2)} | ${of('pixel').toFixed(2)} | ${of('triangles')} | ${of('fetched')} | ${of('end').toFixed(2)} | ${of('longest').toFixed(0)} |`);
}
await line.close();
await site.close();
