'use strict';
// Puts the page together. `numbers.kind` is `compare`, with the JSON of `lodestone compare --json` as `comparison`, or
// `build`, with the JSON of `lodestone build --report` as `report`. All text from files is set as text, never as HTML.

const page = JSON.parse(document.getElementById('data').textContent);
const { numbers, pictures, diagonal } = page;
const isBuild = numbers.kind === 'build';
const get = (id) => document.getElementById(id);

function make(name, properties = {}, ...children) {
  const element = Object.assign(document.createElement(name), properties);
  element.append(...children);
  return element;
}

const whole = (count) => count.toLocaleString('en');
const withUnits = (length) => `${percent(length / diagonal)} of the diagonal (${number(length)} units)`;

/** One entry for each surface: the original first. */
const levels = isBuild
  ? numbers.report.levels.map((level, i) => ({
    name: i === 0 ? 'Original' : `Level ${i}`, faces: level.faces, vertices: level.vertices, bytes: level.bytes,
    deviation: i === 0 ? null : level.deviation, bound: level.deviation_bound,
  }))
  : ['a', 'b'].map((key, i) => ({
    name: numbers.comparison[key].path.split(/[\\/]/).pop(), faces: numbers.comparison[key].faces,
    vertices: numbers.comparison[key].vertices, bytes: numbers.bytes[i], deviation: i === 0 ? null : numbers.comparison.deviation,
  }));

const finite = (value) => value ?? Infinity; // JSON has no infinity: a level without faces is that far away
const both = (deviation, name) => Math.max(finite(deviation.forward[name]), finite(deviation.backward[name]));
const tagOf = (level) => [make('strong', { textContent: level.name }), ` · ${whole(level.faces)} faces`];

const state = { left: 0, right: Math.min(levels.length - 1, isBuild ? 2 : 1), upper: null };
let viewer = null;
const loaded = new Map();

/** Which original-to-level errors the view is about: those of the other pane's level, or of the coarser one. */
function comparedLevel() {
  return state.left === 0 ? state.right : state.right === 0 ? state.left : Math.max(state.left, state.right);
}

function spreadOf(level) {
  return level > 0 ? pictures[level].errors : null;
}

async function picture(index) {
  if (!loaded.has(index)) {
    loaded.set(index, (async () => {
      const { data, errors } = pictures[index];
      return {
        mesh: viewer.upload(decodeGeometry(await readBlob(data))),
        errors: errors ? decodeErrors(await readBlob(errors.data)) : null,
      };
    })());
  }
  return loaded.get(index);
}

function upperShare() {
  return 10 ** (Number(get('upper').value) / 50 - 2);
}

function upperError() {
  const spread = spreadOf(comparedLevel());
  return state.upper ?? spread.max * upperShare();
}

/** By default the darkest colour stands for what 99 % of the area do not reach: single peaks shall not pale the rest. */
function chooseUpper() {
  const spread = spreadOf(comparedLevel());
  if (!spread || !(spread.max > 0)) return;
  const share = state.upper !== null && get('keep').checked ? state.upper / spread.max : (spread.p99 || spread.max) / spread.max;
  if (!get('keep').checked) state.upper = null;
  get('upper').value = Math.min(Math.max(Math.ceil(50 * (Math.log10(share) + 2)), 0), 100);
}

async function showPanes() {
  if (!viewer) return;
  try {
    const compared = comparedLevel(), spread = spreadOf(compared);
    const wanted = [await picture(state.left), await picture(state.right)];
    const errors = spread && get('coloured').checked && spread.max > 0 ? (await picture(compared)).errors : null;
    const upper = errors ? upperError() / spread.max : 0;
    // The legend stands in the pane that has the colours, in the upper or left one where that is both.
    get('ramp').hidden = !errors || (state.left !== 0 && state.right !== 0);
    get('ramp').className = state.left === 0 ? '' : 'second';
    if (errors) {
      get('ramp-end').textContent = percent(upper * spread.max / diagonal);
      get('ramp-units').textContent = `· ${number(upper * spread.max)}`;
    }
    [state.left, state.right].forEach((level, pane) => viewer.show(pane, wanted[pane].mesh, level === 0 ? errors : null, upper));
    get('status').textContent = '';
    document.documentElement.dataset.ready = 'true';
  } catch (error) {
    get('status').textContent = `The surfaces cannot be drawn: ${error.message}.`;
  }
}

function colourAt(share) {
  const last = page.colours.length - 1, at = Math.min(Math.max(share, 0), 1) * last, k = Math.min(Math.floor(at), last - 1);
  const [a, b] = [rgbOf(page.colours[k]), rgbOf(page.colours[k + 1])];
  return `rgb(${a.map((x, i) => Math.round(255 * (x + (b[i] - x) * (at - k)))).join(' ')})`;
}

