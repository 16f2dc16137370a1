// Draws a glTF that refines itself by lodestone's plugin for GLTFLoader, beside the one that it was made of.
import * as THREE from 'three';
import { DetailBudget } from 'lodestone/budget';
import { LodestonePlugin } from 'lodestone/gltf';
import { sumOfPositions, watchFrames } from './frames.js';
import { KeptPicture } from './kept_picture.js';
import { pace } from './pace.js';
import { makeLoader } from './scene.js';
import { settle } from './settle.js';

const SIZE = 512;
const renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
renderer.setSize(SIZE, SIZE);
document.body.append(renderer.domElement);
const context = renderer.getContext();

const scene = new THREE.Scene();
scene.background = new THREE.Color(0x7088a8);
const light = new THREE.DirectionalLight(0xffffff, 2.5);
light.position.set(1, 2, 3);
scene.add(light, new THREE.AmbientLight(0xffffff, 0.8));

const floor = new THREE.Mesh(new THREE.PlaneGeometry(1, 1).rotateX(-Math.PI / 2), new THREE.MeshStandardMaterial({ roughness: 1 }));
floor.receiveShadow = true;
light.shadow.mapSize.set(1024, 1024);

const morph = Number(new URLSearchParams(location.search).get('morph') ?? 0);

let gltf;
let mixer;
let sphere;
let camera;
let budget;
let updates = 0;

/** Loads a file; with the plugin where `refines`, and a budget where `triangles` says so. */
window.openFile = async (url, compression, refines, triangles) => {
  window.closeFile();
  const loader = makeLoader(compression);
  budget = triangles && new DetailBudget({ triangles, pixelError: 0 });
  if (refines) loader.register((parser) => new LodestonePlugin(parser, { budget, morph, onUpdate: () => ++updates }));
  gltf = await loader.loadAsync(url);
  scene.add(gltf.scene);
  mixer = new THREE.AnimationMixer(gltf.scene);
  if (gltf.animations.length > 0) mixer.clipAction(gltf.animations[0]).play();
  mixer.setTime(0);
  sphere ??= new THREE.Box3().setFromObject(gltf.scene).getBoundingSphere(new THREE.Sphere());
  camera = new THREE.PerspectiveCamera(35, 1, sphere.radius / 100, sphere.radius * 1000);
  window.moveTo(3.4);
  return gltf.userData.lodestone?.meshes.length ?? 0;
};

window.closeFile = () => {
  gltf?.userData.lodestone?.dispose();
  if (gltf) scene.remove(gltf.scene);
  gltf?.scene.traverse(({ geometry }) => geometry?.dispose());
  gltf = undefined;
};

/** Forgets where the last file lay. */
window.forget = () => {
  sphere = undefined;
};

window.moveTo = (radii) => {
  camera.position.copy(sphere.center).add(new THREE.Vector3(0.5, 0.4, 1).normalize().multiplyScalar(sphere.radius * radii));
  camera.lookAt(sphere.center);
  camera.updateMatrixWorld();
};

/** Puts a floor below, on which the object's shadow falls; or takes it away. */
window.castShadows = (casts) => {
  renderer.shadowMap.enabled = light.castShadow = casts;
  scene.remove(floor);
  if (!casts) return;
  const { center, radius } = sphere;
  light.position.copy(center).add(new THREE.Vector3(1, 2, 3).setLength(3 * radius));
  light.target.position.copy(center);
  light.target.updateMatrixWorld();
  Object.assign(light.shadow.camera, { left: -radius, right: radius, top: radius, bottom: -radius, near: radius, far: 8 * radius });
  light.shadow.camera.updateProjectionMatrix();
  floor.position.set(center.x, center.y - 0.6 * radius, center.z);
  floor.scale.setScalar(8 * radius);
  scene.add(floor);
  gltf.scene.traverse((object) => {
    object.castShadow = true;
  });
};

window.pose = (time) => mixer.setTime(time);

window.setPixelError = (pixels) => {
  gltf.userData.lodestone.pixelError = pixels;
};

window.drawFrame = () => {
  renderer.render(scene, camera);
  budget?.update();
  const meshes = gltf.userData.lodestone?.meshes ?? [];
  return {
    drawn: renderer.info.render.triangles,
    bytes: meshes.reduce((sum, mesh) => sum + mesh.bytes, 0),
    refined: meshes.filter((mesh) => mesh.level).length,
    worst: Math.max(0, ...meshes.map((mesh) => mesh.level?.deviation ?? 0)),
    updates,
  };
};

window.pace = (milliseconds, turned) => pace(context, milliseconds, turned);

window.settle = (patience) => settle(window.drawFrame, context, patience);

/** Waits for all of all streams: with a pixel error of 0 all is wanted. */
window.arrive = async () => {
  window.setPixelError(0);
  window.drawFrame();
  await Promise.all(gltf.userData.lodestone.meshes.map((mesh) => mesh.complete));
};

/** Waits for it and for what is drawn of it. */
window.finish = async () => {
  await window.arrive();
  return window.settle(100);
};

/** The picture, with where it is none of the background. */
function picture() {
  const rgba = new Uint8Array(4 * SIZE * SIZE);
  renderer.render(scene, camera);
  context.readPixels(0, 0, SIZE, SIZE, context.RGBA, context.UNSIGNED_BYTE, rgba);
  const covered = Uint8Array.from({ length: SIZE * SIZE }, (_, i) =>
    [0, 1, 2].some((channel) => rgba[4 * i + channel] !== rgba[channel]) ? 1 : 0);
  return { rgba, covered };
}

const kept = new KeptPicture(picture, SIZE, SIZE);
window.keepPicture = () => kept.keep();
window.likeKept = () => kept.likeness();
window.holes = () => kept.holes();

function positions() {
  const arrays = [];
  gltf.scene.traverse(({ geometry }) => geometry && arrays.push(geometry.attributes.position.array));
  return arrays;
}

/** Draws frames for so long; returns of each how many triangles it had, and a number that changes as vertices slide. */
window.frames = (milliseconds) =>
  watchFrames(() => ({ drawn: window.drawFrame().drawn, sum: sumOfPositions(positions()) }), context, milliseconds);

/** What the first mesh is hit at by a ray from the camera through the middle of the picture; null where it misses. */
window.hit = () => {
  const ray = new THREE.Raycaster();
  ray.setFromCamera(new THREE.Vector2(0, 0), camera);
  return ray.intersectObject(gltf.scene, true)[0]?.distance ?? null;
};

window.ready = true;
