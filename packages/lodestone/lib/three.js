// A stream as an object of three.js, that refines and coarsens as the camera moves.
import { Box3, BufferAttribute, BufferGeometry, Group, Mesh, MeshStandardMaterial, Sphere, Vector3 } from 'three';
import { LodestoneStream } from './index.js';

const NAMES = {
  NORMAL: 'normal',
  TANGENT: 'tangent',
  TEXCOORD_0: 'uv',
  TEXCOORD_1: 'uv1',
  TEXCOORD_2: 'uv2',
  TEXCOORD_3: 'uv3',
  COLOR_0: 'color',
  JOINTS_0: 'skinIndex',
  WEIGHTS_0: 'skinWeight',
};

/** How much what is wanted must change before it is said again. */
const STEP = 1.05;

/** A buffer that grows: three.js uploads what `write` is given and no more, but for when it grows. */
class GrowingAttribute {
  constructor(itemSize, normalized, likely) {
    this.itemSize = itemSize;
    this.normalized = normalized;
    this.likely = likely; // elements that it comes to in the end, as far as is known
    this.attribute = undefined;
  }

  /** Writes numbers at an element; returns whether the attribute is another one now. */
  write(begin, values) {
    const end = begin + values.length / this.itemSize;
    const grows = !this.attribute || end > this.attribute.count;
    if (grows) this.#grow(end, values.constructor);
    this.attribute.array.set(values, begin * this.itemSize);
    if (!grows && values.length > 0) this.attribute.addUpdateRange(begin * this.itemSize, values.length);
    this.attribute.needsUpdate = true;
    return grows;
  }

  #grow(end, Type) {
    const old = this.attribute;
    // What a file says that it comes to is believed no further than twice what is there.
    const count = Math.max(end, Math.min(this.likely, 2 * Math.max(old?.count ?? 0, end)));
    const array = new Type(count * this.itemSize);
    if (old) array.set(old.array);
    this.attribute = new BufferAttribute(array, this.itemSize, this.normalized);
  }
}

/**
 * A mesh that arrives while it is drawn: a group with a mesh for each material. Call `update(camera, height)` before each
 * frame; the level then is the coarsest whose error covers at most `pixelError` pixels of the picture.
 */
export class LodestoneMesh extends Group {
  #stream;
  #attributes = []; // { name, growing }, shared by all meshes
  #indices = []; // by group
  #wanted = Infinity;

  /**
   * Opens a stream; resolves when its first level can be drawn. `material`: a material, or a function that makes one of a
   * group's number; none: a plain one. Other options are those of LodestoneStream.open.
   */
  static async load(url, { material, pixelError = 1, deviation = Infinity, ...options } = {}) {
    // How it is seen is not known yet: no more is fetched than its beginning.
    const mesh = new LodestoneMesh(await LodestoneStream.open(url, { deviation, ...options }), material);
    mesh.pixelError = pixelError;
    mesh.#wanted = deviation;
    mesh.#apply(await mesh.#stream.next());
    mesh.complete = mesh.#follow();
    mesh.complete.catch(() => {}); // who wants to know awaits it
    return mesh;
  }

  constructor(stream, material) {
    super();
    this.#stream = stream;
    this.pixelError = 1;
    const { attributes, chunks, groups } = stream;
    const whole = chunks.at(-1);
    const add = (name, itemSize, normalized) => this.#attributes.push({ name, growing: new GrowingAttribute(itemSize, normalized, whole.vertexCount) });
    add('position', 3, false);
    for (const { name, componentCount, normalized } of attributes) add(NAMES[name] ?? name.toLowerCase(), componentCount, normalized);
    this.#withNormals = attributes.some(({ name }) => name === 'NORMAL');
    for (const group of groups) this.#addGroup(group, material, whole.faceCount);
  }

  #withNormals = false;

