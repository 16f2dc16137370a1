// Draws the levels of an asset beside its input: same camera, same light, at the distance where a level is used.
import * as THREE from 'three';
import { RoomEnvironment } from 'three/addons/environments/RoomEnvironment.js';
import { OBJLoader } from 'three/addons/loaders/OBJLoader.js';
import { LevelScene, openScene } from './scene.js';
import { similarity } from './ssim.js';

const size = 512;
const fieldOfView = 35; // degrees
const background = [0.5, 0.58, 0.7]; // in the picture's own values

const renderer = new THREE.WebGLRenderer({ antialias: true, alpha: true, preserveDrawingBuffer: true });
renderer.setSize(size, size);
renderer.setClearColor(0x000000, 0);
renderer.toneMapping = THREE.NeutralToneMapping;
document.body.append(renderer.domElement);

const environment = new THREE.PMREMGenerator(renderer).fromScene(new RoomEnvironment(), 0.04).texture;

/** The size of a pixel at distance 1. */
const pixelAngle = 2 * Math.tan(THREE.MathUtils.degToRad(fieldOfView / 2)) / size;

/** Gives all corners at one position one normal: a file without normals says nothing of its creases or seams. */
function smoothNormals(geometry) {
  const { position } = geometry.attributes;
  geometry.computeVertexNormals();
  const { normal } = geometry.attributes;
  const sums = new Map();
  const key = (i) => `${position.getX(i)} ${position.getY(i)} ${position.getZ(i)}`;
  const at = new THREE.Vector3();
  for (let i = 0; i < position.count; ++i) {
    if (!sums.has(key(i))) sums.set(key(i), new THREE.Vector3());
    sums.get(key(i)).add(at.fromBufferAttribute(normal, i));
  }
  for (let i = 0; i < position.count; ++i) normal.setXYZ(i, ...at.copy(sums.get(key(i))).normalize().toArray());
}

/** Bare geometry gets normals and, where a picture for it is at hand, that picture. */
async function dress(scene, textureUrl) {
  const map = textureUrl ? await new THREE.TextureLoader().loadAsync(textureUrl) : null;
  if (map) map.colorSpace = THREE.SRGBColorSpace;
  const material = new THREE.MeshStandardMaterial({ map, roughness: 0.7, color: map ? 0xffffff : 0xc8b090 });
  for (let level = 0; level < scene.levelCount; ++level) {
    scene.show(level);
    for (const mesh of scene.meshes()) {
      // A .glb's texture coordinates grow downwards, and three.js reads a picture for them the other way round.
      if (map && scene.fromGltf && !mesh.geometry.userData.turned) {
        const { uv } = mesh.geometry.attributes;
        for (let i = 0; i < uv.count; ++i) uv.setY(i, 1 - uv.getY(i));
        mesh.geometry.userData.turned = true;
      }
      smoothNormals(mesh.geometry);
      mesh.material = material;
    }
  }
}

async function open({ url, compression, bare, texture }) {
  const isObj = url.endsWith('.obj');
  const scene = isObj ? new LevelScene({ scene: await new OBJLoader().loadAsync(url), animations: [] }, [])
    : await openScene(url, compression);
  scene.fromGltf = !isObj;
  if (bare) await dress(scene, texture);
  scene.show(0);
  return scene;
}

let original;
let asset;
let sphere;

/** Opens an input; returns the length of a pixel where it fills the picture, and its longest side. */
window.openOriginal = async (file) => {
  original?.dispose();
  original = await open(file);
  drawnOriginals = new Map();
  const box = new THREE.Box3().setFromObject(original.root);
  sphere = box.getBoundingSphere(new THREE.Sphere());
  return { pixel: nearest() * pixelAngle, size: Math.max(...box.getSize(new THREE.Vector3()).toArray()) };
};

/** Opens what was made of it. */
window.openAsset = async (file) => {
  asset?.dispose();
  asset = await open(file);
};

function nearest() {
  return sphere.radius * 3.5;
}

