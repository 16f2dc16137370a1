'use strict';
// Two charts as SVG, drawn for the width they have.

const SVG = 'http://www.w3.org/2000/svg';

function svg(name, attributes = {}, text) {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (text !== undefined) element.textContent = text;
  return element;
}

/** A number with so many significant digits, and an exponent only where there is no other way. */
function number(value, digits = 3) {
  if (value === null || !Number.isFinite(value)) return '∞';
  if (value === 0) return '0';
  const size = Math.abs(value);
  if (size >= 1e6 || size < 1e-5) return value.toExponential(digits - 1).replace('e+', 'e').replace('e-', 'e−');
  const places = Math.max(0, digits - 1 - Math.floor(Math.log10(size)));
  return value.toLocaleString('en', { maximumFractionDigits: Math.min(places, 12) });
}

const percent = (share, digits = 3) => `${number(100 * share, digits)}\u00a0%`;

/** Round numbers from 0 to `upper`, about `count`. */
function ticks(upper, count) {
  const rough = upper / count, power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].find((m) => m * power >= rough) * power;
  return Array.from({ length: Math.floor(upper / step + 1e-9) + 1 }, (_, i) => i * step);
}

/** The powers of ten in a range, and 2 and 5 times them where there is room. */
function logTicks(low, high, most) {
  for (const factors of [[1, 2, 5], [1]]) {
    const out = [];
    for (let e = Math.floor(Math.log10(low)); e <= Math.ceil(Math.log10(high)); ++e)
      for (const factor of factors) if (factor * 10 ** e >= low * 0.999 && factor * 10 ** e <= high * 1.001) out.push(factor * 10 ** e);
    if (out.length <= most || factors.length === 1) return out;
  }
  return [];
}

/** Returns an empty drawing as wide as its place; text in it keeps its size. */
function canvasOf(place, height, label) {
  const width = Math.max(place.clientWidth, 240);
  const root = svg('svg', { viewBox: `0 0 ${width} ${height}`, height, role: 'img', 'aria-label': label });
  place.replaceChildren(root);
  return { root, width, add: (...args) => root.appendChild(svg(...args)) };
}

/** Shares of the area by error, from 0 to `upper`; the colours below the bars are those of the picture. */
function drawHistogram(place, { bins, max }, upper, diagonal, colourAt) {
  const barCount = 48, bars = new Array(barCount + 1).fill(0);
  bins.forEach((share, i) => {
    // Bins are finer towards 0; each is spread over the bars that it covers.
    const low = max * (i / bins.length) ** 2, high = max * ((i + 1) / bins.length) ** 2;
    const first = low / upper * barCount, last = high / upper * barCount;
    for (let b = Math.floor(first); b < last; ++b) {
      const part = (Math.min(b + 1, last) - Math.max(b, first)) / (last - first);
      bars[Math.min(b, barCount)] += share * part;
      if (b >= barCount) {
        bars[barCount] += share * Math.max(0, (last - Math.max(b + 1, first)) / (last - first));
        break;
      }
    }
  });
  const beyond = bars[barCount], top = Math.max(...bars.slice(0, barCount), 1e-9);
  const left = 44, right = 14, height = 236, base = 168;
  const { width, add } = canvasOf(place, height,
    `Histogram: shares of the original’s area by error, from 0 to ${percent(upper / diagonal)} of the diagonal.`);
  const x = (error) => left + (width - left - right) * error / upper, y = (share) => base - (base - 10) * share / top;
  for (const share of ticks(top, 4)) {
    add('line', { class: 'grid', x1: left, x2: width - right, y1: y(share), y2: y(share) });
    add('text', { x: left - 6, y: y(share) + 4, 'text-anchor': 'end' }, percent(share, 2));
  }
  const step = (width - left - right) / barCount;
  for (let b = 0; b < barCount; ++b) {
    const bar = add('rect', { x: left + b * step, y: y(bars[b]), width: Math.max(step - 1, 1), height: base - y(bars[b]),
      fill: colourAt((b + 0.5) / barCount), stroke: 'var(--soft)', 'stroke-width': 0.5 });
    bar.appendChild(svg('title', {}, `${percent(bars[b])} of the area`));
    add('rect', { x: left + b * step, y: base + 5, width: step + 0.5, height: 13, fill: colourAt((b + 0.5) / barCount) });
  }
  add('line', { class: 'axis', x1: left, x2: width - right, y1: base, y2: base });
  if (beyond > 5e-5)
    add('text', { class: 'strong', x: width - right, y: 20, 'text-anchor': 'end' }, `${percent(beyond, 2)} of the area lies beyond →`);
  const count = width > 520 ? 6 : 4;
  const scale = (line, values, text) => values.forEach((error, i) => {
    const anchor = i === 0 ? 'start' : x(error) > width - 60 ? 'end' : 'middle';
    add('text', { class: line === 0 ? 'strong' : '', x: x(error), y: base + 34 + 17 * line, 'text-anchor': anchor }, text(error));
  });
  const shares = ticks(100 * upper / diagonal, count).map((p) => p / 100 * diagonal);
  for (const error of shares) add('line', { class: 'axis', x1: x(error), x2: x(error), y1: base + 18, y2: base + 22 });
  scale(0, shares, (error) => percent(error / diagonal));
  scale(1, shares, (error) => number(error));
  add('text', { x: left, y: base + 66 }, 'above: of the diagonal; below: in the file’s units');
}

