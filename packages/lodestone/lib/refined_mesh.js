// A mesh of a glTF that refines itself by its stream, whatever the engine: how fine it has to be, and the stream's life.
import { LodestoneStream } from './index.js';
import { BoneBoxes, STEP } from './view.js';

export const EXTENSION = 'LODESTONE_removal_stream';
const PATIENCE = 300; // milliseconds before it is coarsened
const COMPONENT_COUNTS = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4 };
const TARGET = /^TARGET_(\d+):(\w+)$/;

/** Returns the target and the semantic of a stream's attribute that is of a morph target; else undefined. */
export function targetOf(name) {
  const match = TARGET.exec(name);
  return match ? { target: Number(match[1]), semantic: match[2] } : undefined;
}

/**
 * Returns what a mesh's definition says of a stream that can be read here and refines what is shown; else undefined. Without a
 * deviation the mesh is the finest level, which needs no refining.
 */
export function streamOf(definition) {
  const extension = definition.extensions?.[EXTENSION];
  return extension?.version?.startsWith('3.') && extension.deviation !== undefined ? extension : undefined;
}

/**
 * Says which of a stream's attributes are a primitive's: those that it has, in the type that its accessor has, where the mesh's
 * primitives have it in several.
 */
export function ownAttributes({ accessors }, { attributes, targets = [] }, formats) {
  return formats.map(({ name, componentType, componentCount, normalized }) => {
    const morph = targetOf(name);
    if (morph) return targets[morph.target]?.[morph.semantic] !== undefined;
    if (attributes[name] === undefined) return false;
    if (formats.filter((other) => other.name === name).length === 1) return true;
    const accessor = accessors[attributes[name]];
    return accessor.componentType === componentType && COMPONENT_COUNTS[accessor.type] === componentCount && (accessor.normalized ?? false) === normalized;
  });
}

/** The mesh and its stream. An engine's buffers are told what arrives, and when they are to be drawn from. */
export class RefinedMesh {
  #source; // () => Promise of a URL
  #options;
  #makeBuffers; // (stream) => what has write(update, isShown) and show(update, isFirst); leave(update), step() and finish() where vertices slide
  #shown; // { deviation, faceCount } of the file's own level
  #stream;
  #buffers;
  #bones = new BoneBoxes();
  #attached = false;
  #opening;
  #wanted = Infinity;
  #frame = -1;
  #drawn = -1; // the frame that vertices have been moved for
  #finest = Infinity; // wanted in this frame
  #needed = 0; // when it was last wanted as fine as it is
  #url; // of what is in memory
  #closed = false;
  #abort = new AbortController(); // when it is closed
  #resolve;
  #reject;
  geometries = []; // that show it: whoever makes it says them
  primitiveCount = 1; // that those are of

  constructor(source, shown, options, makeBuffers) {
    this.#source = source;
    this.#shown = shown;
    this.#options = options;
    this.#makeBuffers = makeBuffers;
    this.complete = new Promise((resolve, reject) => {
      this.#resolve = resolve;
      this.#reject = reject;
    });
    this.complete.catch(() => {}); // who wants to know awaits it
    options.budget?.add(this);
  }

  /** The level that is drawn; undefined while it is the file's own. */
  get level() {
    return this.#attached ? this.#stream.level : undefined;
  }

  /** The file's own level. */
  get shown() {
    return this.#shown;
  }

  get chunks() {
    return this.#stream?.chunks;
  }

  get chunksReady() {
    return this.#stream?.chunksReady ?? 0;
  }

  /** Whether no more of it will come. */
  get ended() {
    return this.#stream?.ended ?? false;
  }

  /** What it was said that it may deviate by, if its level is what comes of that. */
  get settled() {
    return this.#stream?.settled;
  }

  /** Of what has arrived. */
  get bytes() {
    return this.#stream?.bytes ?? 0;
  }

  /** How far what is still to come may lie outside of what is there. */
  get farthest() {
    return this.#stream ? this.#stream.chunks[Math.max(this.chunksReady, 1) - 1].deviation : this.#shown.deviation;
  }

