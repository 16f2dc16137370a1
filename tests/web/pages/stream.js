// Draws a stream while it arrives, by lodestone's object for three.js.
import * as THREE from 'three';
import { LodestoneMesh } from 'lodestone/three';
import { sumOfPositions, watchFrames } from './frames.js';
import { settle } from './settle.js';

const SIZE = 640;
const renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
renderer.setSize(SIZE, SIZE);
document.body.append(renderer.domElement);
const context = renderer.getContext();

const scene = new THREE.Scene();
scene.background = new THREE.Color(0x202830);
const light = new THREE.DirectionalLight(0xffffff, 2);
light.position.set(1, 2, 3);
scene.add(light, new THREE.AmbientLight(0xffffff, 0.5));

let mesh;
let camera;
let worst = 0; // of the times between tasks on this thread, but for those that draw, milliseconds
let drew = false;
const channel = new MessageChannel();
let last = performance.now();
channel.port1.onmessage = () => {
  const now = performance.now();
  if (!drew) worst = Math.max(worst, now - last);
  drew = false;
  last = now;
  channel.port2.postMessage(0);
};

/** Opens a stream; returns how long its first level took, in milliseconds. */
window.openStream = async (url, options) => {
  const start = performance.now();
  mesh?.dispose();
  scene.remove(mesh);
  mesh = await LodestoneMesh.load(url, options);
  scene.add(mesh);
  const { center, radius } = mesh.children[0].geometry.boundingSphere;
  camera = new THREE.PerspectiveCamera(35, 1, radius / 100, radius * 1000);
  window.moveTo(3.2);
  return performance.now() - start;
};

/** Stands so many radii away from the object's middle. */
window.moveTo = (radii) => {
  const { center, radius } = mesh.children[0].geometry.boundingSphere;
  window.middle ??= center.clone();
  window.size ??= radius;
  camera.position.copy(window.middle).add(new THREE.Vector3(0.4, 0.3, 1).normalize().multiplyScalar(window.size * radii));
  camera.lookAt(window.middle);
  camera.updateMatrixWorld();
};

window.setPixelError = (pixels) => {
  mesh.pixelError = pixels;
};

/** Draws a frame; returns what it had. */
window.drawFrame = () => {
  drew = true;
  mesh.update(camera, SIZE);
  renderer.render(scene, camera);
  return { ...mesh.level, drawn: renderer.info.render.triangles, bytes: mesh.stream.bytes, complete: mesh.stream.complete };
};

/** Draws frames until nothing has changed for a while, and where `whole` is said until all has arrived. */
window.settle = (whole = false) => {
  const isSame = (a, b) => a.position === b.position && a.bytes === b.bytes && (a.complete || !whole);
  return settle(window.drawFrame, context, 400, isSame);
};

/** Draws frames for so long; returns of each the level, how many faces were drawn, and a number that changes as vertices slide. */
window.frames = (milliseconds) =>
  watchFrames(() => {
    const { position, faceCount, drawn } = window.drawFrame();
    return { position, faceCount, drawn, sum: sumOfPositions([mesh.children[0].geometry.attributes.position.array]) };
  }, context, milliseconds);

window.watchTasks = () => {
  worst = 0;
  last = performance.now();
  channel.port2.postMessage(0);
};
window.longestTask = () => worst;

/** Compares the buffers drawn from with those of a runtime that has read all at once. */
window.sumOfLevel = () => {
  let sum = 2166136261;
  const add = (array, count) => {
    const bytes = new Uint8Array(array.buffer, array.byteOffset, count * array.BYTES_PER_ELEMENT);
    for (const byte of bytes) sum = Math.imul(sum ^ byte, 16777619);
  };
  for (const { geometry } of mesh.children) add(geometry.index.array, geometry.drawRange.count);
  const { geometry } = mesh.children[0];
  add(geometry.attributes.position.array, 3 * mesh.level.wedgeCount);
  for (const { name } of mesh.stream.attributes) {
    const attribute = geometry.attributes[{ NORMAL: 'normal', TEXCOORD_0: 'uv' }[name]];
    add(attribute.array, attribute.itemSize * mesh.level.wedgeCount);
  }
  add(new Float32Array([mesh.level.deviation]), 1);
  return sum >>> 0;
};

window.ready = true;
