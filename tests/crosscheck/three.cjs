// Prints what three.js finds in a glTF file, as JSON. Usage: node three.cjs FILE [TIME...]
//
// Everything is asked of the loaded objects, nothing of the file. Node.js has neither files behind fetch nor
// pictures: the first is given to it here, and of a picture the size, from the header of the PNG.
const fs = require("fs/promises");
const path = require("path");
const { fileURLToPath, pathToFileURL } = require("url");

globalThis.self = globalThis;
globalThis.ProgressEvent = class extends Event {};
const fetchFromNetwork = globalThis.fetch;
globalThis.fetch = async (request, options) => {
  const url = request.url ?? String(request);
  return url.startsWith("file:")
    ? new Response(await fs.readFile(fileURLToPath(url)))
    : fetchFromNetwork(request, options);
};
globalThis.createImageBitmap = async (blob) => {
  const header = Buffer.from(await blob.arrayBuffer());
  if (header.toString("latin1", 1, 4) !== "PNG") throw new Error("not a PNG");
  return { width: header.readUInt32BE(16), height: header.readUInt32BE(20), close() {} };
};

// `import` does not look into NODE_PATH, `require` does not read such modules.
const found = (name) => import(pathToFileURL(require.resolve(name)));

async function main([file, ...times]) {
  const { GLTFLoader } = await found("three/examples/jsm/loaders/GLTFLoader.js");
  // The very module that the loader uses: require would give another copy of it.
  const THREE = await import(pathToFileURL(path.join(path.dirname(require.resolve("three")), "three.module.js")));
  const manager = new THREE.LoadingManager();
  const failed = [];
  manager.onError = (url) => failed.push(url);
  const gltf = await new GLTFLoader(manager).loadAsync(pathToFileURL(path.resolve(file)).href);
  if (failed.length > 0) throw new Error(`not loaded: ${failed}`);

  const meshes = [];
  gltf.scene.traverse((object) => object.isMesh && meshes.push(object));

  const interpolations = { [THREE.InterpolateDiscrete]: "STEP", [THREE.InterpolateLinear]: "LINEAR" };
  const texture = (map) =>
    map && { name: map.name, size: [map.image.width, map.image.height], sRGB: map.colorSpace === THREE.SRGBColorSpace };
  const material = (it) => ({
    name: it.name,
    color: it.color.toArray(),
    opacity: it.opacity,
    transparent: it.transparent,
    alphaTest: it.alphaTest,
    metalness: it.metalness,
    roughness: it.roughness,
    vertexColors: it.vertexColors,
    doubleSided: it.side === THREE.DoubleSide,
    map: texture(it.map),
    normalMap: texture(it.normalMap),
    emissive: it.emissive.toArray(),
    emissiveMap: texture(it.emissiveMap),
    metalnessMap: texture(it.metalnessMap),
    roughnessMap: texture(it.roughnessMap),
    aoMap: texture(it.aoMap),
  });
  const attribute = (it) =>
    Array.from({ length: it.count }, (_, index) =>
      Array.from({ length: it.itemSize }, (_, component) => it.getComponent(index, component)),
    );
  // In world coordinates, morph targets applied; three.js computes that in f64.
  const positions = (mesh) =>
    Array.from({ length: mesh.geometry.attributes.position.count }, (_, index) =>
      mesh.getVertexPosition(index, new THREE.Vector3()).applyMatrix4(mesh.matrixWorld).toArray(),
    );
  const pose = () => {
    gltf.scene.updateMatrixWorld(true);
    return Object.fromEntries(
      meshes.map((mesh) => [
        mesh.name,
        // Not getWorldScale, which takes 0 for 1.
        { scale: new THREE.Vector3().setFromMatrixScale(mesh.matrixWorld).toArray(), positions: positions(mesh) },
      ]),
    );
  };

  const answer = {
    scene: gltf.scene.userData,
    meshes: meshes.map((mesh) => ({
      name: mesh.name,
      extras: mesh.userData,
      indices: Array.from(mesh.geometry.index.array),
      attributes: Object.fromEntries(
        Object.entries(mesh.geometry.attributes).map(([name, values]) => [name, attribute(values)]),
      ),
      material: material(mesh.material),
      morphTargets: Object.keys(mesh.morphTargetDictionary ?? {}),
    })),
    animations: gltf.animations.map((clip) => ({
      name: clip.name,
      duration: clip.duration,
      tracks: clip.tracks.map((track) => ({
        name: track.name,
        interpolation: interpolations[track.getInterpolation()],
        times: Array.from(track.times),
        values: Array.from(track.values),
      })),
    })),
    pose: pose(),
    poses: [],
  };
  if (times.length > 0) {
    const mixer = new THREE.AnimationMixer(gltf.scene);
    const actions = gltf.animations.map((clip) => {
      const action = mixer.clipAction(clip).setLoop(THREE.LoopOnce);
      action.clampWhenFinished = true; // the last moment belongs to it
      return action.play();
    });
    for (const time of times.map(Number)) {
      actions.forEach((action) => action.reset()); // one that has ended stands still
      mixer.setTime(time);
      answer.poses.push({ time, meshes: pose() });
    }
  }
  console.log(JSON.stringify(answer));
}

main(process.argv.slice(2)).catch((error) => {
  console.error(error);
  process.exit(1);
});
