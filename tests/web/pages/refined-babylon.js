// Draws a glTF that refines itself by lodestone's extension for Babylon.js's loader, beside the one that it was made of.
import { FreeCamera } from '@babylonjs/core/Cameras/freeCamera.js';
import { Engine } from '@babylonjs/core/Engines/engine.js';
import { ShadowGenerator } from '@babylonjs/core/Lights/Shadows/shadowGenerator.js';
import '@babylonjs/core/Lights/Shadows/shadowGeneratorSceneComponent.js';
import { DirectionalLight } from '@babylonjs/core/Lights/directionalLight.js';
import { HemisphericLight } from '@babylonjs/core/Lights/hemisphericLight.js';
import { ImportMeshAsync } from '@babylonjs/core/Loading/sceneLoader.js';
import { Color4 } from '@babylonjs/core/Maths/math.color.js';
import { Vector3 } from '@babylonjs/core/Maths/math.vector.js';
import { CreateGround } from '@babylonjs/core/Meshes/Builders/groundBuilder.js';
import { DracoDecoder } from '@babylonjs/core/Meshes/Compression/dracoDecoder.js';
import '@babylonjs/core/Materials/standardMaterial.js';
import { Scene } from '@babylonjs/core/scene.js';
import '@babylonjs/core/Culling/ray.js';
import '@babylonjs/core/Animations/animatable.js';
import '@babylonjs/loaders/glTF/2.0/index.js';
import { DetailBudget } from 'lodestone/budget';
import { refinementOf, registerLodestone } from 'lodestone/babylon';
import { sumOfPositions, watchFrames } from './frames.js';
import { KeptPicture } from './kept_picture.js';
import { settle } from './settle.js';

const SIZE = 512;

// Its own decoder comes from the network; three.js ships the same decoder in its package.
const decoder = '/node_modules/three/examples/jsm/libs/draco/gltf/';
DracoDecoder.DefaultConfiguration = {
  wasmUrl: `${decoder}draco_wasm_wrapper.js`,
  wasmBinaryUrl: `${decoder}draco_decoder.wasm`,
  fallbackUrl: `${decoder}draco_decoder.js`,
};

const engine = new Engine(document.getElementById('canvas'), true, { preserveDrawingBuffer: true });
const context = engine._gl;
const scene = new Scene(engine);
scene.clearColor = new Color4(0.44, 0.53, 0.66, 1);
const light = new DirectionalLight('sun', new Vector3(-1, -2, -3), scene);
light.intensity = 2.5;
new HemisphericLight('sky', new Vector3(0, 1, 0), scene).intensity = 0.8;
const camera = new FreeCamera('camera', Vector3.Zero(), scene);
camera.fov = (35 * Math.PI) / 180;

let loaded;
let refinement;
let sphere;
let budget;
let updates = 0;
let floor;
let generator;
const morph = Number(new URLSearchParams(location.search).get('morph') ?? 0);
registerLodestone({ morph, onUpdate: () => ++updates });

/** Loads a file; with the extension where `refines`, and a budget where `triangles` says so. */
window.openFile = async (url, compression, refines, triangles) => {
  window.closeFile();
  budget = triangles && new DetailBudget({ triangles, pixelError: 0 });
  const pluginOptions = { gltf: { extensionOptions: { LODESTONE_removal_stream: { enabled: refines, budget } } } };
  loaded = await ImportMeshAsync(url, scene, { pluginOptions });
  const root = loaded.meshes[0];
  refinement = refinementOf(root);
  for (const group of loaded.animationGroups) group.stop();
  loaded.animationGroups[0]?.start(true);
  loaded.animationGroups[0]?.pause();
  window.pose(0);
  for (const skeleton of loaded.skeletons) skeleton.prepare(true);
  for (const mesh of loaded.meshes) mesh.refreshBoundingInfo({ applySkeleton: true, applyMorph: true });
  if (!sphere) {
    const { min, max } = root.getHierarchyBoundingVectors();
    sphere = { center: Vector3.Center(min, max), radius: Vector3.Distance(min, max) / 2 };
  }
  [camera.minZ, camera.maxZ] = [sphere.radius / 100, sphere.radius * 1000];
  window.moveTo(3.4);
  await scene.whenReadyAsync();
  return refinement?.meshes.length ?? 0;
};