function cameraAt(distance) {
  const camera = new THREE.PerspectiveCamera(fieldOfView, 1, distance - 2 * sphere.radius, distance + 2 * sphere.radius);
  camera.position.copy(sphere.center).addScaledVector(new THREE.Vector3(0.5, 0.4, 1).normalize(), distance);
  camera.lookAt(sphere.center);
  return camera;
}

function readPixels() {
  const gl = renderer.getContext();
  const rgba = new Uint8Array(4 * size * size);
  gl.readPixels(0, 0, size, size, gl.RGBA, gl.UNSIGNED_BYTE, rgba);
  return rgba;
}

/** Draws a scene before a background, which a gap would show; `covered` is 1 where the scene is. */
function draw(levelScene, distance) {
  const scene = new THREE.Scene();
  scene.environment = environment;
  scene.add(levelScene.root);
  renderer.render(scene, cameraAt(distance));
  const rgba = readPixels(); // premultiplied
  const covered = new Uint8Array(size * size);
  for (let i = 0; i < covered.length; ++i) {
    const behind = 255 - rgba[4 * i + 3];
    if (behind < 255) covered[i] = 1;
    for (let channel = 0; channel < 3; ++channel) rgba[4 * i + channel] += Math.round(behind * background[channel]);
    rgba[4 * i + 3] = 255;
  }
  return { rgba, covered };
}

let drawnOriginals = new Map();

/** The input looks the same at a distance whatever it is compared with. */
function drawOriginal(distance) {
  if (!drawnOriginals.has(distance)) drawnOriginals.set(distance, draw(original, distance));
  return drawnOriginals.get(distance);
}

/** The part of a picture around its middle that shows the object, as large as the picture itself. */
function magnified({ rgba }, distance) {
  const picture = new OffscreenCanvas(size, size);
  const image = picture.getContext('2d').createImageData(size, size);
  for (let row = 0; row < size; ++row) {
    image.data.set(rgba.subarray(4 * size * row, 4 * size * (row + 1)), 4 * size * (size - 1 - row));
  }
  picture.getContext('2d').putImageData(image, 0, 0);
  const part = Math.min(size, Math.ceil(size * nearest() / distance));
  const large = new OffscreenCanvas(size, size);
  const context = large.getContext('2d');
  context.imageSmoothingEnabled = false;
  context.drawImage(picture, (size - part) / 2, (size - part) / 2, part, part, 0, 0, size, size);
  return large;
}

let sheet = [];

/** Compares a level where a pixel has the given length, and no nearer than the picture holds it; returns the similarity. */
window.compareLevel = (level, pixel, label) => {
  asset.show(level);
  const distance = Math.max(nearest(), pixel / pixelAngle);
  const pair = [drawOriginal(distance), draw(asset, distance)];
  const value = similarity(...pair, size, size);
  const width = 2 * sphere.radius / distance / pixelAngle;
  if (label) {
    const near = [drawOriginal(nearest()), distance === nearest() ? pair[1] : draw(asset, nearest())];
    sheet.push({
      label: `${label}, ${width.toFixed(0)} pixels, similarity ${value.toFixed(4)}`,
      pictures: [...near.map((one) => magnified(one, nearest())), ...pair.map((one) => magnified(one, distance))],
    });
  }
  return { value, width };
};

/** Returns the rows since the last sheet as one picture: input and level from near, then both where the level is used. */
window.takeSheet = () => {
  const titleHeight = 24;
  const canvas = document.createElement('canvas');
  canvas.width = 4 * size;
  canvas.height = sheet.length * (size + titleHeight);
  const context = canvas.getContext('2d');
  context.font = '18px sans-serif';
  context.fillStyle = 'white';
  context.fillRect(0, 0, canvas.width, canvas.height);
  context.fillStyle = 'black';
  sheet.forEach(({ label, pictures }, row) => {
    const top = row * (size + titleHeight);
    context.fillText(`${label}: input and level from near; input and level where it is used`, 8, top + 18);
    pictures.forEach((picture, column) => context.drawImage(picture, column * size, top + titleHeight));
  });
  sheet = [];
  return canvas.toDataURL('image/png').split(',')[1];
};

window.ready = true;
