// Builds assets with the lodestone program and opens them in the clients that its users have.
//
//   node run.mjs --program PROGRAM [--models FOLDER] --output FOLDER     build assets, then check them
//   node run.mjs --output FOLDER FILE.glb …                              check files that are there already
import { execFile } from 'node:child_process';
import { existsSync, readdirSync } from 'node:fs';
import { mkdir } from 'node:fs/promises';
import { basename, dirname, extname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs, promisify } from 'node:util';
import { readLevels } from './glb.mjs';
import { serve } from './server.mjs';

const here = dirname(fileURLToPath(import.meta.url));
const demoModel = join(here, '..', '..', 'demo', 'suzi.glb');

const { values: options, positionals } = parseArgs({
  allowPositionals: true,
  options: { program: { type: 'string' }, models: { type: 'string' }, output: { type: 'string' } },
});

/** Ends a run that cannot happen on this machine: a failure where the project's own tests run, a remark elsewhere. */
function stopWithout(what) {
  console.log(process.env.CI ? `FAILED: ${what}` : `SKIPPED: ${what}`);
  process.exit(process.env.CI ? 1 : 0);
}

/** Returns the assets to build: what goes in, what it is called, how. */
function plan() {
  const models = options.models ?? '';
  const optional = ['paper/stanford-bunny.obj', 'paper/fandisk.obj'].map((name) => join(models, name)).filter(existsSync);
  return [
    { input: demoModel, name: 'suzi', flags: [] },
    { input: demoModel, name: 'suzi-no-draco', flags: ['--no-draco'] },
    ...optional.map((input) => ({ input, name: basename(input, '.obj'), flags: [] })),
  ];
}

async function buildAssets(output) {
  const files = [];
  for (const { input, name, flags } of plan()) {
    const file = join(output, `${name}.glb`);
    await promisify(execFile)(options.program, ['build', input, '-o', file, '--quiet', ...flags]);
    files.push(file);
  }
  return files;
}

/** Returns the scenes among the models. */
function sceneModels() {
  return ['gltf', 'skin-morph'].map((name) => join(options.models ?? '', name)).filter(existsSync).flatMap((folder) =>
    readdirSync(folder, { recursive: true }).filter((name) => ['.gltf', '.glb'].includes(extname(name))).sort()
      .map((name) => join(folder, name)));
}

/** Builds every scene with and without Draco, and checks each result without any client but the validator. */
async function checkScenes(checks, output) {
  const count = { passed: 0, failed: 0 };
  for (const input of sceneModels()) {
    for (const flags of [[], ['--no-draco']]) {
      const file = join(output, `scene-${basename(input, extname(input))}${flags.join('')}.glb`);
      const build = ['build', input, '-o', file, '--quiet', '--levels', '5', '--ratio', '0.5', ...flags];
      await report(count, basename(file, '.glb'), {
        'build': () => promisify(execFile)(options.program, build).then(() => 'done'),
        'gltf-validator': () => checks.addsNoErrors(input, file),
        'extras': () => checks.chainsAgree(file),
      });
    }
  }
  return count;
}

async function describe(path) {
  const { levels, draco } = await readLevels(path);
  return { path, name: basename(path, '.glb'), url: `/assets/${basename(path)}`, levels, draco };
}

/** Returns the checks of one asset, by name. */
function checksOf(checks, site, asset) {
  return {
    'gltf-validator': () => checks.validates(asset),
    'extras': () => checks.extrasAgree(asset),
    [asset.draco ? 'three.js with DRACOLoader' : 'three.js without a decoder']: () => checks.opensInThree(site, asset),
    'Babylon.js': () => checks.opensInBabylon(site, asset),
    'Babylon.js by byte ranges': () => checks.opensInBabylonByRanges(site, asset),
    'pictures': () => checks.takesPictures(site, asset),
  };
}

/** Runs checks one after the other, prints how each ended and counts them. */
async function report(count, asset, checks) {
  for (const [name, check] of Object.entries(checks)) {
    try {
      console.log(`ok     ${asset}: ${name}: ${await check()}`);
      ++count.passed;
    } catch (error) {
      console.log(`FAILED ${asset}: ${name}: ${error.message}`);
      ++count.failed;
    }
  }
}

async function runChecks(site, checks, assets) {
  const count = { passed: 0, failed: 0 };
  for (const asset of assets) await report(count, asset.name, checksOf(checks, site, asset));
  return count;
}

async function main() {
  if (!existsSync(join(here, 'node_modules', 'three'))) stopWithout('no web clients: run npm ci in tests/web');
  const { findBrowser, launchBrowser } = await import('./browser.mjs');
  const checks = await import('./checks.mjs');
  const browserPath = findBrowser();
  if (!browserPath) stopWithout('no Chromium on this machine');

  const output = resolve(options.output ?? 'build/web');
  await mkdir(output, { recursive: true });
  const files = positionals.length > 0 ? positionals.map((file) => resolve(file)) : await buildAssets(output);
  const assets = await Promise.all(files.map(describe));

  const server = await serve({
    node_modules: join(here, 'node_modules'), pages: join(here, 'pages'), assets: dirname(files[0]),
  });
  const browser = await launchBrowser(browserPath);
  const site = { address: server.address, ranges: server.ranges, browser, output };
  const count = await runChecks(site, checks, assets);
  await browser.close();
  await server.close();
  const scenes = positionals.length > 0 ? { passed: 0, failed: 0 } : await checkScenes(checks, output);
  console.log(`${count.passed + scenes.passed} passed, ${count.failed + scenes.failed} failed`);
  process.exitCode = count.failed + scenes.failed === 0 ? 0 : 1;
}

await main();