const SERIES = [
  { name: 'maximum', colour: 'var(--second)', dash: '', marker: 'M-5,-4 L5,-4 L0,5 Z' },
  { name: 'rms', colour: 'var(--third)', dash: '7 3', marker: 'M-4,-4 h8 v8 h-8 Z' },
  { name: 'mean', colour: 'var(--accent)', dash: '2 3', marker: 'M-4.5,0 a4.5,4.5 0 1 0 9,0 a4.5,4.5 0 1 0 -9,0' },
];

/** `levels`: faces, maximum, rms, mean of each; `bounds`: pairs of faces and what the stream proves. */
function drawCurve(place, levels, bounds, diagonal, shown) {
  const faces = [...levels.map((level) => level.faces), ...bounds.map(([count]) => count)].filter((count) => count > 0);
  const errors = [...levels.flatMap((level) => SERIES.map(({ name }) => level[name])), ...bounds.map(([, error]) => error)]
    .filter((error) => error > 0 && Number.isFinite(error)).map((error) => error / diagonal);
  const drawable = levels.filter((level) => level.faces > 0 && level.maximum > 0);
  const lowError = Math.max(Math.min(...drawable.flatMap((l) => SERIES.map(({ name }) => l[name] / diagonal)).filter((e) => e > 0),
    Math.max(...errors)) / 4, Math.min(...errors));
  const range = { x: [Math.min(...faces) / 1.1, Math.max(...faces) * 1.1], y: [lowError / 1.2, Math.max(...errors) * 1.4] };
  const left = 66, right = 14, base = 280, top = 52;
  const { root, width, add } = canvasOf(place, 322, 'Error against faces, both on logarithmic axes; the table has the numbers.');
  const along = (value, [low, high]) => Math.log(value / low) / Math.log(high / low);
  const x = (count) => left + (width - left - right) * along(count, range.x);
  const y = (share) => base - (base - top) * along(share, range.y);
  for (const share of logTicks(...range.y, 9)) {
    add('line', { class: 'grid', x1: left, x2: width - right, y1: y(share), y2: y(share) });
    add('text', { x: left - 6, y: y(share) + 4, 'text-anchor': 'end' }, percent(share, 2));
  }
  for (const count of logTicks(...range.x, width / 70)) {
    add('line', { class: 'grid', x1: x(count), x2: x(count), y1: top, y2: base });
    add('text', { x: x(count), y: base + 17, 'text-anchor': 'middle' }, number(count));
  }
  add('line', { class: 'axis', x1: left, x2: width - right, y1: base, y2: base });
  add('text', { x: width - right, y: base + 36, 'text-anchor': 'end' }, 'faces');
  if (shown > 0 && levels[shown].faces > 0)
    add('line', { x1: x(levels[shown].faces), x2: x(levels[shown].faces), y1: top, y2: base, stroke: 'var(--soft)',
      'stroke-dasharray': '1 3', 'stroke-width': 2 });
  const clip = svg('clipPath', { id: 'curve-clip' });
  clip.appendChild(svg('rect', { x: left, y: top - 6, width: width - left - right, height: base - top + 6 }));
  root.appendChild(clip);
  const line = bounds.map(([count, error]) => `${x(count).toFixed(1)},${y(error / diagonal).toFixed(1)}`).join(' ');
  add('polyline', { points: line, fill: 'none', stroke: 'var(--soft)', 'stroke-width': 1.5, 'clip-path': 'url(#curve-clip)' });
  for (const { name, colour, dash, marker } of SERIES) {
    const points = levels.filter((level) => level.faces > 0 && level[name] > 0).map((level) => [x(level.faces), y(level[name] / diagonal)]);
    add('polyline', { points: points.map((p) => p.join(',')).join(' '), fill: 'none', stroke: colour, 'stroke-width': 2, 'stroke-dasharray': dash });
    for (const [px, py] of points) add('path', { d: marker, transform: `translate(${px},${py})`, fill: colour });
  }
  let at = 2, row = 10;
  const legend = [...SERIES, ...(line ? [{ name: 'stream’s bound', colour: 'var(--soft)', dash: '' }] : [])];
  for (const { name, colour, dash, marker } of legend) {
    const label = svg('text', { class: 'strong' }, name);
    root.append(label);
    const length = 29 + label.getComputedTextLength();
    if (at + length > width) [at, row] = [2, row + 18];
    label.setAttribute('x', at + 29);
    label.setAttribute('y', row + 4);
    add('line', { x1: at, x2: at + 24, y1: row, y2: row, stroke: colour, 'stroke-width': 2, 'stroke-dasharray': dash });
    if (marker) add('path', { d: marker, transform: `translate(${at + 12},${row})`, fill: colour });
    at += length + 14;
  }
}
