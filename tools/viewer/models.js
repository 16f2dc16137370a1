// Models that are shown, whatever file they are of: each stands in a place of its own, as large as the others, and has streams
// that share the budget.
import { Box3, Group, LoadingManager, MeshStandardMaterial, Sphere, Vector3 } from 'three';
import { DRACOLoader } from 'three/addons/loaders/DRACOLoader.js';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { DetailBudget } from 'lodestone/budget';
import { LodestonePlugin } from 'lodestone/gltf';
import { LodestoneMesh } from 'lodestone/three';
import { HeatMap, makeHeatMaterial } from './heat.js';

/** A budget that can also be one of error, as a share of each model's size, from wherever it is seen. */
export class ViewerBudget extends DetailBudget {
  byShare = false;
  sizes = new Map(); // of models, in their streams' units

  see(member, pixels, places) {
    super.see(member, this.byShare ? 1 / this.sizes.get(member) : pixels, places);
  }

  remove(member) {
    super.remove(member);
    this.sizes.delete(member);
  }
}

/** A stream of a model: what it is drawn by, and how large the model is in its units. */
class Part {
  constructor(member, geometries, size) {
    this.member = member; // of the budget
    this.geometries = geometries;
    this.size = size;
  }

  get level() {
    return this.member.level;
  }

  /** The shares of the model's size that what has arrived, and what is shown, deviate by. */
  get arrived() {
    const { chunks, chunksReady = 0 } = this.member;
    const own = this.member.shown?.deviation ?? Infinity; // a stream begins coarser than what its file shows
    return Math.min(own, ...(chunks ?? []).slice(0, chunksReady).map(({ deviation }) => deviation)) / this.size;
  }

  get shown() {
    return (this.level?.deviation ?? this.member.shown?.deviation ?? 0) / this.size;
  }

  get bytes() {
    return this.member.bytes ?? 0;
  }

  get faces() {
    return this.level?.faceCount ?? this.member.shown?.faceCount ?? 0;
  }

  get total() {
    const { chunks } = this.member;
    return chunks && { bytes: chunks.at(-1).byteEnd, faces: chunks.at(-1).faceCount };
  }
}

/** A model: a file's scene, or a stream's object. */
export class Model {
  parts = [];
  holder = new Group();
  #history = []; // { bytes, error } of what has arrived
  error = undefined; // what it failed with
  #wire = false;
  #heat = false;
  #plain = new Map(); // materials by object
  #heatMaterial;
  #heats = [];
  #close = () => {};
  #abort = new AbortController(); // when it is disposed of

  constructor(name) {
    this.name = name;
  }

  /** Loads it; `changed` is called when there is something new to draw. */
  async open(url, budget, changed, resolve) {
    this.changed = changed;
    const isStream = /\.lods$/i.test(this.name);
    const object = await (isStream ? this.#openStream(url, budget) : this.#openFile(url, budget, resolve));
    const sphere = new Box3().setFromObject(object).getBoundingSphere(new Sphere());
    this.scale = 1 / (sphere.radius || 1);
    object.position.sub(sphere.center);
    this.holder.add(object);
    this.holder.scale.setScalar(this.scale);
    this.#heats = this.parts.map(({ geometries, member }) => new HeatMap(geometries, () => member.level, changed));
    changed();
  }

  async #openStream(url, budget) {
    const material = new MeshStandardMaterial({ color: 0xb9c2cc, roughness: 0.7, metalness: 0 });
    const mesh = await LodestoneMesh.load(url, { budget, material, signal: this.#abort.signal, onUpdate: () => this.changed() });
    material.flatShading = !mesh.stream.attributes.some(({ name }) => name === 'NORMAL');
    mesh.complete.catch((error) => this.#fail(error));
    const size = new Vector3(...mesh.stream.high).distanceTo(new Vector3(...mesh.stream.low)) || 1;
    this.#addPart(budget, mesh.stream, mesh.children.map(({ geometry }) => geometry), size);
    this.update = (camera, height) => mesh.update(camera, height);
    this.#close = () => {
      mesh.dispose();
      material.dispose();
    };
    return mesh;
  }

  async #openFile(url, budget, resolve) {
    const manager = new LoadingManager();
    if (resolve) manager.setURLModifier(resolve);
    const loader = new GLTFLoader(manager);
    const draco = new DRACOLoader().setDecoderPath(new URL('./three/examples/jsm/libs/draco/gltf/', import.meta.url).href);
    loader.setDRACOLoader(draco).register((parser) => new LodestonePlugin(parser, { budget, onUpdate: () => this.changed() }));
    const gltf = await loader.loadAsync(url).finally(() => draco.dispose());
    const refinement = gltf.userData.lodestone;
    const whole = new Box3().setFromObject(gltf.scene).getSize(new Vector3()).length() || 1;
    for (const mesh of refinement.meshes) {
      mesh.complete.catch((error) => this.#fail(error));
      this.#addPart(budget, mesh, mesh.geometries, whole / stretchIn(gltf.scene, mesh.geometries));
    }
    this.#close = () => {
      refinement.dispose();
      gltf.scene.traverse(disposeOf);
    };
    return gltf.scene;
  }

  #addPart(budget, member, geometries, size) {
    budget.sizes.set(member, size);
    this.parts.push(new Part(member, geometries, size));
  }

