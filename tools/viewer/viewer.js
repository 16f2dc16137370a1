// The page: models that stand in a row, how fine they are drawn, and what that costs.
import * as THREE from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { RoomEnvironment } from 'three/addons/environments/RoomEnvironment.js';
import { bytesText, drawCurve, shareText } from './curve.js';
import { Model, ViewerBudget } from './models.js';

const COLOURS = ['#2f7ed8', '#d8572f', '#2fa86b', '#a05bd0', '#c79a17', '#d0418a'];
const STILL = 1000; // milliseconds for which frames go on after the last change
const LONGEST = 8000; // and after the last wish, while there are more triangles than there may be
const element = (id) => document.getElementById(id);

/** What the slider sets: its numbers go from the coarsest to the finest. */
const MODES = {
  pixels: { from: 64, to: 0.25, label: (value) => `Error of at most ${Number(value.toPrecision(2))} ${value === 1 ? 'pixel' : 'pixels'}`, note: 'What is far away is coarser.' },
  error: { from: 0.05, to: 1e-6, label: (value) => `Error of at most ${shareText(value)} of a model’s size`, note: 'The same from wherever it is seen.' },
  faces: {
    from: 500, to: 4e6, label: (value) => `At most ${Number(value.toPrecision(2)).toLocaleString()} triangles`,
    note: 'One budget for all models: the next detail goes to the one whose error is largest in the picture.',
  },
};

const budget = new ViewerBudget();
const models = [];
const canvas = element('picture');
const renderer = new THREE.WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
renderer.toneMapping = THREE.NeutralToneMapping;
const scene = new THREE.Scene();
const camera = new THREE.PerspectiveCamera(35, 1, 0.01, 100);
const controls = new OrbitControls(camera, canvas);
const generator = new THREE.PMREMGenerator(renderer);
scene.environment = generator.fromScene(new RoomEnvironment(), 0.04).texture;
scene.environmentIntensity = 0.45;
generator.dispose();
const light = new THREE.DirectionalLight(0xffffff, 1.2);
light.position.set(1, 2, 3);
camera.add(light);
scene.add(camera);
camera.position.set(1.2, 0.9, 3.2);

let changedAt = performance.now();
let wishedAt = changedAt;
let isDirty = true;
let mode = 'pixels';
const amounts = { pixels: 1, error: 0.001, faces: 100_000 };

function change() {
  isDirty = true;
  changedAt = performance.now();
}

/** Whether all is as it is wanted, as far as has come. */
function isStill() {
  const now = performance.now();
  const isTooMuch = budget.drawn > budget.triangles && now - wishedAt < LONGEST;
  return !isDirty && now - changedAt > STILL && !isTooMuch;
}

controls.addEventListener('change', () => {
  change();
  wishedAt = changedAt;
});

// ---- models

function say(text) {
  element('message').textContent = text;
  element('message').hidden = text === '';
}

/** Opens a model; `resolve` finds the addresses of files beside it. */
async function open(url, name, resolve) {
  say('');
  const model = new Model(name);
  const used = models.map(({ colour }) => colour);
  model.colour = COLOURS.find((colour) => !used.includes(colour)) ?? COLOURS[models.length % COLOURS.length];
  models.push(model);
  list();
  try {
    await model.open(url, budget, change, resolve);
    if (!models.includes(model)) return void model.dispose(); // it was removed in between
    scene.add(model.holder);
    arrange();
    showAll();
    wishedAt = performance.now();
  } catch (error) {
    if (!models.includes(model)) return; // it was removed, which is why
    model.error = error;
    say(`${name}: ${error.message}`);
  }
  change();
}

function remove(model) {
  models.splice(models.indexOf(model), 1);
  model.dispose();
  arrange();
  list();
  change();
}

/** They stand in a row, each as large as the others. */
function arrange() {
  const shown = models.filter(({ holder }) => holder.parent);
  shown.forEach(({ holder }, i) => holder.position.set(2 * (i - (shown.length - 1) / 2), 0, 0));
}

/** From how far all of them are seen. */
function wholeDistance() {
  const count = Math.max(1, models.filter(({ holder }) => holder.parent).length);
  const slope = Math.tan((camera.fov * Math.PI) / 360);
  return Math.max(count / (slope * camera.aspect), 1 / slope) + 1;
}

