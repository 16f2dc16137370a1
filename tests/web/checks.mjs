// What must be true of a multi-LOD .glb in each client. Every check throws with the reason, or returns a line for the log.
import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { dirname, extname, join } from 'node:path';
import validator from 'gltf-validator';
import { lodChains, readDocument, trianglesOfAccessors } from './glb.mjs';

const severityOfInfos = 2; // errors are 0, warnings 1

const triangles = (levels) => levels.map((level) => level.triangles);

/** Khronos' validator: no error and no warning. It does not look inside Draco or meshopt; the clients do. */
export async function validates(asset) {
  const report = await validator.validateBytes(new Uint8Array(await readFile(asset.path)), { maxIssues: 100 });
  const { numErrors, numWarnings, numInfos, messages } = report.issues;
  const serious = messages.filter((message) => message.severity < severityOfInfos);
  const text = serious.map(({ code, message, pointer }) => `${code} ${pointer}: ${message}`).join('\n');
  assert.equal(numErrors + numWarnings, 0, text);
  return `${numInfos} infos`;
}

const isGltf = (path) => ['.glb', '.gltf'].includes(extname(path));

/** Returns what the validator finds in a file, with the files beside it. */
async function complaintsOf(path) {
  const besides = (uri) => readFile(join(dirname(path), decodeURIComponent(uri))).then((bytes) => new Uint8Array(bytes));
  const report = await validator.validateBytes(new Uint8Array(await readFile(path)),
    { maxIssues: 0, externalResourceFunction: besides });
  return report.issues.messages;
}

/** What is found in each primitive or channel, whatever its data: the input's own, once for each level. */
const comesWithLevels = new Set(['MESH_PRIMITIVE_GENERATED_TANGENT_SPACE', 'MESH_PRIMITIVE_NO_TANGENT_SPACE',
  'MESH_PRIMITIVE_TOO_FEW_TEXCOORDS', 'MESH_PRIMITIVE_TANGENT_WITHOUT_NORMAL', 'UNUSED_MESH_TANGENT',
  'INCOMPLETE_EXTENSION_SUPPORT', 'UNUSED_OBJECT']);

const unknownExtensions = ['MSFT_lod', 'KHR_draco_mesh_compression', 'EXT_meshopt_compression',
  'LODESTONE_removal_stream'];

/** Returns the pointers of what only extensions use that the validator does not know: it takes them for unused. */
function usedByExtensions(gltf) {
  const views = gltf.meshes.flatMap((mesh) => [mesh, ...mesh.primitives])
    .flatMap(({ extensions = {} }) => unknownExtensions.map((name) => extensions[name]?.bufferView));
  const nodes = lodChains(gltf).flatMap(([, ...lower]) => lower);
  return [...views.map((view) => `/bufferViews/${view}`), ...nodes.map((node) => `/nodes/${node}`)];
}

/** Returns the pointers of what stands where something was that is no longer there, for the sake of others' numbers. */
function placeholders(gltf) {
  return gltf.bufferViews.flatMap(({ byteLength }, view) => (byteLength === 1 ? [`/bufferViews/${view}`] : []));
}

/** Returns a filter of what is no fault of the file. */
function isNoFaultOf(gltf) {
  const unused = new Set([...usedByExtensions(gltf), ...placeholders(gltf)]);
  return ({ code, message, pointer }) => (code === 'UNUSED_OBJECT' && unused.has(pointer)) ||
    (code === 'UNSUPPORTED_EXTENSION' && unknownExtensions.some((name) => message.includes(`'${name}'`)));
}

/** Returns how many meshes have come of each of the input's, by its number: coarser levels are of one node each. */
function countCopies(gltf) {
  const copies = new Map();
  for (const [finest, ...lower] of lodChains(gltf)) {
    const { mesh } = gltf.nodes[finest];
    copies.set(mesh, (copies.get(mesh) ?? 1) + lower.length);
  }
  return copies;
}

/** Returns how often a complaint about the input may come in the output. */
function allowedOf({ code, pointer }, copies) {
  if (!comesWithLevels.has(code)) return 1;
  const mesh = /^\/meshes\/(\d+)/.exec(pointer);
  return mesh ? copies.get(Number(mesh[1])) ?? 1 : Math.max(...copies.values());
}