function showCharts() {
  get('curve-figure').hidden = !isBuild || levels.length < 2;
  const compared = comparedLevel(), spread = spreadOf(compared);
  const empty = !spread || !(spread.max > 0);
  get('upper').disabled = empty;
  if (empty) {
    get('histogram').replaceChildren();
    get('spread-text').textContent = spread ? 'No point of the original is away from the level.' : 'Choose two different levels.';
    get('upper-text').textContent = '';
  } else {
    const upper = upperError();
    get('spread-text').textContent = `How far the original is from ${levels[compared].name}, over its area. Half of it lies `
      + `within ${percent(spread.p50 / diagonal)} of the diagonal, 90 % within ${percent(spread.p90 / diagonal)}, 99 % within `
      + `${percent(spread.p99 / diagonal)}. The colours are measured at the original’s vertices and blended in between.`;
    get('upper-text').textContent = `${percent(upper / diagonal)} · ${number(upper)}`;
    drawHistogram(get('histogram'), spread, upper, diagonal, colourAt);
  }
  if (!isBuild || levels.length < 2) return;
  const points = levels.map(({ faces, deviation }) => (deviation
    ? { faces, maximum: both(deviation, 'max'), rms: both(deviation, 'rms'), mean: both(deviation, 'mean') }
    : { faces, maximum: 0, rms: 0, mean: 0 }));
  get('curve-text').textContent = 'Of each level, the larger of both directions, in % of the diagonal'
    + (numbers.bounds.length > 0 ? '; and the faces that the removal stream needs to keep to an error, as it can prove.' : '.')
    + ' The original has no error and is not on the chart.';
  if (points.some(({ maximum }) => maximum > 0)) drawCurve(get('curve'), points, numbers.bounds, diagonal, compared);
}

function cell(length) {
  return length === null ? make('td', { textContent: '∞' }) : make('td', {}, percent(length / diagonal), make('small', { textContent: number(length) }));
}

function showTable() {
  const compared = comparedLevel();
  const title = (text, span, first) => make('th', { textContent: text, scope: span > 1 ? 'colgroup' : 'col', colSpan: span,
    rowSpan: span > 1 ? 1 : 2, className: first ? 'begin' : '' });
  const parts = isBuild ? ['Original to level', 'Level to original'] : ['A to B', 'B to A'];
  const head = make('thead', {},
    make('tr', {}, title(isBuild ? 'Level' : 'Surface', 1), title('Faces', 1), title('Vertices', 1), title('Bytes', 1),
      title(parts[0], 3, true), title(parts[1], 3, true), title('Normals’ mean angle', 1, true),
      ...(isBuild ? [title('Bound of the stream', 1)] : [])),
    make('tr', {}, ...['max', 'mean', 'rms', 'max', 'mean', 'rms'].map((text, i) =>
      make('th', { textContent: text, scope: 'col', className: i % 3 === 0 ? 'begin' : '' }))));
  const body = make('tbody', {}, ...levels.map((level, i) => {
    const row = make('tr', { className: i > 0 && i === compared && levels.length > 2 ? 'shown' : '' });
    row.append(make('th', { scope: 'row', textContent: isBuild ? level.name : `${'AB'[i]}: ${level.name}` }));
    for (const count of [level.faces, level.vertices, level.bytes]) row.append(make('td', { textContent: whole(count) }));
    if (!level.deviation) {
      row.append(make('td', { colSpan: isBuild ? 8 : 7, className: 'left begin', textContent: 'what the others are measured against' }));
      return row;
    }
    for (const way of ['forward', 'backward'])
      for (const name of ['max', 'mean', 'rms']) row.append(cell(level.deviation[way][name]));
    row.children[4].className = row.children[7].className = 'begin';
    row.append(make('td', { className: 'begin', textContent: `${number(level.deviation.mean_normal_angle_degrees)}°` }));
    if (isBuild) row.append(cell(level.bound));
    return row;
  }));
  get('table').replaceChildren(head, body);
  get('table-text').textContent = `In % of the original’s bounding-box diagonal, ${number(diagonal, 5)} units; below, in the file’s units. `
    + (isBuild ? 'Bytes are those of the geometry in the file. ' + outputText() : 'Bytes are those of the files.');
}

function outputText() {
  const { output, stream } = numbers.report;
  return `Written: ${whole(output.bytes)} bytes` + (stream.bytes > 0 ? `, of which ${whole(stream.bytes)} are the removal stream.` : '.');
}

const unitOf = (name) => (name === 'NORMAL' ? '°' : name.startsWith('TEXCOORD') ? ' texture widths' : '');

function showAttributes() {
  const compared = comparedLevel();
  const parts = isBuild
    ? numbers.report.meshes.map(({ name, levels: own }) => ({ name: name || 'unnamed', attributes: own[compared].attributes }))
    : [{ name: '', attributes: numbers.attributes }];
  const rows = parts.flatMap(({ name, attributes }) => attributes.map((attribute) => ({ mesh: name, ...attribute })));
  get('attributes-section').hidden = rows.length === 0;
  const several = parts.length > 1;
  const titles = [...(several ? ['Mesh'] : []), 'Attribute', 'mean', 'rms', 'max'];
  get('attributes-heading').textContent = isBuild ? `Attributes of ${levels[compared].name}` : 'Attributes';
  get('attributes').replaceChildren(
    make('thead', {}, make('tr', {}, ...titles.map((text, i) => make('th', { scope: 'col', textContent: text, className: several && i < 2 ? 'left' : '' })))),
    make('tbody', {}, ...rows.map((row) => make('tr', {}, ...(several ? [make('th', { scope: 'row', textContent: row.mesh })] : []),
      several ? make('td', { className: 'left', textContent: row.name }) : make('th', { scope: 'row', textContent: row.name }),
      ...['mean', 'rms', 'max'].map((key) => make('td', { textContent: number(row[key]) + unitOf(row.name) }))))));
}

