// Measures how far points lie from a surface, in a grid of cells.
const MOST_POINTS = 150_000; // of more, every so-manieth is measured
const MOST_CELLS = 96; // along an axis

/** Triangles by the cells of a grid that their boxes touch. */
class Grid {
  constructor(positions, corners) {
    this.positions = positions;
    this.corners = corners;
    const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
    for (const corner of corners)
      for (let axis = 0; axis < 3; ++axis) {
        low[axis] = Math.min(low[axis], positions[3 * corner + axis]);
        high[axis] = Math.max(high[axis], positions[3 * corner + axis]);
      }
    const longest = Math.max(...high.map((value, axis) => value - low[axis])) || 1;
    this.low = low;
    this.cell = longest / Math.min(MOST_CELLS, Math.max(4, Math.round(Math.cbrt(corners.length / 3) * 2)));
    this.size = high.map((value, axis) => Math.floor((value - low[axis]) / this.cell) + 1);
    this.cells = new Map();
    for (let at = 0; at < corners.length; at += 3) this.#add(at);
  }

  at(value, axis) {
    return Math.min(this.size[axis] - 1, Math.max(0, Math.floor((value - this.low[axis]) / this.cell)));
  }

  #add(at) {
    const range = [0, 1, 2].map((axis) => {
      const values = [0, 1, 2].map((i) => this.positions[3 * this.corners[at + i] + axis]);
      return [this.at(Math.min(...values), axis), this.at(Math.max(...values), axis)];
    });
    for (let z = range[2][0]; z <= range[2][1]; ++z)
      for (let y = range[1][0]; y <= range[1][1]; ++y)
        for (let x = range[0][0]; x <= range[0][1]; ++x) {
          const key = (z * this.size[1] + y) * this.size[0] + x;
          const cell = this.cells.get(key);
          if (cell) cell.push(at);
          else this.cells.set(key, [at]);
        }
  }

  /** The nearest triangle to a point, by the place of its first corner, and the square of its distance. */
  nearest(x, y, z) {
    const middle = [this.at(x, 0), this.at(y, 1), this.at(z, 2)];
    const most = Math.max(...this.size);
    const found = { at: -1, square: Infinity };
    // A triangle that is in no cell up to so many cells away lies at least as far, the point's own cell left out.
    for (let ring = 0; ring <= most && (found.at < 0 || found.square > ((ring - 1) * this.cell) ** 2); ++ring) this.#ring(middle, ring, x, y, z, found);
    return found;
  }

  #ring([mx, my, mz], ring, x, y, z, found) {
    const [sx, sy, sz] = this.size;
    for (let k = Math.max(0, mz - ring); k <= Math.min(sz - 1, mz + ring); ++k)
      for (let j = Math.max(0, my - ring); j <= Math.min(sy - 1, my + ring); ++j) {
        const isSide = Math.abs(k - mz) === ring || Math.abs(j - my) === ring;
        for (let i = mx - ring; i <= mx + ring; i += isSide || ring === 0 ? 1 : 2 * ring) {
          if (i < 0 || i >= sx) continue;
          for (const at of this.cells.get((k * sy + j) * sx + i) ?? []) {
            const square = this.#square(at, x, y, z);
            if (square < found.square) Object.assign(found, { at, square });
          }
        }
      }
  }

  /** The square of a point's distance from a triangle: by where it lies beside the corners, the edges or the inside. */
  #square(at, px, py, pz) {
    const p = this.positions;
    const [a, b, c] = [3 * this.corners[at], 3 * this.corners[at + 1], 3 * this.corners[at + 2]];
    const [ux, uy, uz] = [p[b] - p[a], p[b + 1] - p[a + 1], p[b + 2] - p[a + 2]];
    const [vx, vy, vz] = [p[c] - p[a], p[c + 1] - p[a + 1], p[c + 2] - p[a + 2]];
    const [wx, wy, wz] = [px - p[a], py - p[a + 1], pz - p[a + 2]];
    const uu = ux * ux + uy * uy + uz * uz;
    const uv = ux * vx + uy * vy + uz * vz;
    const vv = vx * vx + vy * vy + vz * vz;
    const uw = ux * wx + uy * wy + uz * wz;
    const vw = vx * wx + vy * wy + vz * wz;
    const away = (s, t) => (wx - s * ux - t * vx) ** 2 + (wy - s * uy - t * vy) ** 2 + (wz - s * uz - t * vz) ** 2;
    const unit = (value) => Math.min(1, Math.max(0, value));
    const area = uu * vv - uv * uv;
    if (area > 0) {
      const [s, t] = [(vv * uw - uv * vw) / area, (uu * vw - uv * uw) / area];
      if (s >= 0 && t >= 0 && s + t <= 1) return away(s, t);
    }
    const edge = uu - 2 * uv + vv; // of b and c
    const along = edge > 0 ? unit((uu - uv - uw + vw) / edge) : 0;
    return Math.min(away(uu > 0 ? unit(uw / uu) : 0, 0), away(0, vv > 0 ? unit(vw / vv) : 0), away(1 - along, along));
  }
}

self.onmessage = ({ data: { positions, corners, shown } }) => {
  const all = new Uint32Array(corners.reduce((sum, { length }) => sum + length, 0));
  let end = 0;
  for (const part of corners) {
    all.set(part, end);
    end += part.length;
  }
  const heat = new Float32Array(shown);
  const count = positions.length / 3;
  let worst = 0;
  if (end > 0 && count > shown) {
    const grid = new Grid(positions, all);
    const step = Math.ceil((count - shown) / MOST_POINTS);
    for (let i = shown; i < count; i += step) {
      const { at, square } = grid.nearest(positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]);
      const distance = Math.sqrt(square);
      worst = Math.max(worst, distance);
      for (let k = 0; k < 3; ++k) heat[all[at + k]] = Math.max(heat[all[at + k]], distance);
    }
  }
  self.postMessage({ heat, worst }, [heat.buffer]);
};
