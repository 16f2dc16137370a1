// Counts the triangles that are drawn from 1, 4, 16 and 64 sizes away: by what MSFT_screencoverage means, which UnityGLTF
// takes it for, and as three-gltf-extensions reads it, whose distance is 1 / coverage whatever the object's size.
//
//   node switches.mjs [--models FOLDER] --output FOLDER [NAME …]     of the assets that assets.mjs has built there
import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { chosenAssets } from './assets.mjs';
import { lodChains, parseGlb, trianglesOfScene } from './glb.mjs';
import { Log, openSite, readOptions } from './suite.mjs';

const subjects = ['FlightHelmet', 'Knight', 'RobotExpressive', 'PalmTree', 'cakeBirthday'];
const distances = [1, 4, 16, 64]; // in sizes of the model

// From 64 sizes away a model is 15 pixels high, of 1080.
const largestShareFarAway = 0.6;

/** Values that fall strictly from below 1 to 0. */
function coveragesFall(gltf) {
  const lists = lodChains(gltf).map(([finest]) => gltf.nodes[finest].extras.MSFT_screencoverage);
  for (const list of lists) {
    assert.ok(list[0] < 1 && list.at(-1) === 0, `coverages ${list.join(' ')}`);
    for (let i = 1; i < list.length; ++i) assert.ok(list[i] < list[i - 1], `coverages ${list.join(' ')}`);
  }
  return `${new Set(lists.map(String)).size} objects`;
}

async function drawsLessFarAway(studio, asset, gltf) {
  const { meant, read } = await studio.page.ask((choice) => window.countAtDistances(...choice),
    [studio.url(asset.path), asset.compression, distances]);
  const [whole] = trianglesOfScene(gltf);
  for (const counts of [meant, read]) {
    assert.ok(counts.at(-1) <= largestShareFarAway * whole, `draws ${counts.join(' ')} of ${whole} triangles`);
  }
  return `of ${whole}: ${meant.join(' ')}; three-gltf-extensions by itself: ${read.join(' ')}`;
}

async function main() {
  const options = readOptions();
  const site = await openSite(options);
  const { openPage } = await import('./browser.mjs');
  const page = await openPage(site.browser, `${site.address}/pages/three.html?switches.js`);
  const log = new Log();
  for (const { asset } of chosenAssets(options, subjects)) {
    const gltf = parseGlb(await readFile(asset.path));
    await log.run(asset.name, {
      'coverages': () => coveragesFall(gltf),
      'triangles from afar': () => drawsLessFarAway({ page, url: site.url }, asset, gltf),
    });
  }
  await site.close();
  log.close();
}

await main();
