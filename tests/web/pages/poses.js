// Poses levels of a scene by its animations and writes down where their triangles then are.
import * as THREE from 'three';
import { openScene } from './scene.js';

let scene;

/** Opens a file; returns its animations: name and seconds. */
window.openAsset = async (url, compression) => {
  scene?.dispose();
  scene = await openScene(url, compression);
  return scene.animations.map(({ name, duration }) => ({ name, duration }));
};

/** Appends a mesh as it stands in the world, as three.js computes it on the processor. */
function appendMesh(lines, mesh, firstVertex) {
  const { index, attributes } = mesh.geometry;
  const at = new THREE.Vector3();
  for (let i = 0; i < attributes.position.count; ++i) {
    mesh.getVertexPosition(i, at).applyMatrix4(mesh.matrixWorld);
    lines.push(`v ${at.x} ${at.y} ${at.z}`);
  }
  const corners = index ? Array.from(index.array) : Array.from({ length: attributes.position.count }, (_, i) => i);
  for (let i = 0; i < corners.length; i += 3) {
    lines.push(`f ${corners.slice(i, i + 3).map((corner) => corner + firstVertex).join(' ')}`);
  }
  return firstVertex + attributes.position.count;
}

function toObj() {
  scene.root.updateMatrixWorld(true);
  const lines = [];
  let firstVertex = 1; // as OBJ counts
  for (const mesh of scene.meshes()) {
    mesh.skeleton?.update();
    firstVertex = appendMesh(lines, mesh, firstVertex);
  }
  return `${lines.join('\n')}\n`;
}

/** Returns a level as OBJ, at rest or at a time of an animation. */
window.poseLevel = (level, animation, time) => {
  scene.show(level);
  if (animation === undefined) return toObj();
  const mixer = new THREE.AnimationMixer(scene.root); // a new one: it looks for its nodes in what is shown now
  mixer.clipAction(scene.animations.find(({ name }) => name === animation)).play();
  mixer.setTime(time);
  const text = toObj();
  mixer.stopAllAction();
  mixer.uncacheRoot(scene.root);
  return text;
};

/** Returns a level as OBJ with one morph target of every mesh that has it fully on. */
window.morphLevel = (level, target) => {
  scene.show(level);
  const kept = scene.meshes().filter(({ morphTargetInfluences: weights }) => weights && target < weights.length)
    .map(({ morphTargetInfluences: weights }) => ({ weights, before: [...weights] }));
  kept.forEach(({ weights }) => weights.fill(0).fill(1, target, target + 1));
  const text = toObj();
  kept.forEach(({ weights, before }) => before.forEach((value, i) => { weights[i] = value; }));
  return text;
};

window.ready = true;