function showTexts() {
  const last = levels[isBuild ? comparedLevel() : 1];
  const canvas = get('canvas');
  canvas.setAttribute('aria-label', `${levels[state.left].name} and ${levels[state.right].name} side by side, one camera for both`);
  if (!last || !last.deviation) {
    get('summary').textContent = `${whole(levels[0].faces)} faces.`;
    return;
  }
  const { deviation } = last;
  get('summary').textContent = `${last.name} has ${whole(last.faces)} of ${whole(levels[0].faces)} faces. The surfaces are at most `
    + `${withUnits(both(deviation, 'max'))} apart, ${percent(both(deviation, 'mean') / diagonal)} on average; their normals `
    + `differ by ${number(deviation.mean_normal_angle_degrees)}° on average.`;
}

function showLimits() {
  const reduced = pictures.flatMap(({ faces, shown_faces: shown }, i) =>
    (shown < faces ? [`${levels[i].name} is drawn with ${whole(shown)} of its ${whole(faces)} faces`] : []));
  get('limits').hidden = reduced.length === 0;
  get('limits').textContent = `To keep this page small, ${reduced.join('; ')}. All numbers are of the whole surfaces.`;
}

/** Where there are more than two levels, each pane has a list to choose its own from. */
function makeTags() {
  for (const side of ['left', 'right']) {
    const place = get(`${side}-pane`);
    if (levels.length <= 2) {
      const level = levels[state[side]];
      place.replaceChildren(make('span', { className: 'tag' }, ...tagOf(level)));
      continue;
    }
    const select = make('select', { id: side, ariaLabel: `Surface on the ${side === 'left' ? 'left or top' : 'right or bottom'}` },
      ...levels.map((level, i) => make('option', { value: i, textContent: `${level.name} · ${whole(level.faces)} faces` })));
    select.value = state[side];
    select.addEventListener('change', () => {
      state[side] = Number(select.value);
      changeLevels();
    });
    place.replaceChildren(select);
  }
}

function changeLevels() {
  chooseUpper();
  showTexts();
  showCharts();
  showTable();
  showAttributes();
  return showPanes();
}

function stepLevel(by) {
  const select = get('right');
  if (!select) return;
  state.right = Math.min(Math.max(state.right + by, 0), levels.length - 1);
  select.value = state.right;
  changeLevels();
}

function listen() {
  const setSurface = (name) => {
    get('surface').value = name;
    if (!viewer) return;
    viewer.surface = name;
    viewer.redraw();
  };
  get('surface').addEventListener('change', () => setSurface(get('surface').value));
  get('up').addEventListener('change', () => {
    if (!viewer) return;
    viewer.camera.up = get('up').value;
    viewer.redraw();
  });
  get('coloured').addEventListener('change', showPanes);
  get('reset').addEventListener('click', () => {
    if (!viewer) return;
    viewer.camera.reset();
    viewer.redraw();
  });
  get('upper').addEventListener('input', () => {
    state.upper = spreadOf(comparedLevel()).max * upperShare();
    showCharts();
    showPanes();
  });
  get('keep').addEventListener('change', () => {
    if (get('keep').checked) state.upper = upperError();
    else changeLevels();
  });
  get('canvas').addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const key = event.key.toLowerCase();
    if (key === 's') setSurface(SURFACES[(SURFACES.indexOf(get('surface').value) + 1) % SURFACES.length]);
    else if (key === 'c') get('coloured').click();
    else if (key === '[') stepLevel(-1);
    else if (key === ']') stepLevel(1);
    else return;
    event.preventDefault();
  });
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => viewer?.redraw());
  let width = get('histogram').clientWidth;
  new ResizeObserver(() => {
    if (get('histogram').clientWidth === width) return;
    width = get('histogram').clientWidth;
    showCharts();
  }).observe(get('histogram'));
}

function start() {
  if (levels.length <= 2) get('level-help').hidden = get('keep-label').hidden = true;
  makeTags();
  document.querySelector('#ramp .colours').style.background = `linear-gradient(to right, ${page.colours.join(', ')})`;
  showLimits();
  try {
    if (typeof DecompressionStream === 'undefined') throw new Error('this browser cannot unpack it; a newer one can');
    viewer = new Viewer(get('canvas'), page.box, page.colours);
  } catch (error) {
    get('status').textContent = `The surfaces cannot be drawn: ${error.message}.`;
  }
  listen();
  changeLevels();
}

start();
