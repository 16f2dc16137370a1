// Files of `build --profile stream` in three.js, by the package's plugin for GLTFLoader.
//
//   node refined.mjs --program PROGRAM --package FOLDER [--models FOLDER] --output FOLDER
import { checkRefined } from './refined_checks.mjs';

await checkRefined('refined.html', 'refined');
