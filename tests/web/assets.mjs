// Builds every asset that the other programs open; several at a time, since each build has one thread.
//
//   node assets.mjs --program PROGRAM [--models FOLDER] --output FOLDER
import { execFile } from 'node:child_process';
import { existsSync, readdirSync } from 'node:fs';
import { mkdir, writeFile } from 'node:fs/promises';
import { availableParallelism } from 'node:os';
import { basename, dirname, extname, join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { promisify } from 'node:util';
import { makeFlawedTube, makeTube } from './made.mjs';
import { Log, readOptions, repository, skip } from './suite.mjs';

const demoModel = join(repository, 'demo', 'suzi.glb');
const large = ['paper/stanford-bunny.obj', 'paper/fandisk.obj'];
const textured = 'mesh/spot/spot_triangulated.obj';
const inSeveralFiles = ['gltf/Lantern/Lantern_nobasecolor.gltf', 'skin-morph/Knight.glb'];
const severalKinds = ['gltf/FlightHelmet/FlightHelmet.gltf', 'skin-morph/Knight.glb', 'skin-morph/MorphStressTest.gltf'];
const withMaterial = 'field/cube with material.obj';
const plain = ['--compress', 'none'];
const packed = ['--compress', 'meshopt'];

function variants(input, kind, output, flagSets) {
  const stem = basename(input, extname(input));
  return flagSets.map((flags) => {
    const compression = flags[flags.indexOf('--compress') + 1] ?? 'draco';
    const name = flags.length > 0 ? `${stem}-${compression}` : stem;
    return { name, stem, kind, input, flags, compression, path: join(output, `${name}.glb`) };
  });
}

/** The same as several files, in a folder of its own: images keep the names that they had. */
function asSeveralFiles(asset) {
  const name = `${asset.name}.gltf`;
  return { ...asset, name, path: join(dirname(asset.path), 'gltf', asset.name, name) };
}

function sceneModels(models) {
  return ['gltf', 'skin-morph'].map((name) => join(models, name)).filter(existsSync).flatMap((folder) =>
    readdirSync(folder, { recursive: true }).filter((name) => ['.gltf', '.glb'].includes(extname(name))).sort()
      .map((name) => join(folder, name)));
}

/** The models of our own, by file. */
const madeModels = (output) =>
  ({ [join(output, 'made', 'tube.glb')]: makeTube, [join(output, 'made', 'flawed.glb')]: makeFlawedTube });

/** Returns all assets: what goes in, what comes out, how; `kind` is `mesh` for one bare mesh, else `scene`. */
export function planAssets({ models, output }) {
  const found = (names) => names.map((name) => join(models, name)).filter(existsSync);
  const made = Object.keys(madeModels(output));
  const scenes = [...made, ...sceneModels(models)].flatMap((input) => variants(input, 'scene', output, [[], plain]));
  const packedScenes = [...made, ...found(severalKinds)].flatMap((input) => variants(input, 'scene', output, [packed]));
  return [
    ...[demoModel, ...found([textured])].flatMap((input) => variants(input, 'mesh', output, [[], plain, packed])),
    ...found(large).flatMap((input) => variants(input, 'mesh', output, [[]])),
    ...scenes,
    ...packedScenes,
    ...scenes.filter(({ input }) => [made[0], ...found(inSeveralFiles)].includes(input)).map(asSeveralFiles),
    ...found([withMaterial]).flatMap((input) => variants(input, 'scene', output, [plain])).map(asSeveralFiles),
    ...packedScenes.slice(0, 1).map(asSeveralFiles),
  ];
}

/** Yields the assets of these names that are there, of those named on the command line instead where any are. */
export function* chosenAssets(options, subjects) {
  const assets = planAssets(options);
  for (const name of options.files.length > 0 ? options.files : subjects) {
    const asset = assets.find((one) => one.name === name);
    if (asset && existsSync(asset.path)) yield { asset, assets };
    else skip(name);
  }
}

async function build(program, { input, path, flags }) {
  await mkdir(dirname(path), { recursive: true });
  const { stderr } = await promisify(execFile)(program,
    ['build', input, '-o', path, '--quiet', '--levels', '5', '--ratio', '0.5', ...flags]);
  return stderr.includes('warning') ? 'with warnings' : 'done';
}

async function main() {
  const options = readOptions();
  for (const [path, make] of Object.entries(madeModels(options.output))) {
    await mkdir(dirname(path), { recursive: true });
    await writeFile(path, make());
  }
  const waiting = planAssets(options);
  const log = new Log();
  const work = async () => {
    for (let asset = waiting.shift(); asset; asset = waiting.shift()) {
      const one = asset;
      await log.run(one.name, { build: () => build(options.program, one) });
    }
  };
  await Promise.all(Array.from({ length: availableParallelism() }, work));
  log.close();
}

if (import.meta.url === pathToFileURL(process.argv[1]).href) await main();
