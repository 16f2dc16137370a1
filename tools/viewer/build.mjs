// Puts the viewer together: its page, the npm package and three.js beside it, in a folder that any host of files can serve.
//
//   node build.mjs --package FOLDER --three FOLDER --output FOLDER
import { cpSync, mkdirSync, readdirSync, rmSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';

const here = dirname(fileURLToPath(import.meta.url));
const string = { type: 'string' };
const { values } = parseArgs({ options: { package: string, three: string, output: string } });

/** Of three.js, what the page imports. */
const THREE = [
  'LICENSE',
  'build/three.module.js',
  'build/three.core.js',
  'examples/jsm/controls/OrbitControls.js',
  'examples/jsm/environments/RoomEnvironment.js',
  'examples/jsm/loaders/DRACOLoader.js',
  'examples/jsm/loaders/GLTFLoader.js',
  'examples/jsm/libs/draco/gltf',
  'examples/jsm/utils/BufferGeometryUtils.js',
  'examples/jsm/utils/SkeletonUtils.js',
];

rmSync(values.output, { recursive: true, force: true });
mkdirSync(values.output, { recursive: true });
for (const name of readdirSync(here)) if (/\.(html|css|js)$/.test(name)) cpSync(join(here, name), join(values.output, name));
cpSync(values.package, join(values.output, 'lodestone'), { recursive: true });
for (const path of THREE) cpSync(join(values.three, path), join(values.output, 'three', path), { recursive: true });
