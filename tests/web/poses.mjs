// Poses a level and the whole mesh by the same animation: the level may lie not much farther off than at rest.
//
//   node poses.mjs --program PROGRAM [--models FOLDER] --output FOLDER     of the assets that assets.mjs has built there
import assert from 'node:assert/strict';
import { execFile } from 'node:child_process';
import { existsSync } from 'node:fs';
import { writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { promisify } from 'node:util';
import { planAssets } from './assets.mjs';
import { Log, openSite, readOptions, skip } from './suite.mjs';

// What moves in each, and so is worth posing; `targets` is how many morph targets to turn on, one at a time. The tube is
// straight at rest where it bends, and so its levels' ratios are large: they may lie `slack` farther off, which joints or
// targets at the wrong vertices exceed, and so does a pose of another time (`proves`).
const subjects = [
  { name: 'tube', animations: ['Bend', 'Swell'], targets: 1, slack: 0.02, proves: true },
  { name: 'RobotExpressive', animations: ['Running', 'Dance'], targets: 3 },
  { name: 'Knight', animations: ['Running_A', '1H_Melee_Attack_Chop'], targets: 0 },
  { name: 'MorphStressTest', animations: ['TheWave', 'Pulse'], targets: 4 },
  { name: 'AnimatedMorphCube', animations: ['Square'], targets: 2 },
];

const level = 2;
const timesOfEach = 5;
const largestRatio = 1.5;
const usualSlack = 0.0002; // of the diagonal, a fifth of a pixel where a model fills a screen: at rest some levels are exact

/** Returns mean and maximum distance between two meshes, each the larger of both directions, and the diagonal. */
async function measure(program, folder, whole, coarse) {
  const files = ['whole', 'coarse'].map((name) => join(folder, `posed-${name}.obj`));
  await Promise.all([writeFile(files[0], whole), writeFile(files[1], coarse)]);
  const { stdout } = await promisify(execFile)(program, ['compare', ...files, '--json']);
  const { diagonal, deviation: { forward, backward } } = JSON.parse(stdout);
  return { mean: Math.max(forward.mean, backward.mean), max: Math.max(forward.max, backward.max), diagonal };
}

const percent = (value) => `${(100 * value).toFixed(3)} %`;

/** Returns a line with the poses' ratios to the rest pose, and fails on one that is too large. */
function judge(rest, poses, slack) {
  const allowed = (kind) => largestRatio * rest[kind] + slack * rest.diagonal;
  const line = ['mean', 'max'].map((kind) => {
    const ratios = poses.map((pose) => (rest[kind] > 0 ? (pose[kind] / rest[kind]).toFixed(2) : '-'));
    const largest = Math.max(...poses.map((pose) => pose[kind]));
    const share = (distance) => percent(distance / rest.diagonal);
    return `${kind} ${share(rest[kind])} × ${ratios.join(' ')}, at most ${share(largest)}`;
  }).join('; ');
  for (const kind of ['mean', 'max']) assert.ok(poses.every((pose) => pose[kind] <= allowed(kind)), line);
  return line;
}

async function checkSubject(log, studio, { animations, targets, slack = usualSlack, proves }, asset) {
  const { page, program, output } = studio;
  const found = await page.ask((choice) => window.openAsset(...choice), [studio.url(asset.path), asset.compression]);
  const pose = (...choice) => page.ask((one) => window.poseLevel(...one), choice);
  const morph = (...choice) => page.ask((one) => window.morphLevel(...one), choice);
  const take = async (job, ...choice) => measure(program, output, await job(0, ...choice), await job(level, ...choice));
  const timesOf = (animation) => {
    const { duration } = found.find((one) => one.name === animation);
    return Array.from({ length: timesOfEach }, (_, i) => duration * (i + 0.5) / timesOfEach);
  };

  const rest = await take(pose);
  const checks = animations.map((animation) => [`posed by ${animation}`, async () => {
    const poses = [];
    for (const time of timesOf(animation)) poses.push(await take(pose, animation, time));
    return judge(rest, poses, slack);
  }]);
  if (targets > 0) {
    checks.push(['morph targets', async () => {
      const poses = [];
      for (let target = 0; target < targets; ++target) poses.push(await take(morph, target));
      return judge(rest, poses, slack);
    }]);
  }
  if (proves) {
    checks.push(['another pose is seen', async () => {
      const [one, , other] = timesOf(animations[0]);
      const posed = [await pose(0, animations[0], one), await pose(level, animations[0], other)];
      const apart = await measure(program, output, ...posed);
      assert.throws(() => judge(rest, [apart], slack), undefined, percent(apart.max / rest.diagonal));
      return percent(apart.max / rest.diagonal);
    }]);
  }
  await log.run(`${asset.name} level ${level}`, Object.fromEntries(checks));
}

async function main() {
  const options = readOptions();
  const site = await openSite(options);
  const { openPage } = await import('./browser.mjs');
  const page = await openPage(site.browser, `${site.address}/pages/three.html?poses.js`);
  const studio = { page, url: site.url, program: options.program, output: options.output };
  const log = new Log();
  const assets = planAssets(options);
  for (const subject of subjects) {
    const found = assets.filter(({ stem, compression, path }) =>
      stem === subject.name && compression !== 'draco' && existsSync(path));
    for (const asset of found) await checkSubject(log, studio, subject, asset);
    if (found.length === 0) skip(subject.name);
  }
  await site.close();
  log.close();
}

await main();
