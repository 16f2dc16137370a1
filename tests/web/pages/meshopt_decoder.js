// meshopt's decoder as Babylon.js asks for it, in a script that sets a global. three.js ships the decoder as a module.
window.MeshoptDecoder = {};
window.MeshoptDecoder.ready = import('/node_modules/three/examples/jsm/libs/meshopt_decoder.module.js')
  .then(async ({ MeshoptDecoder: decoder }) => {
    await decoder.ready;
    Object.assign(window.MeshoptDecoder, decoder);
  });
