// Headless Chromium from the system, drawing in software, with no connection to the outside.
import { accessSync, constants } from 'node:fs';
import { delimiter, join } from 'node:path';
import { chromium } from 'playwright-core';
import { withinTime } from './suite.mjs';

const NAMES = ['chromium', 'chromium-browser', 'google-chrome'];

const ARGUMENTS = [
  '--use-gl=angle',
  '--use-angle=swiftshader',
  '--enable-unsafe-swiftshader',
  '--disable-background-networking',
  '--disable-component-update',
  '--disable-sync',
  '--no-first-run',
];

const patience = 360_000; // milliseconds; a busy machine draws slowly in software, but a viewer may wait for what never comes

function isExecutable(path) {
  try {
    accessSync(path, constants.X_OK);
    return true;
  } catch {
    return false;
  }
}

/** Returns the path of the machine's Chromium, or undefined. */
export function findBrowser() {
  const folders = (process.env.PATH ?? '').split(delimiter);
  return NAMES.flatMap((name) => folders.map((folder) => join(folder, name))).find(isExecutable);
}

export async function launchBrowser(executablePath) {
  // Chromium's sandbox refuses to run as root; the pages are ours.
  const asRoot = process.getuid?.() === 0;
  return chromium.launch({ executablePath, args: [...ARGUMENTS, ...(asRoot ? ['--no-sandbox'] : [])] });
}

/** Opens a page. Its `ask` evaluates in it and fails on any error that the page has reported since the last time. */
export async function openPage(browser, url) {
  const page = await browser.newPage({ viewport: { width: 640, height: 640 } });
  page.setDefaultTimeout(patience);
  const problems = [];
  page.on('pageerror', (error) => problems.push(error.message));
  page.on('console', (message) => message.type() === 'error' && problems.push(message.text()));
  const failOnProblems = () => {
    const all = problems.splice(0).join('; ');
    if (all !== '') throw new Error(`the page reports: ${all}`);
  };
  await page.goto(url);
  await page.waitForFunction('window.ready');
  return {
    page,
    failOnProblems,
    ask: async (job, argument) => {
      const answer = await withinTime(page.evaluate(job, argument), patience).catch((error) => {
        problems.push(error.message.split('\n')[0]);
      });
      failOnProblems();
      return answer;
    },
  };
}

/** Opens a page, hands it to `job`, and fails on any error the page reports. */
export async function withPage(browser, url, job) {
  const { page, failOnProblems } = await openPage(browser, url);
  try {
    const result = await job(page);
    failOnProblems();
    return result;
  } finally {
    await page.close();
  }
}