  #fail(error) {
    this.error = error;
    this.changed();
  }

  update() {}

  /** Says what has come to be known since the last frame. */
  record() {
    const { bytes, arrived } = this;
    const last = this.#history.at(-1);
    if (this.parts.length > 0 && (!last || bytes > last.bytes || arrived < last.error)) this.#history.push({ bytes, error: arrived });
    if (this.#heat) for (const heat of this.#heats) heat.update();
  }

  /** What has come, as { bytes, error }: of one stream at each of its chunks, of several where they stood together. */
  get history() {
    return this.#chunks?.slice(0, this.parts[0].member.chunksReady) ?? this.#history;
  }

  /** What is to come, as far as that is known. */
  get coming() {
    return this.#chunks?.slice(this.parts[0].member.chunksReady) ?? [];
  }

  get #chunks() {
    const [{ member, size } = {}, ...more] = this.parts;
    if (!member?.chunks || more.length > 0) return undefined;
    const most = member.shown?.deviation ?? Infinity;
    return member.chunks.map(({ byteEnd, deviation }) => ({ bytes: byteEnd, error: Math.min(deviation, most) / size }));
  }

  get bytes() {
    return this.parts.reduce((sum, part) => sum + part.bytes, 0);
  }

  get faces() {
    return this.parts.reduce((sum, part) => sum + part.faces, 0);
  }

  get arrived() {
    return Math.max(0, ...this.parts.map((part) => part.arrived));
  }

  get shown() {
    return Math.max(0, ...this.parts.map((part) => part.shown));
  }

  /** All of it, where that is known. */
  get total() {
    const totals = this.parts.map(({ total }) => total);
    if (totals.length === 0 || totals.includes(undefined)) return undefined;
    return totals.reduce((sum, { bytes, faces }) => ({ bytes: sum.bytes + bytes, faces: sum.faces + faces }), { bytes: 0, faces: 0 });
  }

  /** The farthest that the error map shows, as a share of the size. */
  get worstHeat() {
    return Math.max(0, ...this.#heats.map(({ worst }, i) => worst / this.parts[i].size));
  }

  get isMeasured() {
    return this.#heats.every((heat, i) => heat.isReady || !this.parts[i].level);
  }

  /** What the error map's last colour stands for, as a share of the size. */
  set heatScale(share) {
    if (!this.#heat) return;
    this.#heatMaterials.forEach((material, i) => {
      material.userData.scale.value = share * this.parts[i].size;
    });
  }

  get #heatMaterials() {
    this.#heatMaterial ??= this.parts.map(() => makeHeatMaterial());
    return this.#heatMaterial;
  }

  show({ wireframe, heat }) {
    if (wireframe === this.#wire && heat === this.#heat) return;
    [this.#wire, this.#heat] = [wireframe, heat];
    this.holder.traverse((object) => {
      if (!object.isMesh) return;
      if (!this.#plain.has(object)) this.#plain.set(object, object.material);
      const part = this.parts.findIndex(({ geometries }) => geometries.includes(object.geometry));
      object.material = heat && part >= 0 ? this.#heatMaterials[part] : this.#plain.get(object);
      for (const material of [object.material].flat()) material.wireframe = wireframe;
    });
    this.#heatMaterial?.forEach((material, i) => {
      material.flatShading = !this.parts[i].geometries[0].attributes.normal;
      material.needsUpdate = true;
    });
  }

  dispose() {
    this.#abort.abort();
    this.#close();
    for (const heat of this.#heats) heat.dispose();
    this.#heatMaterial?.forEach((material) => material.dispose());
    this.holder.removeFromParent();
  }
}

/** How much the first object that shows one of the geometries enlarges it. */
function stretchIn(scene, geometries) {
  let stretch = 0;
  scene.updateMatrixWorld(true);
  scene.traverse((object) => {
    if (geometries.includes(object.geometry)) stretch = Math.max(stretch, object.matrixWorld.getMaxScaleOnAxis());
  });
  return stretch || 1;
}

function disposeOf({ geometry, material, skeleton }) {
  geometry?.dispose();
  skeleton?.dispose();
  for (const one of [material].flat().filter(Boolean)) {
    for (const value of Object.values(one)) if (value?.isTexture) value.dispose();
    one.dispose();
  }
}
