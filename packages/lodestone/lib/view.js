// How large things are in a picture: of meshes that stand in one place, in many, or are moved by bones. Matrices are 16
// numbers, column by column, as three.js and Babylon.js have them; points are three.

/** How much what is wanted must change before it is said again. */
export const STEP = 1.05;

/** Returns, by chunk, the least deviation of the levels that it and those before it lead to: not each is finer than all before it. */
export function leastSoFar(chunks) {
  let least = Infinity;
  return chunks.map(({ deviation }) => {
    least = Math.min(least, deviation);
    return least;
  });
}

/** How much a matrix, whose numbers begin at `at`, lengthens along an axis at most. */
export function stretchOf(matrix, at = 0) {
  const square = (i) => matrix[at + i] ** 2 + matrix[at + i + 1] ** 2 + matrix[at + i + 2] ** 2;
  return Math.sqrt(Math.max(square(0), square(4), square(8)));
}

/** Returns where a matrix moves a point. */
export function transformed(matrix, [x, y, z], at = 0) {
  return [0, 1, 2].map((row) => matrix[at + row] * x + matrix[at + 4 + row] * y + matrix[at + 8 + row] * z + matrix[at + 12 + row]);
}

/** Returns the matrix that does what the second does, then the first. */
function multiplied(first, second, at = 0) {
  const result = new Float64Array(16);
  for (let column = 0; column < 4; ++column)
    for (let row = 0; row < 4; ++row)
      for (let i = 0; i < 4; ++i) result[4 * column + row] += first[4 * i + row] * second[at + 4 * column + i];
  return result;
}

const IDENTITY = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

const distance = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);

/**
 * How many pixels a unit of the world covers at a sphere's nearest point: see pixels_per_unit in detail_choice.h. A view is
 * { scale, isOrthographic, height, eye, near }: its projection's fifth number, whether it has no vanishing point, the pixels of
 * the picture's height, where it is seen from, and how far from there whatever is drawn lies at least.
 */
export function pixelsAt({ scale, isOrthographic, height, eye, near }, { center, radius }) {
  if (isOrthographic) return (height * scale) / 2;
  const away = Math.max(distance(eye, center) - radius, near);
  return away > 0 ? (height * scale) / (2 * away) : Infinity;
}

/** How many pixels a unit of a mesh covers at most that lies in a sphere and is shown through a matrix. */
export function pixelsThrough(view, matrix, { center, radius }, at = 0) {
  const stretch = stretchOf(matrix, at);
  return stretch === 0 ? 0 : stretch * pixelsAt(view, { center: transformed(matrix, center, at), radius: radius * stretch });
}

/** The same of a mesh that is shown at `count` places, by matrices that follow each other, of what `matrix` then moves. */
export function pixelsOfInstances(view, matrix, instances, count, { center, radius }) {
  const whole = stretchOf(matrix);
  let most = 0;
  for (let at = 0; at < 16 * count; at += 16) {
    const stretch = whole * stretchOf(instances, at);
    if (stretch === 0) continue;
    const place = transformed(matrix, transformed(instances, center, at));
    most = Math.max(most, stretch * pixelsAt(view, { center: place, radius: radius * stretch }));
  }
  return most;
}

/** Where the vertices lie that each bone moves, before it moves them. */
export class BoneBoxes {
  #boxes = []; // by bone: low and high, or undefined

  /** Takes vertices: three numbers each of `positions`, as many of `joints` as of `weights`, four each. */
  add(positions, joints, weights) {
    for (let i = 0; i < weights.length; ++i) {
      if (weights[i] === 0) continue;
      const box = (this.#boxes[joints[i]] ??= [Infinity, Infinity, Infinity, -Infinity, -Infinity, -Infinity]);
      for (let axis = 0, at = 3 * (i >> 2); axis < 3; ++axis) {
        box[axis] = Math.min(box[axis], positions[at + axis]);
        box[3 + axis] = Math.max(box[3 + axis], positions[at + axis]);
      }
    }
  }

  get isEmpty() {
    return this.#boxes.length === 0;
  }

  /**
   * How many pixels a unit of the mesh covers at most: `bind` moves it, then its bones, whose matrices follow each other, then
   * `matrix`. A vertex is between where its bones move it, so that a sphere around all of that has it; `margin` is how far
   * others may lie outside of the boxes.
   */
  pixels(view, matrix, matrices, margin = 0, bind = IDENTITY) {
    let stretch = 0;
    const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
    const most = matrices.length / 16;
    this.#boxes.forEach((box, bone) => {
      if (bone >= most) return;
      const whole = multiplied(multiplied(matrix, matrices, 16 * bone), bind);
      const own = stretchOf(whole);
      stretch = Math.max(stretch, own);
      const center = transformed(whole, [0, 1, 2].map((axis) => (box[axis] + box[3 + axis]) / 2));
      const reach = [0, 1, 2].map((row) => [0, 1, 2].reduce(
        (sum, axis) => sum + (Math.abs(whole[4 * axis + row]) * (box[3 + axis] - box[axis])) / 2, own * margin));
      for (let axis = 0; axis < 3; ++axis) {
        low[axis] = Math.min(low[axis], center[axis] - reach[axis]);
        high[axis] = Math.max(high[axis], center[axis] + reach[axis]);
      }
    });
    if (stretch === 0) return 0;
    return stretch * pixelsAt(view, { center: low.map((value, axis) => (value + high[axis]) / 2), radius: distance(low, high) / 2 });
  }
}
