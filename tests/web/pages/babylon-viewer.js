// Shows a file in what <babylon-viewer> is made of. Its decoder comes from the network: only for files without Draco.
import { CreateViewerForCanvas } from '/node_modules/@babylonjs/viewer/dist/babylon-viewer.esm.min.js';

let details;
const canvas = document.getElementById('canvas');
const viewer = await CreateViewerForCanvas(canvas, {
  engine: 'WebGL', environmentLighting: undefined, onInitialized: (given) => { details = given; },
});
const { scene } = details;
let rest = details.suspendRendering(); // between files: it would go on drawing animations, in software

const patience = 20_000; // milliseconds

/** Levels go on coming after the viewer says that the model is loaded. */
async function waitUntil(isTrue) {
  for (const end = performance.now() + patience; !isTrue() && performance.now() < end;) {
    await new Promise((resolve) => setTimeout(resolve, 100));
  }
}

function shownMeshes() {
  return scene.meshes.filter((mesh) => mesh.isEnabled() && mesh.getTotalIndices() > 0);
}

const countTriangles = () => shownMeshes().reduce((sum, mesh) => sum + mesh.getTotalIndices() / 3, 0);

/** Loads a file; returns the triangles that are shown, and of each mesh's material the textures by whether they are there. */
window.showInViewer = async (url, triangles) => {
  rest.dispose();
  try {
    await viewer.loadModel(url);
    await waitUntil(() => countTriangles() === triangles);
    const textures = () => shownMeshes().flatMap(({ material }) => material?.getActiveTextures() ?? []);
    await waitUntil(() => textures().every((texture) => texture.isReady()));
    return { triangles: countTriangles(), textures: textures().map((texture) => texture.isReady()) };
  } finally {
    rest = details.suspendRendering();
  }
};

window.ready = true;
