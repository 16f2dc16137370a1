// A stream that is read and drawn from: fetches what is wanted, decodes it, and hands out what an engine has to upload.
// It runs in a worker, or where there is none in the page.
import { Source } from './source.js';
import { leastSoFar } from './view.js';
import { Wakeup } from './wakeup.js';

const MOST_RECORDS = 20_000; // in an update: about a megabyte, which a page takes in a few milliseconds
const MOST_BYTES = 1 << 18; // in a request, so that what is wanted may change

export class Session {
  #runtime; // a promise of it
  #options;
  #source;
  #stream; // undefined while the runtime is loaded
  #cursor;
  #deviation;
  #changed = new Wakeup();
  #acknowledged = new Wakeup();
  #post;
  #closed = false;
  #lost = false; // the runtime
  #chunks = [];
  #least = []; // by chunk: what levels that it and those before it lead to deviate by at least
  #ended = false; // no more bytes
  #told = {}; // of where it stands, with the last update; nothing before the base mesh is shown

  /**
   * `runtime` is one, or a promise of one: what is asked of the session while that is loaded holds from its first step on. `post(message,
   * transferred)` gets the messages; after each update it waits for `acknowledge`.
   */
  constructor(runtime, url, options, post) {
    this.#runtime = runtime;
    this.#options = options;
    this.#deviation = options.deviation ?? 0;
    this.#source = new Source(url, options);
    this.#post = post;
  }

  /** Says what levels may deviate by: more is fetched where that is less than what has arrived. */
  want(deviation) {
    this.#deviation = deviation;
    this.#changed.wake();
  }

  acknowledge() {
    this.#acknowledged.wake();
  }

  close() {
    this.#closed = true;
    this.#source.close();
    this.#changed.wake();
    this.#acknowledged.wake();
  }

