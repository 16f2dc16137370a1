// Loads each level of a file with three.js. Its GLTFLoader knows nothing of MSFT_lod: the page asks for the nodes.
import * as THREE from 'three';
import { makeLoader } from './scene.js';

const renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
renderer.setSize(640, 640);
document.body.append(renderer.domElement);

function countTriangles(object) {
  let count = 0;
  object.traverse((child) => {
    if (!child.isMesh) return;
    const { index, attributes } = child.geometry;
    count += (index ?? attributes.position).count / 3;
  });
  return count;
}

let levels = [];

/** Loads the nodes of a file; returns the triangles of the default scene and of each node. */
window.loadLevels = async (url, nodes, compression) => {
  const gltf = await makeLoader(compression).loadAsync(url);
  levels = await Promise.all(nodes.map((node) => gltf.parser.getDependency('node', node)));
  return { scene: countTriangles(gltf.scene), levels: levels.map(countTriangles) };
};

function frame(object) {
  const sphere = new THREE.Box3().setFromObject(object).getBoundingSphere(new THREE.Sphere());
  const camera = new THREE.PerspectiveCamera(35, 1, sphere.radius / 100, sphere.radius * 100);
  camera.position.copy(sphere.center).add(new THREE.Vector3(0.5, 0.4, 1).normalize().multiplyScalar(sphere.radius * 3.4));
  camera.lookAt(sphere.center);
  return camera;
}

/** Draws one loaded level, flat-shaded so that its triangles can be seen; the finest level sets the camera. */
window.drawLevel = (number) => {
  const object = levels[number].clone();
  object.traverse((child) => {
    if (child.isMesh) child.material = new THREE.MeshStandardMaterial({ flatShading: true, side: THREE.DoubleSide });
  });
  const scene = new THREE.Scene();
  scene.background = new THREE.Color(0x202830);
  const light = new THREE.DirectionalLight(0xffffff, 1.6);
  light.position.set(1, 2, 3);
  scene.add(object, light, new THREE.AmbientLight(0xffffff, 0.4));
  renderer.render(scene, frame(levels[0]));
};

window.ready = true;
