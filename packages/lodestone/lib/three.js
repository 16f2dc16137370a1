// A stream as an object of three.js, that refines and coarsens as the camera moves.
import { Box3, BufferGeometry, Group, Mesh, MeshStandardMaterial, Sphere } from 'three';
import { LodestoneStream } from './index.js';
import { StreamBuffers, ballOf, pixelsPerUnit, viewOf } from './three_buffers.js';
import { STEP, pixelsThrough } from './view.js';
import { checkRange } from './wasm.js';

export { pixelsPerUnit };

/**
 * A mesh that arrives while it is drawn: a group with a mesh for each material. Call `update(camera, height)` before each
 * frame; the level then is the coarsest whose error covers at most `pixelError` pixels of the picture.
 */
export class LodestoneMesh extends Group {
  #stream;
  #buffers;
  #budget;
  #wanted = Infinity;

  /**
   * Opens a stream; resolves when its first level can be drawn. `material`: a material, or a function that makes one of a
   * group's number; none: a plain one. `budget`: a DetailBudget that says what is wanted in place of `pixelError`. `morph`:
   * milliseconds in which vertices slide from level to level; 0: none. `onUpdate` is called when the object has changed. Other options are those of LodestoneStream.open.
   */
  static async load(url, { material, pixelError = 1, deviation = Infinity, budget, morph = 0, onUpdate, ...options } = {}) {
    // How it is seen is not known yet: no more is fetched than its beginning.
    checkRange('morph', morph, 0, Number.MAX_SAFE_INTEGER);
    const more = { ...(budget && { slack: 1 }), ...(morph > 0 && { morph: true }) };
    const stream = await LodestoneStream.open(url, { deviation, ...more, ...options });
    const first = await stream.next();
    options.signal?.throwIfAborted();
    const mesh = new LodestoneMesh(stream, material, { morph, onStep: () => onUpdate?.(mesh) });
    mesh.pixelError = pixelError;
    mesh.#wanted = deviation;
    mesh.#apply(first);
    mesh.complete = mesh.#follow(onUpdate);
    mesh.complete.catch(() => {}); // who wants to know awaits it
    mesh.#budget = budget;
    budget?.add(mesh.#stream);
    return mesh;
  }

  constructor(stream, material, { morph, onStep } = {}) {
    super();
    this.#stream = stream;
    this.pixelError = 1;
    this.#buffers = new StreamBuffers(stream, { morph, onStep });
    this.#withNormals = stream.attributes.some(({ name }) => name === 'NORMAL');
    for (const group of stream.groups) this.#addGroup(group, material);
  }

  #withNormals = false;

  #addGroup({ material: number }, material) {
    const made = typeof material === 'function' ? material(number) : material;
    const plain = () => new MeshStandardMaterial({ flatShading: !this.#withNormals });
    const mesh = new Mesh(new BufferGeometry(), made ?? plain());
    mesh.geometry.boundingSphere = new Sphere();
    mesh.geometry.boundingBox = new Box3();
    this.add(mesh);
  }

  /** The level that is drawn: { position, vertexCount, wedgeCount, faceCount, deviation }. */
  get level() {
    return this.#stream.level;
  }

  get stream() {
    return this.#stream;
  }

  /** How many pixels of a picture of so many pixels' height a unit of the object covers at most. */
  pixelsPerUnit(camera, height) {
    this.updateWorldMatrix(true, false);
    return pixelsThrough(viewOf(camera, height), this.matrixWorld.elements, ballOf(this.children[0].geometry.boundingSphere));
  }

  /** Says how the object is seen: by which camera, in a picture of how many pixels' height. */
  update(camera, height) {
    this.#buffers.step();
    const pixels = this.pixelsPerUnit(camera, height);
    if (!(pixels > 0)) return; // at no size
    if (this.#budget) return void this.#budget.see(this.#stream, pixels);
    const wanted = this.pixelError / pixels;
    if (wanted <= this.#wanted * STEP && wanted * STEP >= this.#wanted) return;
    this.#wanted = wanted;
    this.#stream.want(wanted);
  }

  async #follow(onUpdate) {
    for await (const update of this.#stream) {
      await this.#buffers.leave(update);
      this.#apply(update);
      onUpdate?.(this);
    }
  }

  #apply(update) {
    const others = this.#buffers.write(update);
    update.groups.forEach(({ count }, i) => {
      const { geometry } = this.children[i];
      if (others) this.#buffers.put(geometry, i);
      this.#buffers.bound(geometry, count, update);
      this.children[i].visible = count > 0;
    });
  }

  /** Stops reading and frees what the object holds, but for its materials. */
  dispose() {
    this.#stream.close();
    this.#buffers.finish();
    this.#budget?.remove(this.#stream);
    for (const { geometry } of this.children) geometry.dispose();
  }
}
