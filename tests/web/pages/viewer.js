// Draws every level of a scene with three.js and counts the triangles that reach the renderer.
import * as THREE from 'three';
import { openScene } from './scene.js';

const renderer = new THREE.WebGLRenderer();
renderer.setSize(64, 64);
const camera = new THREE.PerspectiveCamera();

// One plain material for all: some are drawn in two passes, which would count twice, and textures take long.
const plain = new THREE.MeshBasicMaterial();

function drawnTriangles(root) {
  const scene = new THREE.Scene();
  scene.overrideMaterial = plain;
  scene.add(root);
  root.traverse((object) => { object.frustumCulled = false; });
  renderer.render(scene, camera);
  return renderer.info.render.triangles;
}

/** Returns the triangles drawn of each level, finest first. */
window.drawLevels = async (url, compression) => {
  const scene = await openScene(url, compression);
  const counts = [];
  for (let level = 0; level < scene.levelCount; ++level) {
    scene.show(level);
    counts.push(drawnTriangles(scene.root));
  }
  scene.dispose();
  return counts;
};

window.ready = true;
