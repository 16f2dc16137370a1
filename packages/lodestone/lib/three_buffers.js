// Buffers of three.js that a stream's updates are written to: geometries, one for each of its groups, that share their
// vertices.
import { BufferAttribute, Vector3 } from 'three';

/** How much what is wanted must change before it is said again. */
export const STEP = 1.05;

const NAMES = {
  POSITION: 'position',
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

/** What a stream's attribute is called in a geometry. */
export const nameOf = (name) => NAMES[name] ?? name.toLowerCase();

const TARGET = /^TARGET_(\d+):(POSITION|NORMAL|COLOR_0)$/;

/** The buffers of all groups. */
export class StreamBuffers {
  #stream;
  #attributes = []; // { name, growing, target }, shared by all groups
  #indices = []; // by group

  constructor(stream) {
    this.#stream = stream;
    const whole = stream.chunks.at(-1);
    const add = (name, itemSize, normalized, target) =>
      this.#attributes.push({ name, target, growing: new GrowingAttribute(itemSize, normalized, whole.vertexCount) });
    add('position', 3, false);
    for (const { name, componentCount, normalized } of stream.attributes) {
      const target = TARGET.exec(name);
      if (target) add(nameOf(target[2]), componentCount, normalized, Number(target[1]));
      else add(nameOf(name), componentCount, normalized);
    }
    this.#indices = stream.groups.map(() => new GrowingAttribute(1, false, 3 * whole.faceCount));
  }

  /** Whether there are morph targets, whose changes three.js sees in a new geometry alone. */
  get hasTargets() {
    return this.#attributes.some(({ target }) => target !== undefined);
  }

  /** Takes an update; returns whether geometries need their buffers anew: all of them, since they share those of vertices. */
  write({ wedges, groups, normals }) {
    let grown = false;
    if (wedges.end > wedges.begin) {
      [wedges.positions, ...wedges.attributes].forEach((values, i) => {
        grown = this.#attributes[i].growing.write(wedges.begin, values) || grown;
      });
      grown ||= this.hasTargets;
    }
    if (normals) grown = this.#writeNormals(normals) || grown;
    groups.forEach(({ ranges }, i) => {
      for (const { begin, corners } of ranges) grown = this.#indices[i].write(begin, corners) || grown;
    });
    return grown;
  }

  #writeNormals(normals) {
    let entry = this.#attributes.find(({ name }) => name === 'normal');
    if (!entry) {
      entry = { name: 'normal', growing: new GrowingAttribute(3, false, 0) };
      this.#attributes.push(entry);
    }
    entry.growing.likely = this.#attributes[0].growing.attribute.count;
    return entry.growing.write(0, normals);
  }

  /** Gives a geometry a group's buffers, those that `wanted(name)` of. Those before are let go of. */
  put(geometry, group, wanted = () => true) {
    geometry.dispose();
    for (const { name, growing, target } of this.#attributes) {
      if (!growing.attribute || !wanted(name)) continue;
      if (target === undefined) geometry.setAttribute(name, growing.attribute);
      else (geometry.morphAttributes[name] ??= [])[target] = growing.attribute;
    }
    const { attribute } = this.#indices[group];
    if (attribute) geometry.setIndex(attribute);
  }

  /**
   * Sets what a geometry draws and where it lies: what is there, as far around it as what is to come may lie, and `box`, where
   * targets may move it.
   */
  bound(geometry, count, { low, high }, box) {
    geometry.setDrawRange(0, count);
    const farthest = this.#stream.chunks[this.#stream.chunksReady - 1].deviation;
    geometry.boundingBox.set(new Vector3(...low), new Vector3(...high)).expandByScalar(farthest);
    if (box) geometry.boundingBox.union(box);
    geometry.boundingBox.getBoundingSphere(geometry.boundingSphere);
  }
}

/** How many pixels a unit of the world covers at a sphere's nearest point: see pixels_per_unit in detail_choice.h. */
export function pixelsPerUnit(camera, height, sphere) {
  const [scale, isOrthographic] = [camera.projectionMatrix.elements[5], camera.projectionMatrix.elements[15] === 1];
  if (isOrthographic) return (height * scale) / 2;
  const eye = new Vector3().setFromMatrixPosition(camera.matrixWorld);
  const distance = eye.distanceTo(sphere.center) - sphere.radius;
  return distance > 0 ? (height * scale) / (2 * distance) : Infinity;
}
