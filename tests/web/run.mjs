// Opens the program's files with gltf-validator and in the viewers that its users have.
//
//   node run.mjs [--models FOLDER] --output FOLDER     the assets that assets.mjs has built there
//   node run.mjs --output FOLDER FILE.glb …            one-mesh files made by hand
import { basename, dirname, resolve } from 'node:path';
import { planAssets } from './assets.mjs';
import { readLevels } from './glb.mjs';
import { Log, openSite, readOptions } from './suite.mjs';

/** Returns a one-mesh file with what it says of its levels. */
async function describe(site, path) {
  const { levels, compression } = await readLevels(path);
  return { path, name: basename(path, '.glb'), url: site.url(path), levels, compression };
}

/** Returns the checks of a one-mesh asset, by name. */
function checksOfMesh(checks, pages, site, asset) {
  return {
    'gltf-validator': () => checks.validates(asset),
    'extras': () => checks.extrasAgree(asset),
    [`three.js, ${asset.compression}`]: () => checks.opensInThree(pages, asset),
    'Babylon.js': () => checks.opensInBabylon(pages, asset),
    'Babylon.js by byte ranges': () => checks.opensInBabylonByRanges(pages, site, asset),
    'pictures': () => checks.takesPictures(pages, site, asset),
  };
}

/** Returns the checks of a scene, by name. */
function checksOfScene(checks, viewers, pages, asset) {
  return {
    'gltf-validator': () => checks.multipliesNoComplaints(asset.input, asset.path),
    'extras': () => checks.chainsAgree(asset.path),
    'three.js': () => viewers.drawsInThree(pages, asset),
    'Babylon.js': () => viewers.loadsInBabylon(pages, asset),
    'Babylon.js by byte ranges': () => viewers.streamsInBabylon(pages, asset),
    'Babylon.js into an asset container': () => viewers.loadsFromContainer(pages, asset),
    'Babylon.js viewer': () => viewers.showsInBabylonViewer(pages, asset),
  };
}

async function main() {
  const options = readOptions();
  const given = options.files.map((file) => resolve(file));
  const site = await openSite({ ...options, assets: given.length > 0 ? dirname(given[0]) : options.output });
  const checks = await import('./checks.mjs');
  const viewers = await import('./viewers.mjs');
  const pages = await viewers.openViewers(site);
  const log = new Log();
  const planned = given.length > 0 ? [] : planAssets(options);
  const meshes = planned.filter(({ kind }) => kind === 'mesh').map(({ path }) => path);
  for (const path of [...given, ...meshes]) {
    const asset = await describe(site, path);
    await log.run(asset.name, checksOfMesh(checks, pages, site, asset));
  }
  for (const asset of planned.filter(({ kind }) => kind === 'scene')) {
    await log.run(asset.name, checksOfScene(checks, viewers, pages, { ...asset, url: site.url(asset.path) }));
  }
  await site.close();
  log.close();
}

await main();
