// Lets Babylon.js load a file as it does by itself: its MSFT_lod extension goes from the coarsest level to the finest.

// Its own decoder comes from the network; three.js ships the same decoder in its package.
const decoder = '/node_modules/three/examples/jsm/libs/draco/gltf/';
const decoderFiles = {
  wasmUrl: `${decoder}draco_wasm_wrapper.js`,
  wasmBinaryUrl: `${decoder}draco_decoder.wasm`,
  fallbackUrl: `${decoder}draco_decoder.js`,
};
BABYLON.DracoDecoder.DefaultConfiguration = decoderFiles;
BABYLON.DracoCompression.Configuration = { decoder: decoderFiles };

const engine = new BABYLON.Engine(document.getElementById('canvas'), false);

function countTriangles(scene) {
  const meshes = scene.meshes.filter((mesh) => mesh.isEnabled() && mesh.getTotalIndices() > 0);
  return meshes.reduce((sum, mesh) => sum + mesh.getTotalIndices() / 3, 0);
}

/** Loads a file, optionally by byte ranges; returns the triangles that the scene shows after each level, in that order. */
window.loadProgressively = async (url, useRangeRequests) => {
  const scene = new BABYLON.Scene(engine);
  const shown = [];
  let complete;
  BABYLON.SceneLoader.OnPluginActivatedObservable.addOnce((loader) => {
    loader.useRangeRequests = useRangeRequests;
    complete = new Promise((resolve) => loader.onCompleteObservable.addOnce(resolve));
    loader.onExtensionLoadedObservable.add((extension) => {
      if (extension.name === 'MSFT_lod') {
        extension.onNodeLODsLoadedObservable.add(() => shown.push(countTriangles(scene)));
      }
    });
  });
  await BABYLON.SceneLoader.AppendAsync('', url, scene);
  await complete;
  const last = countTriangles(scene);
  scene.dispose();
  return { shown, last };
};

window.ready = true;