function showAll() {
  const way = camera.position.clone().sub(controls.target).normalize();
  controls.target.set(0, 0, 0);
  camera.position.copy(way.multiplyScalar(wholeDistance()));
  controls.update();
  change();
}

/** Files that belong together: what a .gltf names is looked for among them. */
function openFiles(files) {
  const byName = new Map([...files].map((file) => [file.name, file]));
  const addresses = new Map();
  const addressOf = (name) => {
    if (!addresses.has(name)) addresses.set(name, URL.createObjectURL(byName.get(name)));
    return addresses.get(name);
  };
  const resolve = (url) => {
    const name = decodeURIComponent(url.replace(/^.*[/\\]/, ''));
    return byName.has(name) ? addressOf(name) : url;
  };
  const openable = [...byName.keys()].filter((name) => /\.(lods|glb|gltf)$/i.test(name) && !isBeside(name, byName));
  if (openable.length === 0) say('none of the files is a .lods, .glb or .gltf');
  for (const name of openable) open(addressOf(name), name, resolve);
}

/** Streams that a .gltf dropped with them names are its own. */
function isBeside(name, byName) {
  return /\.lods$/i.test(name) && [...byName.keys()].some((other) => /\.gltf$/i.test(other) && name.startsWith(other.replace(/\.gltf$/i, '')));
}

// ---- what is shown of them

function list() {
  const root = element('models');
  while (root.children.length > models.length) root.lastChild.remove();
  models.forEach((model, i) => {
    let item = root.children[i];
    if (item?.model !== model) {
      const made = document.createElement('li');
      made.innerHTML = '<span class="mark"></span><span class="name"></span><span class="state"></span><button type="button">✕</button>';
      made.model = model;
      made.querySelector('.mark').style.background = model.colour;
      made.querySelector('.name').textContent = made.querySelector('.name').title = model.name;
      made.querySelector('button').setAttribute('aria-label', `Remove ${model.name}`);
      made.querySelector('button').addEventListener('click', () => remove(model));
      if (item) item.replaceWith(made);
      else root.append(made);
      item = made;
    }
    const state = item.querySelector('.state');
    state.textContent = stateOf(model);
    state.classList.toggle('failed', Boolean(model.error));
  });
  element('hint').hidden = models.length > 0;
}

function stateOf(model) {
  if (model.error) return model.error.message;
  if (model.parts.length === 0) return model.holder.parent ? 'no stream in it: shown as it is' : 'opening …';
  const { total, bytes, faces, shown } = model;
  const all = total ? ` of ${total.faces.toLocaleString()}` : '';
  return `${faces.toLocaleString()}${all} triangles, ${bytesText(bytes)}${total ? ` of ${bytesText(total.bytes)}` : ''}, error ${shareText(shown)}`;
}

function report() {
  list();
  element('sum').textContent = models.length > 1 ? `${budget.drawn.toLocaleString()} triangles, ${bytesText(budget.fetched)} in all` : '';
  drawCurve(element('curve').querySelector('svg'), models);
  const worst = Math.max(0, ...models.map(({ worstHeat }) => worstHeat));
  element('legend').hidden = !element('heat').checked;
  element('legend-end').textContent = `${shareText(worst)} of the size`;
  for (const model of models) model.heatScale = worst;
}

// ---- the slider

const numberAt = ({ from, to }, share) => from * (to / from) ** share;
const shareOf = ({ from, to }, number) => Math.log(number / from) / Math.log(to / from);

function setMode(next, amount = amounts[next]) {
  mode = next;
  amounts[mode] = amount;
  document.querySelector(`input[name="by"][value="${mode}"]`).checked = true;
  element('amount').value = shareOf(MODES[mode], amount);
  apply();
}

function apply() {
  const amount = amounts[mode];
  element('amount-label').textContent = MODES[mode].label(amount);
  element('amount').setAttribute('aria-valuetext', MODES[mode].label(amount));
  element('amount-note').textContent = MODES[mode].note;
  budget.byShare = mode === 'error';
  budget.triangles = mode === 'faces' ? amount : Infinity;
  budget.pixelError = mode === 'faces' ? 0 : amount;
  wishedAt = performance.now();
  change();
}

element('amount').addEventListener('input', () => {
  amounts[mode] = numberAt(MODES[mode], Number(element('amount').value));
  apply();
});
for (const radio of document.querySelectorAll('input[name="by"]')) radio.addEventListener('change', () => setMode(radio.value));
for (const id of ['wireframe', 'heat']) element(id).addEventListener('change', change);
element('frame').addEventListener('click', showAll);

