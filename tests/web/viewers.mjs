// Whole scenes in the viewers: every level is there, with as many triangles as the file says.
import assert from 'node:assert/strict';
import { openPage } from './browser.mjs';
import { readDocument, trianglesOfScene } from './glb.mjs';

/** Opens one page of each viewer for many files: the viewers themselves take longer to load than most files. */
export async function openViewers(site) {
  return {
    levels: await openPage(site.browser, `${site.address}/pages/three.html?three.js`),
    three: await openPage(site.browser, `${site.address}/pages/three.html?viewer.js`),
    babylon: await openPage(site.browser, `${site.address}/pages/babylon.html`),
    babylonViewer: await openPage(site.browser, `${site.address}/pages/babylon-viewer.html`),
  };
}

function sameTriangles(shown, expected) {
  assert.deepEqual(shown, expected, `shows ${shown.join(' ')} triangles instead of ${expected.join(' ')}`);
}

/** three.js draws each level of all nodes together. */
export async function drawsInThree(viewers, asset) {
  const drawn = await viewers.three.ask((choice) => window.drawLevels(...choice), [asset.url, asset.compression]);
  sameTriangles(drawn, trianglesOfScene(await readDocument(asset.path)));
  return drawn.join(' ');
}

/** Babylon.js, told to stop there, shows each level of all nodes together. */
export async function loadsInBabylon(viewers, asset) {
  const expected = trianglesOfScene(await readDocument(asset.path)).reverse();
  const shown = await viewers.babylon.ask((choice) => window.loadEachLevel(...choice), [asset.url, expected.length]);
  sameTriangles(shown, expected);
  return shown.join(' ');
}

/** Read by byte ranges, Babylon.js shows level after level. */
export async function streamsInBabylon(viewers, asset) {
  if (asset.path.endsWith('.gltf')) return 'left out: Babylon.js reads ranges of a .glb alone';
  const gltf = await readDocument(asset.path);
  // Babylon.js 9.28 adds animations to the first range after it has asked for it, and then misses their bytes.
  if (gltf.animations) return 'left out: it has animations';
  const { shown } = await viewers.babylon.ask((url) => window.loadProgressively(url, true), asset.url);
  sameTriangles(shown, trianglesOfScene(gltf).reverse());
  return shown.join(' ');
}

const largestDifference = 2; // of 255, in the mean: two drawings of the same

function meanDifference(...pictures) {
  const [a, b] = pictures.map((text) => Buffer.from(text, 'base64'));
  assert.ok(a.length > 0 && a.length === b.length);
  return a.reduce((sum, value, i) => sum + Math.abs(value - b[i]), 0) / a.length;
}

/** What Babylon.js draws of an asset without a container; several checks ask for it. */
function drawPlainly(viewers, asset) {
  asset.drawnPlainly ??= viewers.babylon.ask((choice) => window.drawLoaded(...choice), [asset.url, 'append']);
  return asset.drawnPlainly;
}

/** Out of an asset container, Babylon.js shows the same picture as without: no level takes the others' textures along. */
export async function loadsFromContainer(viewers, asset) {
  const plain = await drawPlainly(viewers, asset);
  const contained = await viewers.babylon.ask((choice) => window.drawLoaded(...choice), [asset.url, 'container']);
  sameTriangles([contained.triangles], [plain.triangles]);
  assert.equal(contained.bare, 0, `${contained.bare} meshes have no material`);
  assert.deepEqual(contained.textures, plain.textures);
  const difference = meanDifference(plain.pixels, contained.pixels);
  assert.ok(difference <= largestDifference, `the pictures differ by ${difference.toFixed(1)}`);
  return `${contained.textures.length} textures, difference ${difference.toFixed(2)}`;
}

/** The official viewer shows the finest level with all textures that the file's materials have. */
export async function showsInBabylonViewer(viewers, asset) {
  if (asset.compression !== 'none') return 'left out: its decoder comes from the network';
  const gltf = await readDocument(asset.path);
  const [finest] = trianglesOfScene(gltf);
  const shown = await viewers.babylonViewer.ask((choice) => window.showInViewer(...choice), [asset.url, finest]);
  sameTriangles([shown.triangles], [finest]);
  const { textures } = await drawPlainly(viewers, asset);
  assert.deepEqual(shown.textures, textures);
  return `${textures.length} textures`;
}
