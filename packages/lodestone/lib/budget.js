// Several meshes that share what may be drawn and fetched: all have the same error in pixels, the smallest for which there is
// enough, and the next bytes are fetched for those that have the greatest.
import { STEP, leastSoFar } from './view.js';

const PATIENCE = 300; // milliseconds for which what was seen counts
const SETTLED = 150; // milliseconds after which a level is what comes of what is wanted, where a mesh does not say so
const CLOSE = 1.02; // levels whose faces differ by less are known well enough

/** How many faces a mesh has at each deviation, as far as is known: at the ends of its chunks, and where it has been. */
class Curve {
  #known; // by falling deviation, faces rising

  constructor(levels) {
    const least = leastSoFar(levels);
    this.#known = levels.filter((_, i) => i === 0 || least[i] < least[i - 1]).map(({ deviation, faceCount }) => ({ deviation, faceCount }));
    const last = this.#known.at(-1);
    const before = this.#known.at(-2);
    // Faces are about the inverse of the deviation: below that there is the whole.
    if (last.deviation === 0 && before) last.deviation = before.deviation * (before.faceCount / last.faceCount);
  }

  /** So many faces come of it where levels may deviate by so much, and by up to `farther` times as much: there is none in between. */
  learn(deviation, faceCount, farther = 1) {
    const known = this.#known;
    const at = known.findIndex((level) => level.deviation < deviation);
    const [before, after] = [known[at - 1], known[at]];
    if (!before || !after || faceCount > after.faceCount || faceCount < before.faceCount * CLOSE) return;
    const place = Math.min(deviation * farther, before.deviation * (1 - 1e-9));
    if (faceCount * CLOSE > after.faceCount && place < after.deviation * CLOSE && place < before.deviation / CLOSE) return;
    const isStep = faceCount === after.faceCount && faceCount === known[at + 1]?.faceCount;
    known.splice(at, isStep ? 1 : 0, { deviation: place, faceCount });
  }

  get coarsest() {
    return this.#known[0].deviation;
  }

  get finest() {
    return this.#known.at(-1).deviation;
  }

  /** The faces of a level that deviates by so much. In between they are thought to grow evenly while it falls by halves: too many. */
  faces(deviation) {
    const known = this.#known;
    if (!(deviation < known[0].deviation)) return known[0].faceCount;
    let [low, high] = [0, known.length - 1];
    if (deviation <= known[high].deviation) return known[high].faceCount;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (known[middle].deviation > deviation) low = middle;
      else high = middle;
    }
    const [a, b] = [known[low], known[high]];
    const share = Math.log(a.deviation / deviation) / Math.log(a.deviation / b.deviation);
    return a.faceCount + share * (b.faceCount - a.faceCount);
  }
}

/** What the budget knows of a mesh. */
class Entry {
  constructor(mesh) {
    this.mesh = mesh;
    this.pixels = 0; // a unit of the mesh covers
    this.places = 1; // at which it is drawn
    this.view = undefined; // what has been seen since the last update, { pixels, places }
    this.seen = -Infinity; // when
    this.wanted = undefined;
    this.curve = undefined;
    this.least = undefined; // by chunk
    this.level = undefined; // that was drawn last
    this.since = -Infinity; // when it, or what is wanted, became another
  }

  see(pixels, places) {
    this.view ??= { pixels: 0, places: 0 };
    this.view.pixels = Math.max(this.view.pixels, pixels);
    this.view.places += places;
  }

  /** What was seen since the last time counts; what was not for a while is far away. */
  refresh(now) {
    if (this.view) {
      Object.assign(this, this.view);
      this.seen = now;
    } else if (now - this.seen > PATIENCE) {
      this.pixels = 0;
    }
    this.view = undefined;
    const { chunks } = this.mesh;
    if (chunks) this.curve ??= new Curve(chunks);
    if (chunks) this.least ??= leastSoFar(chunks);
    this.#learn(now);
  }

