'use strict';
// Reads what page_geometry.cpp writes; the format is described there.

/** Returns the bytes of one of the page's scripts: base64 of deflated data. */
async function readBlob(id) {
  const text = atob(document.getElementById(id).textContent);
  const packed = Uint8Array.from(text, (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Undoes the coding: returns grid positions (three a vertex) and faces (three vertices each). */
function decodeGeometry(bytes) {
  const header = new DataView(bytes.buffer, bytes.byteOffset, 12);
  const vertexCount = header.getUint32(0, true), faceCount = header.getUint32(4, true);
  const planes = 12 + header.getUint32(8, true);
  const positions = new Uint16Array(3 * vertexCount), faces = new Uint32Array(3 * faceCount);
  const taken = new Set(), open = [];
  const edge = (from, to) => from * vertexCount + to;
  let at = 12, known = 0, done = 0;

  const symbol = () => {
    let value = 0;
    for (let scale = 1; ; scale *= 128) {
      const byte = bytes[at++];
      value += (byte & 127) * scale;
      if (byte < 128) return value;
    }
  };
  const vertex = (code, guess) => {
    if (code > 0) return known + 1 - code;
    for (let i = 0; i < 3; ++i) {
      const zigzag = bytes[planes + i * vertexCount + known] | bytes[planes + (3 + i) * vertexCount + known] << 8;
      positions[3 * known + i] = guess(i) + (zigzag & 1 ? -(zigzag + 1) / 2 : zigzag / 2);
    }
    return known++;
  };
  const face = (a, b, c) => {
    faces.set([a, b, c], 3 * done++);
    taken.add(edge(a, b)).add(edge(b, c)).add(edge(c, a));
  };
  const last = (i) => (known > 0 ? positions[3 * (known - 1) + i] : 0);
  const clamp = (x) => Math.min(Math.max(x, 0), 65535);

  while (done < faceCount || open.length > 0) {
    if (open.length === 0) {
      const a = vertex(symbol(), last), b = vertex(symbol(), last), c = vertex(symbol(), last);
      face(a, b, c);
      open.push([a, b, c], [b, c, a], [c, a, b]);
      continue;
    }
    const [from, to, third] = open.pop();
    if (taken.has(edge(to, from))) continue;
    const code = symbol();
    if (code === 1) continue;
    const apex = vertex(code, (i) => clamp(positions[3 * from + i] + positions[3 * to + i] - positions[3 * third + i]));
    face(to, from, apex);
    open.push([apex, to, from], [from, apex, to]);
  }
  return { positions, faces };
}

/** Undoes the differences: a byte for each vertex, 255 · √(error / maximum). */
function decodeErrors(bytes) {
  for (let i = 1; i < bytes.length; ++i) bytes[i] += bytes[i - 1];
  return bytes;
}

/** Returns a unit normal for each corner, three signed bytes and a filler: smooth, but not over edges sharper than 40°. */
function cornerNormals({ positions, faces }, size) {
  const faceCount = faces.length / 3, normals = new Float32Array(faces.length), areas = new Float32Array(faceCount);
  const point = (v, i) => positions[3 * v + i] * size[i];
  for (let f = 0; f < faceCount; ++f) {
    const [a, b, c] = faces.subarray(3 * f, 3 * f + 3);
    const u = [0, 1, 2].map((i) => point(b, i) - point(a, i)), w = [0, 1, 2].map((i) => point(c, i) - point(a, i));
    const n = [u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2], u[0] * w[1] - u[1] * w[0]];
    areas[f] = Math.hypot(...n);
    for (let i = 0; i < 3; ++i) normals[3 * f + i] = areas[f] > 0 ? n[i] / areas[f] : 0;
  }
  const begin = new Uint32Array(positions.length / 3 + 1), around = new Uint32Array(faces.length);
  for (const v of faces) ++begin[v + 1];
  for (let v = 1; v < begin.length; ++v) begin[v] += begin[v - 1];
  const next = begin.slice();
  for (let corner = 0; corner < faces.length; ++corner) around[next[faces[corner]]++] = Math.floor(corner / 3);
  const out = new Int8Array(4 * faces.length), limit = Math.cos(40 * Math.PI / 180);
  for (let corner = 0; corner < faces.length; ++corner) {
    const own = 3 * Math.floor(corner / 3), v = faces[corner];
    let x = 0, y = 0, z = 0;
    for (let k = begin[v]; k < begin[v + 1]; ++k) {
      const f = 3 * around[k];
      const cosine = normals[own] * normals[f] + normals[own + 1] * normals[f + 1] + normals[own + 2] * normals[f + 2];
      if (cosine < limit && f !== own) continue;
      const area = areas[around[k]];
      x += normals[f] * area; y += normals[f + 1] * area; z += normals[f + 2] * area;
    }
    const length = Math.hypot(x, y, z) || 1;
    out.set([127 * x / length, 127 * y / length, 127 * z / length], 4 * corner);
  }
  return out;
}
