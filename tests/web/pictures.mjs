// Takes pictures of every level beside its input, at the distance where the level takes over, and measures their likeness.
// The same check must fail on levels with cracks and with scrambled texture coordinates.
//
//   node pictures.mjs [--models FOLDER] --output FOLDER [NAME …]     of the assets that assets.mjs has built there
import assert from 'node:assert/strict';
import { readdirSync } from 'node:fs';
import { readFile, writeFile } from 'node:fs/promises';
import { dirname, join } from 'node:path';
import { chosenAssets } from './assets.mjs';
import { openCracks, scrambleTextures } from './damage.mjs';
import { lodChains, parseGlb } from './glb.mjs';
import { Log, openSite, readOptions } from './suite.mjs';

const subjects = ['suzi', 'tube', 'spot_triangulated', 'spot_triangulated-meshopt', 'FlightHelmet',
  'FlightHelmet-meshopt', 'SheenCloth', 'Lantern_nobasecolor', 'cakeBirthday',
  'RobotExpressive', 'Knight'];

// The screen that MSFT_screencoverage is for. A gap of two pixels is one that nobody should have to look at.
const pixelsOfHeight = 1080;
const pixelsOfGap = 2;

// Smaller than this an object is little more than the windows that pictures are compared by.
const smallestJudged = 48; // pixels

// Levels as they should be: 0.89 and more, most above 0.95. Cracked ones: 0.83 and less, scrambled ones 0.70 and less.
const bound = 0.85;

/** Returns the length of a pixel where each level takes over, finest first, in the scene's units: `size` is its longest side. */
function pixelsOfSwitches(gltf, size) {
  const coverage = gltf.nodes[lodChains(gltf)[0][0]].extras.MSFT_screencoverage;
  return coverage.map((_, level) => (level === 0 ? 0 : size / (pixelsOfHeight * coverage[level - 1])));
}

function describe(site, asset) {
  const pictures = readdirSync(dirname(asset.input)).filter((name) => name.endsWith('.png'));
  const dress = asset.kind === 'mesh' && asset.input.endsWith('.obj')
    ? { bare: true, texture: pictures[0] && site.url(join(dirname(asset.input), pictures[0])) } : {};
  return {
    input: { url: site.url(asset.input), compression: 'draco', ...dress },
    result: { url: site.url(asset.path), compression: asset.compression, ...dress },
  };
}

/** Returns the similarity of every level from `first` on; with a name, the levels go into a sheet of that name. */
async function compareLevels(studio, result, pixels, first, name) {
  await studio.page.ask((file) => window.openAsset(file), result);
  const values = [];
  for (let level = first; level < pixels.length; ++level) {
    const choice = [level, pixels[level], name && `${name} level ${level}`];
    values.push(await studio.page.ask((one) => window.compareLevel(...one), choice));
  }
  if (name) {
    const sheet = await studio.page.ask(() => window.takeSheet());
    await writeFile(join(studio.output, `pictures-${name}.png`), Buffer.from(sheet, 'base64'));
  }
  return values;
}

const judged = (results) => results.filter(({ width }) => width >= smallestJudged);

function looksAlike(results) {
  for (const { value } of judged(results)) assert.ok(value >= bound, `similarity ${text(results)}, below ${bound}`);
}

/** Levels too small to be judged stand in brackets. */
function text(results) {
  return results.map(({ value, width }) => (width >= smallestJudged ? value.toFixed(4) : `(${value.toFixed(4)})`)).join(' ');
}

/** Puts a spoiled file in the place of another, and throws unless the check sees the damage at every level. */
async function isSeen(studio, result, name, bytes, pixels) {
  const path = join(studio.output, `${name}.glb`);
  await writeFile(path, bytes);
  const spoiled = { ...result, compression: 'none', url: studio.url(path) };
  const values = await compareLevels(studio, spoiled, pixels, 1);
  for (const one of judged(values)) assert.throws(() => looksAlike([one]), undefined, `similarity ${text(values)} passes`);
  return text(values);
}

async function checkAsset(log, studio, asset, plain) {
  const { input, result } = describe(studio, asset);
  const bytes = await readFile(plain.path);
  const gltf = parseGlb(bytes);
  const { pixel: full, size } = await studio.page.ask((file) => window.openOriginal(file), input);
  const pixels = pixelsOfSwitches(gltf, size).map((pixel) => Math.max(full, pixel));
  const gaps = pixels.map((pixel) => pixelsOfGap * pixel);
  const coloured = result.texture ||
    gltf.materials?.some(({ pbrMetallicRoughness: surface }) => surface?.baseColorTexture);
  await log.run(asset.name, {
    'like the input': async () => {
      const values = await compareLevels(studio, result, pixels, 0, asset.name);
      looksAlike(values);
      return text(values);
    },
    ...(asset.compression === 'draco' && {
      'cracks are seen': () => isSeen(studio, result, `${asset.name}-cracked`, openCracks(bytes, gaps), pixels),
    }),
    ...(asset.compression === 'draco' && coloured && {
      'scrambled textures are seen': () =>
        isSeen(studio, result, `${asset.name}-scrambled`, scrambleTextures(bytes), pixels),
    }),
  });
}

async function main() {
  const options = readOptions();
  const site = await openSite(options);
  const { openPage } = await import('./browser.mjs');
  const page = await openPage(site.browser, `${site.address}/pages/three.html?pictures.js`);
  const studio = { page, url: site.url, output: options.output };
  const log = new Log();
  for (const { asset, assets } of chosenAssets(options, subjects)) {
    await checkAsset(log, studio, asset, assets.find(({ stem, compression }) => stem === asset.stem && compression === 'none'));
  }
  await site.close();
  log.close();
}

await main();
