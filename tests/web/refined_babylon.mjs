// Files of `build --profile stream` in Babylon.js, by the package's extension for its loader.
//
//   node refined_babylon.mjs --program PROGRAM --package FOLDER [--models FOLDER] --output FOLDER
import { checkRefined } from './refined_checks.mjs';

await checkRefined('refined-babylon.html', 'refined-babylon');
