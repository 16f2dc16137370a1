// Whole scenes in the viewers: every level is there, with as many triangles as the file says.
import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { openPage } from './browser.mjs';
import { parseGlb, trianglesOfScene } from './glb.mjs';

/** Opens one page of each viewer for many files: the viewers themselves take longer to load than most files. */
export async function openViewers(site) {
  return {
    three: await openPage(site.browser, `${site.address}/pages/viewer.html`),
    babylon: await openPage(site.browser, `${site.address}/pages/babylon.html`),
  };
}

async function expectedTriangles(asset) {
  return trianglesOfScene(parseGlb(await readFile(asset.path)));
}

/** three.js draws each level of all nodes together. */
export async function drawsInThree(viewers, asset) {
  const drawn = await viewers.three.ask(([url, draco]) => window.drawLevels(url, draco), [asset.url, asset.draco]);
  assert.deepEqual(drawn, await expectedTriangles(asset));
  return drawn.join(' ');
}

/** Babylon.js goes from the coarsest level to the finest by itself; read by ranges, it shows each before it asks for the next. */
export async function loadsInBabylon(viewers, asset) {
  const { shown, last } = await viewers.babylon.ask((url) => window.loadProgressively(url, true), asset.url);
  const expected = await expectedTriangles(asset);
  assert.deepEqual(shown, [...expected].reverse());
  assert.equal(last, expected[0]);
  return shown.join(' ');
}
