// A static server on this machine only: the clients, the pages and the files under test, with byte ranges.
import { createReadStream } from 'node:fs';
import { stat } from 'node:fs/promises';
import { createServer } from 'node:http';
import { extname, join, normalize, sep } from 'node:path';

const TYPES = {
  '.html': 'text/html',
  '.css': 'text/css',
  '.js': 'text/javascript',
  '.mjs': 'text/javascript',
  '.wasm': 'application/wasm',
  '.glb': 'model/gltf-binary',
  '.gltf': 'model/gltf+json',
  '.png': 'image/png',
};

/** Returns the file a URL names, or undefined; `mounts` maps the first part of the path to a folder. */
function locate(url, mounts) {
  const [, mount, ...rest] = decodeURIComponent(new URL(url, 'http://localhost').pathname).split('/');
  const root = mounts[mount];
  if (!root) return undefined;
  const path = normalize(join(root, ...rest));
  return path.startsWith(root + sep) ? path : undefined;
}

/** Returns the first and last byte a Range header asks for, or undefined for the whole file. */
function parseRange(header, size) {
  const match = /^bytes=(\d+)-(\d*)$/.exec(header ?? '');
  if (!match) return undefined;
  const first = Number(match[1]);
  const last = match[2] === '' ? size - 1 : Math.min(Number(match[2]), size - 1);
  return first <= last ? { first, last } : undefined;
}

async function respond(request, response, mounts, ranges) {
  const path = locate(request.url, mounts);
  const info = path && (await stat(path).catch(() => undefined));
  if (!info?.isFile()) {
    response.writeHead(404).end();
    return;
  }
  const range = parseRange(request.headers.range, info.size);
  const { first, last } = range ?? { first: 0, last: info.size - 1 };
  if (range) ranges.push({ path, first, last });
  response.writeHead(range ? 206 : 200, {
    'content-type': TYPES[extname(path)] ?? 'application/octet-stream',
    'content-length': last - first + 1,
    'accept-ranges': 'bytes',
    ...(range && { 'content-range': `bytes ${first}-${last}/${info.size}` }),
  });
  createReadStream(path, { start: first, end: last }).pipe(response);
}

/** Starts the server; returns its address, the ranges that were asked for so far, and a function that stops it. */
export async function serve(mounts) {
  const ranges = [];
  const server = createServer((request, response) => {
    respond(request, response, mounts, ranges).catch(() => response.destroy());
  });
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  return {
    ranges,
    address: `http://127.0.0.1:${server.address().port}`,
    close: () => new Promise((resolve) => {
      server.close(resolve);
      server.closeAllConnections();
    }),
  };
}
