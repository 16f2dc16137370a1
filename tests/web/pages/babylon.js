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
BABYLON.MeshoptCompression.Configuration = { decoder: { url: '/pages/meshopt_decoder.js' } };

const engine = new BABYLON.Engine(document.getElementById('canvas'), false);

function countTriangles(scene) {
  const meshes = scene.meshes.filter((mesh) => mesh.isEnabled() && mesh.getTotalIndices() > 0);
  return meshes.reduce((sum, mesh) => sum + mesh.getTotalIndices() / 3, 0);
}

/** Loads a file; `prepare` gets the loader before it begins, `job` the scene when all is there. */
async function withScene(url, prepare, job) {
  const scene = new BABYLON.Scene(engine);
  let complete;
  BABYLON.SceneLoader.OnPluginActivatedObservable.addOnce((loader) => {
    complete = new Promise((resolve) => loader.onCompleteObservable.addOnce(resolve));
    prepare(loader, scene);
  });
  try {
    await BABYLON.SceneLoader.AppendAsync('', url, scene);
    await complete;
    return job(scene);
  } finally {
    scene.dispose();
  }
}

/** Loads a file, optionally by byte ranges; returns the triangles that the scene shows after each level, in that order. */
window.loadProgressively = async (url, useRangeRequests) => {
  const shown = [];
  const prepare = (loader, scene) => {
    loader.useRangeRequests = useRangeRequests;
    loader.onExtensionLoadedObservable.add((extension) => {
      if (extension.name === 'MSFT_lod') {
        extension.onNodeLODsLoadedObservable.add(() => shown.push(countTriangles(scene)));
      }
    });
  };
  const last = await withScene(url, prepare, countTriangles);
  return { shown, last };
};

/** Loads a file once for each level and stops there; returns the triangles that it then shows, coarsest first. */
window.loadEachLevel = async (url, levels) => {
  const counts = [];
  for (let level = 1; level <= levels; ++level) {
    const prepare = (loader) => {
      loader.extensionOptions = { MSFT_lod: { maxLODsToLoad: level } };
      loader.skipMaterials = level < levels;
    };
    counts.push(await withScene(url, prepare, countTriangles));
  }
  return counts;
};

/** The ways in which programs take a file into a scene. */
const ways = {
  append: (url, scene) => BABYLON.SceneLoader.AppendAsync('', url, scene),
  container: async (url, scene) => (await BABYLON.SceneLoader.LoadAssetContainerAsync('', url, scene)).addAllToScene(),
};

/** Returns bytes as base64: a page's answer is taken apart number by number, which of a picture takes long. */
async function toText(bytes) {
  const reader = new FileReader();
  const done = new Promise((resolve) => { reader.onload = resolve; });
  reader.readAsDataURL(new Blob([bytes]));
  await done;
  return reader.result.split(',')[1];
}

function shownMeshes(scene) {
  return scene.meshes.filter((mesh) => mesh.isEnabled() && mesh.getTotalIndices() > 0);
}

/** Loads a file and draws it; returns its triangles, its materials' textures by whether they are there, and a picture. */
window.drawLoaded = async (url, way) => {
  const scene = new BABYLON.Scene(engine);
  let complete;
  BABYLON.SceneLoader.OnPluginActivatedObservable.addOnce((loader) => {
    complete = new Promise((resolve) => loader.onCompleteObservable.addOnce(resolve));
  });
  try {
    await ways[way](url, scene);
    await complete;
    scene.createDefaultCameraOrLight(true);
    await scene.whenReadyAsync();
    scene.render();
    const textures = shownMeshes(scene).flatMap(({ material }) => material?.getActiveTextures() ?? []);
    return {
      triangles: countTriangles(scene),
      bare: shownMeshes(scene).filter(({ material }) => !material).length,
      textures: textures.map((texture) => texture.isReady()),
      pixels: await toText(await engine.readPixels(0, 0, engine.getRenderWidth(), engine.getRenderHeight())),
    };
  } finally {
    scene.dispose();
  }
};

window.ready = true;