window.closeFile = () => {
  const closed = refinement;
  for (const group of loaded?.animationGroups ?? []) group.dispose();
  for (const skeleton of loaded?.skeletons ?? []) skeleton.dispose();
  loaded?.meshes[0].dispose(false, true);
  loaded = undefined;
  refinement = undefined;
  scene.render();
  if (closed && !closed.meshes.every(({ isClosed }) => isClosed)) throw new Error('it is disposed of, and its streams are read on');
};

/** Forgets where the last file lay. */
window.forget = () => {
  sphere = undefined;
};

window.moveTo = (radii) => {
  camera.position = sphere.center.add(new Vector3(0.5, 0.4, 1).normalize().scale(sphere.radius * radii));
  camera.setTarget(sphere.center);
};

/** Puts a floor below, on which the object's shadow falls; or takes it away. */
window.castShadows = async (casts) => {
  floor?.dispose(false, true);
  generator?.dispose();
  floor = generator = undefined;
  if (!casts) return;
  const { center, radius } = sphere;
  floor = CreateGround('floor', { width: 8 * radius, height: 8 * radius }, scene);
  floor.position.copyFrom(center).subtractInPlace(new Vector3(0, 0.6 * radius, 0));
  floor.receiveShadows = true;
  light.position = center.subtract(light.direction.normalizeToNew().scale(3 * radius));
  generator = new ShadowGenerator(1024, light);
  for (const mesh of loaded.meshes) if (mesh.subMeshes?.length > 0) generator.addShadowCaster(mesh, false);
  await generator.forceCompilationAsync();
  await scene.whenReadyAsync();
};

window.pose = (time) => loaded.animationGroups[0]?.goToFrame(time * 60);

window.setPixelError = (pixels) => {
  refinement.pixelError = pixels;
};

window.drawFrame = () => {
  scene.render();
  budget?.update();
  const meshes = refinement?.meshes ?? [];
  return {
    drawn: scene.getActiveIndices() / 3,
    bytes: meshes.reduce((sum, mesh) => sum + mesh.bytes, 0),
    refined: meshes.filter((mesh) => mesh.level).length,
    worst: Math.max(0, ...meshes.map((mesh) => mesh.level?.deviation ?? 0)),
    updates,
  };
};

/** The picture, with where it is none of the background. */
async function picture() {
  scene.render();
  const rgba = await engine.readPixels(0, 0, SIZE, SIZE);
  const covered = Uint8Array.from({ length: SIZE * SIZE }, (_, i) =>
    [0, 1, 2].some((channel) => rgba[4 * i + channel] !== rgba[channel]) ? 1 : 0);
  return { rgba: new Uint8Array(rgba.buffer.slice(0)), covered };
}

const kept = new KeptPicture(picture, SIZE, SIZE);
window.keepPicture = () => kept.keep();
window.likeKept = () => kept.likeness();
window.holes = () => kept.holes();

const positions = () => loaded.meshes.filter(({ geometry }) => geometry).map(({ geometry }) => geometry.getVerticesData('position'));

/** Draws frames for so long; returns of each how many triangles it had, and a number that changes as vertices slide. */
window.frames = (milliseconds) =>
  watchFrames(() => ({ drawn: window.drawFrame().drawn, sum: sumOfPositions(positions()) }), context, milliseconds);

/** What the first mesh is hit at by a ray from the camera through the middle of the picture; null where it misses. */
window.hit = () => {
  const found = scene.pick(SIZE / 2, SIZE / 2);
  return found?.hit ? found.distance : null;
};

window.finish = async () => {
  window.setPixelError(0);
  window.drawFrame();
  await Promise.all(refinement.meshes.map((mesh) => mesh.complete));
  return window.settle(100);
};

window.settle = (patience) => settle(window.drawFrame, context, patience);

window.ready = true;
