// The structural similarity of two pictures, after Wang, Bovik, Sheikh and Simoncelli, "Image quality assessment: from
// error visibility to structural similarity" (2004). Departures: square windows without weights, every other position,
// and only windows with something of the object in either picture, so that a small object counts as much as a large one.

const side = 8;
const stride = 2;
const c1 = (0.01 * 255) ** 2;
const c2 = (0.03 * 255) ** 2;

function luminance(rgba) {
  return Float64Array.from({ length: rgba.length / 4 }, (_, i) =>
    0.299 * rgba[4 * i] + 0.587 * rgba[4 * i + 1] + 0.114 * rgba[4 * i + 2]);
}

/** The similarity of one window, or undefined where both show nothing but background. */
function windowSimilarity(a, b, covered, width, left, top) {
  let n = 0, sumA = 0, sumB = 0, sumAA = 0, sumBB = 0, sumAB = 0;
  for (let y = top; y < top + side; ++y) {
    for (let i = y * width + left; i < y * width + left + side; ++i) {
      n += covered[i];
      sumA += a[i];
      sumB += b[i];
      sumAA += a[i] * a[i];
      sumBB += b[i] * b[i];
      sumAB += a[i] * b[i];
    }
  }
  if (n === 0) return undefined;
  const area = side * side;
  const meanA = sumA / area, meanB = sumB / area;
  const varianceA = sumAA / area - meanA * meanA, varianceB = sumBB / area - meanB * meanB;
  const covariance = sumAB / area - meanA * meanB;
  return ((2 * meanA * meanB + c1) * (2 * covariance + c2)) /
    ((meanA * meanA + meanB * meanB + c1) * (varianceA + varianceB + c2));
}

/** Returns the mean similarity over the object, at most 1; a picture has `rgba`, and `covered`: 1 where the object is. */
export function similarity(first, second, width, height) {
  const a = luminance(first.rgba), b = luminance(second.rgba);
  const covered = first.covered.map((value, i) => value | second.covered[i]);
  let sum = 0, count = 0;
  for (let top = 0; top + side <= height; top += stride) {
    for (let left = 0; left + side <= width; left += stride) {
      const value = windowSimilarity(a, b, covered, width, left, top);
      if (value === undefined) continue;
      sum += value;
      ++count;
    }
  }
  return count === 0 ? 1 : sum / count;
}

const MARGIN = 3; // pixels: as near to its outline a coarse level need not cover what the whole does

/** How many pixels the first picture covers, well within its outline, and the second does not: where a crack shows the background. */
export function holesIn(whole, shown, width, height) {
  const isWithin = (x, y) => {
    for (let dy = -MARGIN; dy <= MARGIN; ++dy)
      for (let dx = -MARGIN; dx <= MARGIN; ++dx) if (!whole.covered[(y + dy) * width + x + dx]) return false;
    return true;
  };
  let holes = 0;
  for (let y = MARGIN; y < height - MARGIN; ++y)
    for (let x = MARGIN; x < width - MARGIN; ++x) if (!shown.covered[y * width + x] && isWithin(x, y)) ++holes;
  return holes;
}