  #learn(now) {
    const { level } = this.mesh;
    if (!this.curve || !level) return;
    if (level.faceCount !== this.level?.faceCount) this.since = now;
    this.level = level;
    this.curve.learn(level.deviation, level.faceCount);
    const isSettled = 'settled' in this.mesh ? this.mesh.settled === this.wanted : now - this.since > SETTLED;
    // It is as coarse as it may get: there is no other level up to what is wanted, and hardly a little farther.
    if (isSettled && level.deviation < this.wanted) this.curve.learn(this.wanted, level.faceCount, STEP);
  }

  /** The deviation of what has arrived, of which a file's own level is part. */
  get arrived() {
    const { chunksReady, shown } = this.mesh;
    return Math.min(shown?.deviation ?? Infinity, this.least && chunksReady > 0 ? this.least[chunksReady - 1] : Infinity);
  }

  /**
   * What brings it nearer to the whole: the next chunk that leads to a finer level than has arrived, as not every chunk does, with
   * the bytes up to its end; undefined where nothing is known of chunks, or none is left, or will come.
   */
  get next() {
    const { chunks, chunksReady, bytes, ended } = this.mesh;
    if (ended) return undefined;
    const chunk = chunks?.find(({ deviation }, i) => i >= chunksReady && deviation < this.arrived);
    return chunk && { deviation: chunk.deviation, bytes: chunk.byteEnd - (bytes ?? 0) };
  }

  /** Whether it is to have bytes that are still to come. */
  get isWaiting() {
    return this.wanted < this.arrived && !(this.mesh.chunks && !this.next);
  }

  facesNow() {
    return this.places * (this.mesh.level?.faceCount ?? this.mesh.shown?.faceCount ?? 0);
  }

  facesAt(error) {
    if (!this.curve) return this.places * (this.mesh.shown?.faceCount ?? 0);
    return this.places * this.curve.faces(this.pixels === 0 ? Infinity : error / this.pixels);
  }

  /** A little finer is not worth the work, but where bytes come of it; a little coarser is, where there are too many triangles. */
  want(deviation, now) {
    const isClose = deviation <= this.wanted && deviation * STEP >= this.wanted && (deviation > 0 || this.wanted === 0);
    const isNext = deviation < this.arrived && this.wanted >= this.arrived;
    if (isClose && !isNext) return;
    this.wanted = deviation;
    this.since = now;
    this.mesh.want(deviation);
  }
}

export class DetailBudget {
  #entries = new Map();
  #error = Infinity;

  constructor({ triangles = Infinity, bytes = Infinity, pixelError = 1, atOnce = 2 } = {}) {
    this.triangles = triangles;
    this.bytes = bytes;
    this.pixelError = pixelError;
    this.atOnce = atOnce;
  }

  add(mesh) {
    if (!this.#entries.has(mesh)) this.#entries.set(mesh, new Entry(mesh));
  }

  remove(mesh) {
    this.#entries.delete(mesh);
  }

  see(mesh, pixels, places = 1) {
    if (pixels > 0) this.#entries.get(mesh)?.see(pixels, places);
  }

  get error() {
    return this.#error;
  }

  get drawn() {
    return this.#sum((entry) => entry.facesNow());
  }

  get fetched() {
    return this.#sum(({ mesh }) => mesh.bytes ?? 0);
  }

  get isWaiting() {
    return [...this.#entries.values()].some((entry) => entry.isWaiting);
  }

  #sum(count) {
    let sum = 0;
    for (const entry of this.#entries.values()) sum += count(entry);
    return sum;
  }

  update(now = performance.now()) {
    for (const entry of this.#entries.values()) entry.refresh(now);
    this.#error = this.#chooseError();
    const allowed = this.#chooseNext();
    for (const entry of this.#entries.values()) {
      const deviation = entry.pixels === 0 ? Infinity : this.#error / entry.pixels;
      // Who is not next has what has arrived.
      entry.want(Math.max(deviation, allowed.get(entry) ?? entry.arrived), now);
    }
  }

  #faces(error) {
    return this.#sum((entry) => entry.facesAt(error));
  }

  /** The smallest error in pixels for which there are triangles enough. */
  #chooseError() {
    if (this.#faces(this.pixelError) <= this.triangles) return this.pixelError;
    let low = Infinity;
    let high = this.pixelError;
    for (const { pixels, curve } of this.#entries.values()) {
      if (!curve || pixels === 0) continue;
      low = Math.min(low, pixels * curve.finest);
      high = Math.max(high, pixels * curve.coarsest);
    }
    low = Math.max(low, this.pixelError);
    if (!(low < high)) return high;
    for (let i = 0; i < 40 && high > low * 1.001; ++i) {
      const middle = low > 0 ? Math.sqrt(low * high) : high / 2;
      if (this.#faces(middle) <= this.triangles) high = middle;
      else low = middle;
    }
    return high;
  }

  /** Those whose next chunk may be fetched, and how far they may be refined with it. */
  #chooseNext() {
    const waiting = [];
    for (const entry of this.#entries.values())
      if (entry.pixels * entry.arrived > this.#error && !(entry.mesh.chunks && !entry.next)) waiting.push(entry);
    waiting.sort((a, b) => b.pixels * b.arrived - a.pixels * a.arrived);
    const allowed = new Map();
    let bytes = this.fetched;
    for (const entry of waiting) {
      if (allowed.size === this.atOnce) break;
      const { next } = entry;
      const more = next?.bytes ?? 0;
      if (bytes + more > this.bytes) continue;
      bytes += more;
      // Before it is opened nothing is known of its chunks: its first are fetched.
      allowed.set(entry, next?.deviation ?? entry.arrived / STEP ** 2);
    }
    return allowed;
  }
}
