// Buffers of three.js that a stream's updates are written to: geometries, one for each of its groups, that share their
// vertices.
import { BufferAttribute, Vector3 } from 'three';
import { GrowingArray } from './growing_array.js';
import { targetOf } from './refined_mesh.js';
import { Slides, wayOf } from './slides.js';
import { pixelsAt } from './view.js';

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
  #array;

  constructor(itemSize, normalized, likely) {
    this.#array = new GrowingArray(itemSize, likely);
    this.normalized = normalized;
    this.attribute = undefined;
  }

  get array() {
    return this.#array.array;
  }

  get itemSize() {
    return this.#array.itemSize;
  }

  /** Whether what lies between two values means anything. */
  get mixes() {
    return this.normalized || this.array instanceof Float32Array;
  }

  set likely(count) {
    this.#array.likely = count;
  }

  /** Writes numbers at an element; returns whether the attribute is another one now. */
  write(begin, values) {
    const { itemSize } = this.#array;
    const grows = this.#array.write(begin, values);
    if (grows) this.attribute = new BufferAttribute(this.#array.array, itemSize, this.normalized);
    else this.touch(begin, values.length / itemSize);
    this.attribute.needsUpdate = true;
    return grows;
  }

  /** Has elements uploaded. */
  touch(begin, count) {
    if (count > 0) this.attribute.addUpdateRange(begin * this.itemSize, count * this.itemSize);
    this.attribute.needsUpdate = true;
  }
}

/** What a stream's attribute is called in a geometry. */
const nameOf = (name) => NAMES[name] ?? name.toLowerCase();

/** The buffers of all groups. */
export class StreamBuffers {
  #stream;
  #attributes = []; // { name, growing, target }, shared by all groups
  #indices = []; // by group
  #wedges = 0;
  #level; // that has been written last
  #slides;

  /** `morph`: milliseconds in which vertices slide from level to level; `onStep` is called when they have. */
  constructor(stream, { morph = 0, onStep = () => {} } = {}) {
    this.#stream = stream;
    if (morph > 0) this.#slides = new Slides(morph, onStep);
    const whole = stream.chunks.at(-1);
    const add = (name, itemSize, normalized, target) =>
      this.#attributes.push({ name, target, growing: new GrowingAttribute(itemSize, normalized, whole.vertexCount) });
    add('position', 3, false);
    for (const { name, componentCount, normalized } of stream.attributes) {
      const morph = targetOf(name);
      add(nameOf(morph?.semantic ?? name), componentCount, normalized, morph?.target);
    }
    this.#indices = stream.groups.map(() => new GrowingAttribute(1, false, 3 * whole.faceCount));
  }

  /** Whether there are morph targets, whose changes three.js sees in a new geometry alone. */
  get hasTargets() {
    return this.#attributes.some(({ target }) => target !== undefined);
  }

  /**
   * Those whose elements slide. Joints are numbers of bones, which mean nothing in between, and so weights stay, too; targets
   * say by how far they move vertices wherever those are. Normals that have been worked out are all written anew.
   */
  get #sliding() {
    const slides = ({ name, target, growing }) => growing.mixes && target === undefined && !/^skin|^(joints|weights)_/.test(name);
    const own = this.#attributes.slice(0, 1 + this.#stream.attributes.length);
    return own.filter(slides).map(({ growing }) => growing);
  }

  /** Has vertices slide to a coarser level, before that is written; resolves when they are there. */
  async leave(update) {
    if (this.#slides && wayOf(this.#level, update) < 0) await this.#slides.coarsen(update, this.#sliding);
  }

  /**
   * Takes an update, from whose level before, where that `isShown`, vertices slide; returns whether geometries need their buffers
   * anew: all of them, since they share those of vertices.
   */
  write(update, isShown = true) {
    const slides = isShown && this.#slides && wayOf(this.#level, update) > 0;
    this.#level = update.level;
    if (!slides) return this.#write(update);
    let grown = false;
    const write = () => {
      grown = this.#write(update);
    };
    this.#slides.refine(update, this.#sliding, write);
    return grown;
  }

  /** Moves what slides to where it is by now: for who draws. */
  step() {
    this.#slides?.step();
  }

  /** Has what slides be where it is to be. */
  finish() {
    this.#slides?.finish();
  }

  #write({ wedges, moved, groups, normals }) {
    let grown = false;
    if (wedges.end > wedges.begin) {
      this.#wedges = wedges.end;
      [wedges.positions, ...wedges.attributes].forEach((values, i) => {
        grown = this.#attributes[i].growing.write(wedges.begin, values) || grown;
      });
      grown ||= this.hasTargets;
    }
    for (const { begin, positions } of moved) this.#attributes[0].growing.write(begin, positions);
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

  /** Gives a geometry a group's buffers: of attributes those that `own` says, one after the other. Those before are let go of. */
  put(geometry, group, own) {
    geometry.dispose();
    this.#attributes.forEach(({ name, growing, target }, i) => {
      // The first are positions; behind the stream's own come normals that have been worked out.
      if (!growing.attribute || own?.[i - 1] === false) return;
      if (target === undefined) geometry.setAttribute(name, growing.attribute);
      else (geometry.morphAttributes[name] ??= [])[target] = growing.attribute;
    });
    const { attribute } = this.#indices[group];
    if (attribute) geometry.setIndex(attribute);
  }

  /**
   * Sets what a geometry draws and where it lies: what is there, as far around it as what is to come may lie, and `box`, where
   * targets may move it. `userData.lodestone` says how many vertices have arrived, which are more than the level has where
   * that has been coarsened.
   */
  bound(geometry, count, { low, high }, box) {
    geometry.setDrawRange(0, count);
    geometry.userData.lodestone = { wedgeCount: this.#wedges };
    const farthest = this.#stream.chunks[this.#stream.chunksReady - 1].deviation;
    geometry.boundingBox.set(new Vector3(...low), new Vector3(...high)).expandByScalar(farthest);
    if (box) geometry.boundingBox.union(box);
    geometry.boundingBox.getBoundingSphere(geometry.boundingSphere);
  }
}

/** How a camera sees, in a picture of so many pixels' height: see pixelsAt. */
export function viewOf(camera, height) {
  const { elements } = camera.projectionMatrix;
  const [x, y, z] = camera.matrixWorld.elements.slice(12, 15);
  return { scale: elements[5], isOrthographic: elements[15] === 1, height, eye: [x, y, z], near: camera.near ?? 0 };
}

/** A sphere of three.js as numbers. */
export const ballOf = ({ center, radius }) => ({ center: center.toArray(), radius });

/** How many pixels a unit of the world covers at a sphere's nearest point; Infinity where that is seen from within. */
export const pixelsPerUnit = (camera, height, sphere) => pixelsAt({ ...viewOf(camera, height), near: 0 }, ballOf(sphere));