/**
 * Khronos' validator finds nothing in the output, hints included, more often than in the input; but see above. Of an input
 * that is no glTF it knows nothing: no error and no warning then.
 */
export async function multipliesNoComplaints(input, output) {
  const gltf = await readDocument(output);
  const isNoFault = isNoFaultOf(gltf);
  const copies = countCopies(gltf);
  const allowed = new Map();
  for (const complaint of isGltf(input) ? await complaintsOf(input) : []) {
    allowed.set(complaint.code, (allowed.get(complaint.code) ?? 0) + allowedOf(complaint, copies));
  }
  const found = new Map();
  for (const complaint of await complaintsOf(output)) {
    if (isNoFault(complaint) || (!isGltf(input) && complaint.severity >= severityOfInfos)) continue;
    const { code, pointer, message } = complaint;
    found.set(code, (found.get(code) ?? 0) + 1);
    const excess = `more than ${allowed.get(code) ?? 0} × ${code}, ${pointer}: ${message}`;
    assert.ok(found.get(code) <= (allowed.get(code) ?? 0), excess);
  }
  return found.size === 0 ? 'no complaints' : `only the input's own: ${[...found.keys()].join(', ')}`;
}

/** In every chain of levels, the extras' face counts are what the accessors hold. */
export async function chainsAgree(output) {
  const gltf = await readDocument(output);
  const chains = lodChains(gltf);
  for (const node of chains.flat()) assert.equal(gltf.nodes[node].extras.lodestone.faces, trianglesOfAccessors(gltf, node));
  return `${chains.length} chains of ${chains[0].length} levels`;
}

/** The extras tell the truth: each level's face count is what its accessors hold. */
export async function extrasAgree(asset) {
  for (const { extras, triangles: held } of asset.levels) assert.equal(extras.faces, held);
  return triangles(asset.levels).join(' ');
}

async function loadInThree(pages, asset) {
  const nodes = asset.levels.map((level) => level.node);
  return pages.levels.ask((choice) => window.loadLevels(...choice), [asset.url, nodes, asset.compression]);
}

/** three.js shows the finest level by default and loads every other; without Draco it has no decoder at hand. */
export async function opensInThree(pages, asset) {
  const loaded = await loadInThree(pages, asset);
  assert.deepEqual(loaded.levels, triangles(asset.levels));
  assert.equal(loaded.scene, asset.levels[0].triangles);
  return loaded.levels.join(' ');
}

/** Pictures of the levels, for a person to look at. */
export async function takesPictures(pages, site, asset) {
  await loadInThree(pages, asset);
  for (let level = 0; level < asset.levels.length; ++level) {
    await pages.levels.ask((number) => window.drawLevel(number), level);
    await pages.levels.page.locator('canvas').screenshot({ path: join(site.output, `${asset.name}-level-${level}.png`) });
  }
  return `${asset.name}-level-*.png`;
}

async function loadInBabylon(pages, url, useRangeRequests) {
  return pages.babylon.ask((choice) => window.loadProgressively(...choice), [url, useRangeRequests]);
}

/** Babylon.js loads every level and ends with the finest. With the whole file at hand, levels may pass before it tells. */
export async function opensInBabylon(pages, asset) {
  const { shown, last } = await loadInBabylon(pages, asset.url, false);
  assert.equal(shown.length, asset.levels.length);
  assert.equal(last, asset.levels[0].triangles);
  return `${last} after ${shown.length} levels`;
}

/** Read by byte ranges it shows level after level, coarsest first, and reads the file from front to back, no byte twice. */
export async function opensInBabylonByRanges(pages, site, asset) {
  site.ranges.length = 0;
  const { shown } = await loadInBabylon(pages, asset.url, true);
  assert.deepEqual(shown, triangles(asset.levels).reverse());
  const requests = site.ranges.filter((range) => range.path === asset.path);
  assert.ok(requests.length > asset.levels.length, `only ${requests.length} requests`);
  for (let i = 1; i < requests.length; ++i) assert.ok(requests[i].first > requests[i - 1].last, 'ranges overlap');
  return `${shown.join(' ')}; ${requests.map(({ first, last }) => last - first + 1).join(' + ')} bytes`;
}