  /** Ends it with an error that another session of the runtime has had: nothing of that can be called any more. */
  lose({ code, message }) {
    this.#lost = true;
    if (this.#closed) return;
    this.close();
    this.#post({ type: 'error', code, message });
  }

  /** Works until it is closed, or fails with a message of type "error". */
  async run() {
    try {
      const runtime = await this.#runtime;
      if (!this.#closed) this.#stream = runtime.createStream({ mostBytes: this.#options.mostBytes });
      while (!this.#closed) {
        if ((await this.#move()) || (await this.#tell())) continue;
        if (this.#isEnough()) await this.#changed.wait();
        else await this.#fetchMore();
      }
    } catch (error) {
      this.#source.close();
      const closed = this.#closed;
      this.#closed = true;
      this.#lost ||= error.code === 'LODESTONE_OUT_OF_MEMORY';
      if (!closed) this.#post({ type: 'error', code: error.code ?? 'UNKNOWN', message: error.message });
    }
    if (this.#lost) return; // nothing can be called any more
    this.#cursor?.destroy();
    this.#stream?.destroy();
  }

  /**
   * Where it stands: what has come of the stream, whether there is no more to come, and what levels may deviate by, if what is shown
   * is what comes of that.
   */
  #standing() {
    const { chunksReady, chunkCount } = this.#stream.state;
    const isSettled = this.#cursor?.choose(this.#deviation) === this.#cursor?.level.position;
    return { chunksReady, ended: this.#ended || (chunkCount > 0 && chunksReady === chunkCount), settled: isSettled ? this.#deviation : undefined };
  }

  #isEnough() {
    const { chunksReady, ended } = this.#standing();
    if (ended) return true;
    return chunksReady > 0 && this.#least[chunksReady - 1] <= this.#deviation;
  }

  /** How far bytes are wanted. */
  #wantedEnd(state) {
    let index = state.chunksReady;
    const most = state.dueBegin + MOST_BYTES;
    while (index + 1 < this.#chunks.length && this.#chunks[index].deviation > this.#deviation && this.#chunks[index].byteEnd < most) ++index;
    return Math.max(state.dueEnd, this.#chunks[index]?.byteEnd ?? 0);
  }

  async #fetchMore() {
    const state = this.#stream.state;
    const read = await this.#source.read(state.dueBegin, this.#wantedEnd(state));
    if (this.#closed) return;
    if (read) {
      await this.#append(read);
      return;
    }
    this.#ended = true;
    this.#stream.finish();
  }

  /** Hands bytes over as far as a chunk is complete, and shows that before it goes on. */
  async #append({ offset, bytes }) {
    for (;;) {
      const before = this.#stream.state;
      const length = Math.min(bytes.length, before.dueEnd - offset);
      if (length <= 0) return; // behind the end, or all of it was there before
      this.#stream.append(offset, bytes.subarray(0, length));
      offset += length;
      bytes = bytes.subarray(length);
      const after = this.#stream.state;
      if (before.chunkCount === 0 && after.chunkCount > 0) this.#list(after.chunkCount);
      if (after.chunksReady > 0 && !this.#cursor) this.#start(after);
      if (after.chunksReady > before.chunksReady) while (!this.#closed && (await this.#move()));
      if (this.#closed || bytes.length === 0) return;
    }
  }

  #list(count) {
    this.#chunks = Array.from({ length: count }, (_, i) => this.#stream.chunk(i));
    this.#least = leastSoFar(this.#chunks);
  }

  #start(state) {
    this.#cursor = this.#stream.createCursor({ slack: this.#options.slack });
    this.#post({
      type: 'open',
      chunks: this.#chunks,
      groups: Array.from({ length: state.groupCount }, (_, i) => ({ material: this.#stream.group(i).material })),
      attributes: Array.from({ length: state.attributeCount }, (_, i) => this.#stream.attribute(i)),
      low: state.low,
      high: state.high,
    });
  }

  /** Moves the cursor towards what is wanted and posts what that changed; false where it stands there already. */
  async #move() {
    if (!this.#cursor) return false;
    const from = this.#cursor.level.position;
    const way = this.#cursor.choose(this.#deviation) - from;
    if (way === 0 && this.#told.chunksReady > 0) return false;
    await this.#show(from + Math.sign(way) * Math.min(Math.abs(way), MOST_RECORDS), this.#options.normals);
    return true;
  }

  /**
   * Posts where it stands, where no level has had that to say, since the one that is shown is what is wanted: who is to say what is
   * wanted next goes by it. False where there is no more to say.
   */
  async #tell() {
    if (!this.#cursor) return false;
    const { chunksReady, ended, settled } = this.#standing();
    if (settled === undefined) return true; // another has come to be wanted in the meantime
    if (this.#told.chunksReady === chunksReady && this.#told.ended === ended && this.#told.settled === settled) return false;
    await this.#show(this.#cursor.level.position, false);
    return true;
  }

  /** Goes to a level, and waits until what that changed has been dealt with. */
  async #show(position, withNormals) {
    const { update, transferred } = this.#update(this.#seek(this.#cursor.level.position, position), withNormals);
    this.#told = this.#standing();
    this.#post(Object.assign(update, this.#told), transferred);
    await this.#acknowledged.wait();
  }

  /** Returns what wedges come from on the way, where that was asked for: the finer level's say so. */
  #seek(from, to) {
    const wants = this.#options.morph;
    const gone = wants && to < from ? this.#cursor.origins(to) : null;
    this.#cursor.seek(to);
    return wants && to > from ? this.#cursor.origins(from) : gone;
  }

  #update(morph, withNormals) {
    const cursor = this.#cursor;
    const stream = this.#stream;
    const state = stream.state;
    const { begin, end } = cursor.newWedges();
    const update = {
      type: 'update',
      level: cursor.level,
      wedges: { begin, end, positions: cursor.positions(begin, end), attributes: [] },
      moved: cursor
        .movedWedges()
        .filter((range) => range.begin < begin)
        .map((range) => ({ begin: range.begin, positions: cursor.positions(range.begin, Math.min(range.end, begin)) })),
      groups: [],
      normals: withNormals ? cursor.normals() : null,
      morph,
      low: state.low,
      high: state.high,
      bytes: state.dueBegin,
    };
    for (let i = 0; i < state.attributeCount; ++i) update.wedges.attributes.push(stream.attributeValues(i, begin, end));
    for (let group = 0; group < state.groupCount; ++group) {
      const ranges = cursor.changes(group);
      const corners = cursor.corners(group);
      update.groups.push({
        count: corners.length,
        ranges: ranges.map((range) => ({ begin: range.begin, corners: corners.slice(range.begin, range.end) })),
      });
    }
    const arrays = [update.wedges.positions, ...update.wedges.attributes, ...update.moved.map(({ positions }) => positions), ...update.groups.flatMap(({ ranges }) => ranges.map(({ corners }) => corners))];
    if (update.normals) arrays.push(update.normals);
    if (morph) arrays.push(morph.origins);
    return { update, transferred: arrays.map(({ buffer }) => buffer) };
  }
}
