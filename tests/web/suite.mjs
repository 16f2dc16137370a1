// What every program here does: its options, a site for the clients, and a log of checks.
import { existsSync } from 'node:fs';
import { mkdir } from 'node:fs/promises';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { serve } from './server.mjs';

const here = dirname(fileURLToPath(import.meta.url));
export const repository = join(here, '..', '..');

/** Reads the command line: the program, the folder of models, the folder for everything that is made, and files. */
export function readOptions() {
  const { values, positionals } = parseArgs({
    allowPositionals: true,
    options: {
      program: { type: 'string' },
      models: { type: 'string', default: join(repository, '..', 'shared', 'data') },
      output: { type: 'string', default: 'build/web' },
      package: { type: 'string', default: 'build/web-package/package' },
      sums: { type: 'string' },
      gltfpack: { type: 'string' }, // its cli.js, for what is measured beside it
    },
  });
  return { ...values, models: resolve(values.models), output: resolve(values.output), package: resolve(values.package), files: positionals };
}

/** Ends a run that cannot happen on this machine: a failure where the project's own tests run, a remark elsewhere. */
function stopWithout(what) {
  console.log(process.env.CI ? `FAILED: ${what}` : `SKIPPED: ${what}`);
  process.exit(process.env.CI ? 1 : 0);
}

/** Says what a run leaves out because a model is not on this machine. */
export function skip(what) {
  console.log(`SKIPPED ${what}: no such model on this machine`);
}

/** Starts the browser that all clients run in. */
export async function openBrowser() {
  if (!existsSync(join(here, 'node_modules', 'three'))) stopWithout('no web clients: run npm ci in tests/web');
  const { findBrowser, launchBrowser } = await import('./browser.mjs');
  const path = findBrowser();
  if (!path) stopWithout('no Chromium on this machine');
  return launchBrowser(path);
}

/** Serves the clients, the pages, `assets`, the models and `more` to a browser; `url` gives the address of a file of theirs. */
export async function openSite({ output, models, assets = output, more = {} }) {
  const browser = await openBrowser();
  await mkdir(output, { recursive: true });
  const mounts = {
    node_modules: join(here, 'node_modules'), pages: join(here, 'pages'), assets, models, demo: join(repository, 'demo'), ...more,
  };
  const server = await serve(mounts);
  return {
    address: server.address,
    ranges: server.ranges,
    browser,
    output,
    url: (path) => {
      const [mount, folder] = Object.entries(mounts).find(([, root]) => path.startsWith(`${root}/`));
      return `/${mount}${path.slice(folder.length)}`;
    },
    close: async () => {
      await browser.close();
      await server.close();
    },
  };
}

/** Fails where an answer takes longer. */
export function withinTime(answer, milliseconds) {
  let timer;
  const late = new Promise((_, reject) => {
    timer = setTimeout(() => reject(new Error(`no answer after ${milliseconds / 1000} s`)), milliseconds);
  });
  return Promise.race([answer, late]).finally(() => clearTimeout(timer));
}

/** Waits until something is so. */
export async function until(isSo, what) {
  for (const end = Date.now() + 20_000; !isSo(); await new Promise((resolve) => setTimeout(resolve, 20)))
    if (Date.now() > end) throw new Error(`not ${what}`);
}

/** A log that counts how checks end. */
export class Log {
  passed = 0;
  failed = 0;

  /** Runs checks by name, one after the other; each returns a line or throws the reason. */
  async run(subject, checks) {
    for (const [name, check] of Object.entries(checks)) {
      try {
        console.log(`ok     ${subject}: ${name}: ${await check()}`);
        ++this.passed;
      } catch (error) {
        console.log(`FAILED ${subject}: ${name}: ${error.message}`);
        ++this.failed;
      }
    }
  }

  /** Prints the sum and sets the exit status. */
  close() {
    console.log(`${this.passed} passed, ${this.failed} failed`);
    process.exitCode = this.failed === 0 ? 0 : 1;
  }
}
