// The picture of error against bytes: a line for each model, as it came.
const [WIDTH, HEIGHT] = [300, 170];
const [LEFT, RIGHT, TOP, BOTTOM] = [44, 8, 8, 22];
const DECADES = 6;

const svg = (name, attributes, text) => {
  const element = document.createElementNS('http://www.w3.org/2000/svg', name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (text !== undefined) element.textContent = text;
  return element;
};

/** A number of bytes in words. */
export function bytesText(bytes) {
  if (bytes < 1000) return `${bytes} B`;
  return bytes < 1e6 ? `${(bytes / 1e3).toFixed(bytes < 1e4 ? 1 : 0)} kB` : `${(bytes / 1e6).toFixed(1)} MB`;
}

/** A share in words. */
export function shareText(share) {
  if (share === 0) return '0';
  return share < 1e-5 ? `${(100 * share).toExponential(0)} %` : `${Number((100 * share).toPrecision(2))} %`;
}

/** Draws it: of each model its colour, what has come, what its file says is to come, and what is shown. */
export function drawCurve(root, models) {
  const known = models.filter(({ history }) => history.length > 0);
  const mostBytes = Math.max(1000, ...known.map(({ total, bytes }) => total?.bytes ?? bytes));
  const mostError = 10 ** Math.ceil(Math.log10(Math.max(1e-3, ...known.flatMap(({ history }) => history.map(({ error }) => error).filter(Number.isFinite)))));
  const leastError = mostError / 10 ** DECADES;
  const x = (bytes) => LEFT + ((WIDTH - LEFT - RIGHT) * Math.min(bytes, mostBytes)) / mostBytes;
  const y = (error) => {
    const share = Math.log10(Math.max(Math.min(error, mostError), leastError) / leastError) / DECADES;
    return HEIGHT - BOTTOM - share * (HEIGHT - TOP - BOTTOM);
  };
  const parts = [svg('path', { class: 'axis', d: `M${LEFT} ${TOP} V${HEIGHT - BOTTOM} H${WIDTH - RIGHT}` })];
  for (let decade = 0; decade <= DECADES; decade += 2) {
    const error = decade === DECADES ? 0 : mostError / 10 ** decade;
    parts.push(svg('text', { x: LEFT - 4, y: y(error) + 3, 'text-anchor': 'end' }, shareText(error)));
  }
  for (const share of [0, 0.5, 1])
    parts.push(svg('text', { x: x(share * mostBytes), y: HEIGHT - 6, 'text-anchor': ['start', 'middle', 'end'][2 * share] }, bytesText(Math.round(share * mostBytes))));
  const stairs = (points) => points.map(({ bytes: at, error }, i) => (i === 0 ? `M${x(at)} ${y(error)}` : `H${x(at)} V${y(error)}`)).join(' ');
  for (const { history, coming, colour, bytes, shown } of known) {
    const line = { fill: 'none', stroke: colour, 'stroke-width': 2, 'stroke-linejoin': 'round' };
    parts.push(svg('path', { ...line, d: stairs(history) }));
    parts.push(svg('path', { ...line, class: 'coming', d: stairs([history.at(-1), ...coming]) }));
    parts.push(svg('circle', { cx: x(bytes), cy: y(shown), r: 4, fill: 'none', stroke: colour, 'stroke-width': 2 }));
  }
  root.setAttribute('viewBox', `0 0 ${WIDTH} ${HEIGHT}`);
  root.replaceChildren(...parts);
}
