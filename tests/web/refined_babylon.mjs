// Files of `build --profile stream` in Babylon.js, by the package's extension for its loader.
//
//   node refined_babylon.mjs --program PROGRAM --package FOLDER [--models FOLDER] --output FOLDER
import { existsSync } from 'node:fs';
import { join } from 'node:path';
import { checkRefined } from './refined_checks.mjs';
import { repository } from './suite.mjs';

if (!existsSync(join(repository, 'tests', 'web', 'node_modules', '@babylonjs', 'core'))) {
  console.log('SKIPPED: no @babylonjs/core: run npm ci in tests/web');
  process.exit(process.env.CI ? 1 : 77);
}
await checkRefined('refined-babylon.html', 'refined-babylon');