  /** Where bones find what they move. */
  get bones() {
    return this.#bones;
  }

  /** Is told by each object that shows one of its primitives, at so many places, how many pixels a unit of the mesh covers there. */
  see(pixels, frame, places = 1) {
    if (frame !== this.#drawn) this.#buffers?.step?.();
    this.#drawn = frame;
    if (!(pixels > 0)) return; // at no size
    if (this.#options.budget) this.#options.budget.see(this, pixels, places / this.primitiveCount);
    else this.#need(this.#options.pixelError / pixels, frame);
  }

  #need(deviation, frame) {
    const now = performance.now();
    if (frame !== this.#frame) {
      // Several cameras may see it in turn: it gets coarser when none has wanted it as fine for a while.
      if (this.#finest > this.#wanted * STEP && now - this.#needed > PATIENCE) this.want(this.#finest);
      this.#frame = frame;
      this.#finest = Infinity;
    }
    this.#finest = Math.min(this.#finest, deviation);
    if (this.#finest <= this.#wanted * STEP) this.#needed = now;
    if (this.#finest * STEP < this.#wanted) this.want(this.#finest);
  }

  /** Says how far it may lie from the whole; nothing is fetched while what the file shows is as fine. */
  want(deviation) {
    this.#wanted = deviation;
    if (this.#closed) return;
    if (this.#stream) this.#stream.want(deviation);
    else if ((deviation < this.#shown.deviation || deviation === 0) && !this.#opening) {
      this.#opening = this.#open().catch((error) => this.#fail(error)).finally(() => this.#letGo());
    }
  }

  async #open() {
    const { worker, fetch, idleTimeout, budget, morph } = this.#options;
    const options = { worker, fetch, idleTimeout, deviation: this.#wanted, slack: budget && 1, morph: morph > 0, signal: this.#abort.signal };
    this.#url = await this.#source();
    const stream = await LodestoneStream.open(this.#url, options);
    this.#stream = stream;
    if (this.#closed) return;
    this.#buffers = this.#makeBuffers(stream);
    stream.want(this.#wanted);
    for await (const update of stream) {
      if (this.#attached) await this.#buffers.leave?.(update);
      if (this.#closed) break;
      this.#apply(update);
      this.#options.onUpdate?.(this);
      if (stream.complete) this.#resolve();
    }
  }

  #fail(error) {
    this.#options.budget?.remove(this);
    this.#reject(error);
  }

  #letGo() {
    this.#stream?.close();
    if (this.#url?.startsWith('blob:')) URL.revokeObjectURL(this.#url);
  }

  /** What arrives first is coarser than what is there already: only a level as fine takes its place. */
  #apply(update) {
    this.#addBones(update.wedges);
    this.#buffers.write(update, this.#attached);
    const isFirst = !this.#attached && update.level.faceCount >= this.#shown.faceCount;
    this.#attached ||= isFirst;
    if (this.#attached) this.#buffers.show(update, isFirst);
  }

  #addBones({ positions, attributes }) {
    const formats = this.#stream.attributes;
    formats.forEach(({ name }, i) => {
      if (!name.startsWith('JOINTS_')) return;
      const weights = formats.findIndex((other) => other.name === name.replace('JOINTS', 'WEIGHTS'));
      if (weights >= 0) this.#bones.add(positions, attributes[i], attributes[weights]);
    });
  }

  get isClosed() {
    return this.#closed;
  }

  close() {
    if (this.#closed) return;
    this.#closed = true;
    this.#abort.abort();
    this.#buffers?.finish?.();
    this.#options.budget?.remove(this);
    this.#resolve();
  }
}

/** What a page gets of a file's meshes. */
export class Refinement {
  #options;

  constructor(meshes, options) {
    this.meshes = meshes;
    this.#options = options;
  }

  get pixelError() {
    return this.#options.pixelError;
  }

  set pixelError(pixels) {
    this.#options.pixelError = pixels;
  }

  /** Stops reading; what is drawn stays. */
  dispose() {
    for (const mesh of this.meshes) mesh.close();
  }
}