// ---- files

element('open').addEventListener('submit', (event) => {
  event.preventDefault();
  const address = element('url').value.trim();
  if (address !== '') openAddress(address);
});
element('files').addEventListener('change', () => {
  openFiles(element('files').files);
  element('files').value = '';
});

function openAddress(address) {
  try {
    const url = new URL(address, location.href);
    open(url.href, decodeURIComponent(url.pathname.replace(/^.*\//, '')) || url.href);
  } catch {
    say(`${address}: no address`);
  }
}

for (const name of ['dragover', 'dragleave', 'drop'])
  document.addEventListener(name, (event) => {
    event.preventDefault();
    document.querySelector('main').classList.toggle('dropping', name === 'dragover');
    if (name === 'drop') openFiles(event.dataTransfer.files);
  });

// ---- keys

/** Turns the camera around what it looks at, and goes nearer or farther. */
function turn(right, up, nearer = 1) {
  const offset = new THREE.Spherical().setFromVector3(camera.position.clone().sub(controls.target));
  offset.theta += right;
  offset.phi = Math.min(Math.PI - 0.05, Math.max(0.05, offset.phi + up));
  offset.radius *= nearer;
  camera.position.setFromSpherical(offset).add(controls.target);
  controls.update();
  change();
}

const TURNS = {
  ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1], '+': [0, 0, 0.9], '=': [0, 0, 0.9], '-': [0, 0, 1.1],
};
canvas.addEventListener('keydown', (event) => {
  if (!TURNS[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
  event.preventDefault();
  turn(...TURNS[event.key]);
});

function toggle(id) {
  element(id).checked = !element(id).checked;
  change();
}

function move(step) {
  const slider = element('amount');
  slider.value = Number(slider.value) + step;
  slider.dispatchEvent(new Event('input'));
}

const KEYS = {
  w: () => toggle('wireframe'), h: () => toggle('heat'), f: showAll, p: () => setMode('pixels'), e: () => setMode('error'), g: () => setMode('faces'),
  '[': () => move(0.02), ']': () => move(-0.02),
};
document.addEventListener('keydown', (event) => {
  const isText = event.target instanceof HTMLInputElement && event.target.type === 'url';
  if (isText || event.ctrlKey || event.metaKey || event.altKey) return;
  KEYS[event.key.toLowerCase()]?.();
});

// ---- frames

function fit() {
  const { clientWidth, clientHeight } = canvas.parentElement;
  renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
  renderer.setSize(clientWidth, clientHeight, false);
  camera.aspect = clientWidth / Math.max(clientHeight, 1);
  camera.updateProjectionMatrix();
  change();
}

function colour() {
  scene.background = new THREE.Color(getComputedStyle(document.documentElement).getPropertyValue('--ground').trim());
  change();
}

/** A frame is drawn where something has changed, and for a while after that: what is drawn settles. */
function frame() {
  requestAnimationFrame(frame);
  if (isStill()) return;
  isDirty = false;
  const shown = { wireframe: element('wireframe').checked, heat: element('heat').checked };
  for (const model of models) {
    model.show(shown);
    model.update(camera, renderer.domElement.height);
    model.record();
  }
  renderer.render(scene, camera);
  budget.update();
  report();
}

new ResizeObserver(() => {
  const before = wholeDistance();
  fit();
  camera.position.sub(controls.target).multiplyScalar(wholeDistance() / before).add(controls.target);
}).observe(canvas.parentElement);
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', colour);
colour();
const query = new URLSearchParams(location.search);
const given = Object.keys(MODES).find((name) => Number(query.get(name)) > 0);
setMode(given ?? 'pixels', given ? Number(query.get(given)) : 1);
fit();
showAll();
for (const url of query.getAll('url')) openAddress(url);
frame();

/** For scripts, and tests: what is shown. */
window.viewer = {
  open: openAddress,
  setMode,
  turn,
  get state() {
    return {
      drawn: budget.drawn,
      error: budget.error,
      isStill: isStill() && !budget.isWaiting,
      models: models.map((model) => ({
        name: model.name, faces: model.faces, bytes: model.bytes, total: model.total, shown: model.shown, arrived: model.arrived,
        points: model.history.length, isMeasured: model.isMeasured, worstHeat: model.worstHeat, message: model.error?.message,
      })),
    };
  },
};
window.ready = true;