  #addGroup({ material: number }, material, faceCount) {
    const made = typeof material === 'function' ? material(number) : material;
    const plain = () => new MeshStandardMaterial({ flatShading: !this.#withNormals });
    const mesh = new Mesh(new BufferGeometry(), made ?? plain());
    mesh.geometry.boundingSphere = new Sphere();
    mesh.geometry.boundingBox = new Box3();
    this.add(mesh);
    this.#indices.push(new GrowingAttribute(1, false, 3 * faceCount));
  }

  /** The level that is drawn: { position, vertexCount, wedgeCount, faceCount, deviation }. */
  get level() {
    return this.#stream.level;
  }

  get stream() {
    return this.#stream;
  }

  /** Says how the object is seen: by which camera, in a picture of how many pixels' height. */
  update(camera, height) {
    this.updateWorldMatrix(true, false);
    const scale = this.matrixWorld.getMaxScaleOnAxis();
    const wanted = this.pixelError / (scale * pixelsPerUnit(camera, height, this.#worldSphere(scale)));
    if (wanted <= this.#wanted * STEP && wanted * STEP >= this.#wanted) return;
    this.#wanted = wanted;
    this.#stream.want(wanted);
  }

  /** A sphere around the object as it is and will be, in the world. */
  #worldSphere(scale) {
    const { center, radius } = this.children[0].geometry.boundingSphere;
    return new Sphere(center.clone().applyMatrix4(this.matrixWorld), radius * scale);
  }

  async #follow() {
    for await (const update of this.#stream) this.#apply(update);
  }

  #apply(update) {
    const { wedges, groups, normals } = update;
    let grown = false;
    if (wedges.end > wedges.begin)
      [wedges.positions, ...wedges.attributes].forEach((values, i) => {
        grown = this.#attributes[i].growing.write(wedges.begin, values) || grown;
      });
    if (normals) grown = this.#setNormals(normals) || grown;
    groups.forEach(({ count, ranges }, i) => {
      const index = this.#indices[i];
      let other = false;
      for (const { begin, corners } of ranges) other = index.write(begin, corners) || other;
      const { geometry } = this.children[i];
      if (grown || other) this.#setBuffers(geometry, index);
      geometry.setDrawRange(0, count);
      this.children[i].visible = count > 0;
      this.#setBounds(geometry, update);
    });
  }

  #setNormals(normals) {
    let entry = this.#attributes.find(({ name }) => name === 'normal');
    if (!entry) this.#attributes.push((entry = { name: 'normal', growing: new GrowingAttribute(3, false, this.#attributes[0].growing.likely) }));
    const positions = this.#attributes[0].growing.attribute;
    entry.growing.likely = positions.count;
    return entry.growing.write(0, normals);
  }

  /** Buffers that have grown are others: the graphics card lets go of those before. */
  #setBuffers(geometry, index) {
    geometry.dispose();
    for (const { name, growing } of this.#attributes) if (growing.attribute) geometry.setAttribute(name, growing.attribute);
    if (index.attribute) geometry.setIndex(index.attribute);
  }

  /** What is there, and as far around it as what is to come may lie. */
  #setBounds(geometry, { low, high }) {
    const farthest = this.#stream.chunks[this.#stream.chunksReady - 1].deviation;
    geometry.boundingBox.set(new Vector3(...low), new Vector3(...high)).expandByScalar(farthest);
    geometry.boundingBox.getBoundingSphere(geometry.boundingSphere);
  }

  /** Stops reading and frees what the object holds, but for its materials. */
  dispose() {
    this.#stream.close();
    for (const { geometry } of this.children) geometry.dispose();
  }
}

/** How many pixels a unit of the world covers at a sphere's nearest point: see pixels_per_unit in detail_choice.h. */
export function pixelsPerUnit(camera, height, sphere) {
  if (camera.isOrthographicCamera) return (height * camera.zoom) / (camera.top - camera.bottom);
  const eye = new Vector3().setFromMatrixPosition(camera.matrixWorld);
  const distance = eye.distanceTo(sphere.center) - sphere.radius;
  if (!(distance > 0)) return Infinity;
  return height / (2 * distance * Math.tan((camera.getEffectiveFOV() * Math.PI) / 360));
}
