// Counts the triangles that three.js draws of a file at a distance, where three-gltf-extensions' MSFT_lod chooses levels.
import * as THREE from 'three';
import GLTFLodExtension from '/node_modules/three-gltf-extensions/loaders/MSFT_lod/MSFT_lod.js';
import { makeLoader } from './scene.js';

const tangent = 2 * Math.tan(THREE.MathUtils.degToRad(30)); // the screen's height at distance 1, as Unity's camera has it

function countTriangles(root) {
  let count = 0;
  root.traverseVisible((object) => {
    if (object.isMesh) count += (object.geometry.index ?? object.geometry.attributes.position).count / 3;
  });
  return count;
}

/** Returns the triangles drawn from so many sizes away: the coverage's own meaning, and as the package reads it. */
window.countAtDistances = async (url, compression, distances) => {
  const open = async (options) => {
    const loader = makeLoader(compression);
    loader.register((parser) => new GLTFLodExtension(parser, options(parser)));
    const { scene } = await loader.loadAsync(url);
    scene.updateMatrixWorld(true);
    return scene;
  };
  const probe = await open(() => ({}));
  const box = new THREE.Box3();
  probe.traverse((object) => { if (object.isLOD) box.expandByObject(object.levels[0].object, true); });
  const size = Math.max(...box.getSize(new THREE.Vector3()).toArray());
  const centre = box.getCenter(new THREE.Vector3());
  const meant = (level, lowest, coverages) => (level === 0 ? 0 : size / (tangent * coverages[level - 1]));
  const count = (scene) => distances.map((distance) => {
    const camera = new THREE.PerspectiveCamera();
    camera.position.copy(centre).add(new THREE.Vector3(0, 0, distance * size));
    camera.updateMatrixWorld(true);
    scene.traverse((object) => { if (object.isLOD) object.update(camera); });
    return countTriangles(scene);
  });
  return { size, meant: count(await open(() => ({ calculateDistance: meant }))), read: count(probe) };
};

window.ready = true;
