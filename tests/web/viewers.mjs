// Whole scenes in the viewers: every level is there, with as many triangles as the file says.
import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { openPage } from './browser.mjs';
import { parseGlb, trianglesOfScene } from './glb.mjs';

/** Opens one page of each viewer for many files: the viewers themselves take longer to load than most files. */
export async function openViewers(site) {
  return {
    three: await openPage(site.browser, `${site.address}/pages/three.html?viewer.js`),
    babylon: await openPage(site.browser, `${site.address}/pages/babylon.html`),
  };
}

function sameTriangles(shown, expected) {
  assert.deepEqual(shown, expected, `shows ${shown.join(' ')} triangles instead of ${expected.join(' ')}`);
}

const readGltf = async (asset) => parseGlb(await readFile(asset.path));

/** three.js draws each level of all nodes together. */
export async function drawsInThree(viewers, asset) {
  const drawn = await viewers.three.ask(([url, draco]) => window.drawLevels(url, draco), [asset.url, asset.draco]);
  sameTriangles(drawn, trianglesOfScene(await readGltf(asset)));
  return drawn.join(' ');
}

/** Babylon.js, told to stop there, shows each level of all nodes together. */
export async function loadsInBabylon(viewers, asset) {
  const expected = trianglesOfScene(await readGltf(asset)).reverse();
  const shown = await viewers.babylon.ask((choice) => window.loadEachLevel(...choice), [asset.url, expected.length]);
  sameTriangles(shown, expected);
  return shown.join(' ');
}

/** Read by byte ranges, Babylon.js shows level after level. */
export async function streamsInBabylon(viewers, asset) {
  const gltf = await readGltf(asset);
  // Babylon.js 9.28 adds animations to the first range after it has asked for it, and then misses their bytes.
  if (gltf.animations) return 'left out: it has animations';
  const { shown } = await viewers.babylon.ask((url) => window.loadProgressively(url, true), asset.url);
  sameTriangles(shown, trianglesOfScene(gltf).reverse());
  return shown.join(' ');
}
