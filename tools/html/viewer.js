'use strict';
// Draws two meshes with one camera, each in its half of a canvas.

const VERTEX_SHADER = `#version 300 es
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in float error;
uniform mat4 camera;
uniform mat4 turn;
uniform vec3 size;
uniform vec3 middle;
out vec3 seen;
out vec3 seenNormal;
out vec3 corner;
out float share;
void main() {
  vec4 world = vec4(position * size - middle, 1.0);
  gl_Position = camera * world;
  seen = (turn * world).xyz;
  seenNormal = (turn * vec4(normal, 0.0)).xyz;
  int k = gl_VertexID % 3;
  corner = vec3(k == 0, k == 1, k == 2);
  share = error * error;
}`;

const FRAGMENT_SHADER = `#version 300 es
precision highp float;
in vec3 seen;
in vec3 seenNormal;
in vec3 corner;
in float share;
uniform sampler2D colours;
uniform float upper;      // the share of the maximum that the darkest colour stands for; 0: not coloured
uniform vec3 plain;
uniform vec3 edgeColour;
uniform int surface;      // 0 smooth, 1 facets, 2 facets and edges, 3 edges only
out vec4 result;
void main() {
  vec3 facet = normalize(cross(dFdx(seen), dFdy(seen)));
  vec3 n = facet;
  if (surface == 0 && dot(seenNormal, seenNormal) > 0.01) {
    n = normalize(seenNormal);
    if (dot(n, facet) < 0.0) n = -n;
  }
  vec3 colour = upper > 0.0 ? texture(colours, vec2(min(share / upper, 1.0) * 0.99609375 + 0.001953125, 0.5)).rgb : plain;
  // Colours are to be read against their legend: they are shaded less.
  float lit = 0.85 * max(dot(n, normalize(vec3(-0.4, 0.55, 0.75))), 0.0) + 0.15 * max(n.z, 0.0);
  float light = upper > 0.0 ? 0.74 + 0.26 * lit : 0.5 + 0.52 * lit;
  if (!gl_FrontFacing) { colour = mix(colour, vec3(0.35, 0.45, 0.75), 0.35); light *= 0.7; }
  vec3 width = fwidth(corner);
  vec3 inside = smoothstep(width * 0.2, width * 0.95, corner);
  float line = 1.0 - min(min(inside.x, inside.y), inside.z);
  float dense = smoothstep(0.08, 0.45, max(max(width.x, width.y), width.z));
  if (surface == 3) {
    if (line < 0.35) discard;
    result = vec4(upper > 0.0 ? colour : mix(edgeColour, plain, 0.15), 1.0);
    return;
  }
  colour *= light;
  if (surface == 2) colour = mix(colour, edgeColour, line * mix(upper > 0.0 ? 0.45 : 0.6, 0.0, dense));
  result = vec4(colour, 1.0);
}`;

const FIELD_OF_VIEW = 30 * Math.PI / 180;
const SURFACES = ['smooth', 'facets', 'edges', 'wire'];

function multiply(a, b) {
  const out = new Float32Array(16);
  for (let column = 0; column < 4; ++column)
    for (let row = 0; row < 4; ++row)
      for (let k = 0; k < 4; ++k) out[4 * column + row] += a[4 * k + row] * b[4 * column + k];
  return out;
}

function rgbOf(hex) {
  return [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255);
}

/** Turns around a point: angles, distance and what the camera looks at. Pure numbers, no drawing. */
class Camera {
  /** Lengths are in diagonals of the box; `radius` is what has to be seen around its middle. */
  constructor() {
    this.radius = 0.5;
    this.up = 'y';
    this.reset();
  }

  reset() {
    Object.assign(this, { yaw: 0.5, pitch: 0.25, zoom: 1, target: [0, 0, 0] });
  }

  orbit(dx, dy) {
    this.yaw += dx;
    this.pitch = Math.min(Math.max(this.pitch + dy, -Math.PI / 2), Math.PI / 2);
  }

  zoomBy(factor) {
    this.zoom = Math.min(Math.max(this.zoom * factor, 0.2), 200);
  }

  /** Moves what is seen by shares of a pane's height. */
  pan(dx, dy) {
    const turn = this.turn(), height = 2 * this.distance(1) * Math.tan(FIELD_OF_VIEW / 2);
    for (let i = 0; i < 3; ++i) this.target[i] += (-dx * turn[4 * i] + dy * turn[4 * i + 1]) * height;
  }

  distance(aspect) {
    return 1.02 * this.radius / Math.sin(FIELD_OF_VIEW / 2) / this.zoom / Math.min(aspect, 1);
  }

  /** World to view directions, column by column. */
  turn() {
    const [cy, sy, cp, sp] = [Math.cos(this.yaw), Math.sin(this.yaw), Math.cos(this.pitch), Math.sin(this.pitch)];
    const turn = new Float32Array([cy, sp * sy, -cp * sy, 0, 0, cp, sp, 0, sy, -sp * cy, cp * cy, 0, 0, 0, 0, 1]);
    return this.up === 'z' ? multiply(turn, new Float32Array([1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1])) : turn;
  }

  matrices(aspect) {
    const distance = this.distance(aspect), turn = this.turn(), view = turn.slice();
    for (let row = 0; row < 3; ++row)
      view[12 + row] = -[0, 1, 2].reduce((sum, i) => sum + turn[4 * i + row] * this.target[i], 0);
    view[14] -= distance;
    const reach = 0.51 + Math.hypot(...this.target); // half a diagonal: nothing lies farther out
    const near = Math.max(distance - reach, distance / 100), far = distance + reach;
    const f = 1 / Math.tan(FIELD_OF_VIEW / 2);
    const projection = new Float32Array([f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1,
      0, 0, 2 * far * near / (near - far), 0]);
    return { camera: multiply(projection, view), turn: view };
  }
}

class Viewer {
  /** `box`: what grid positions are shares of; `colours`: from no error upwards. Throws without WebGL 2. */
  constructor(canvas, box, colours) {
    this.canvas = canvas;
    this.gl = canvas.getContext('webgl2', { antialias: true, alpha: false });
    if (!this.gl) throw new Error('this browser has no WebGL 2');
    // A unit of its own keeps very small and very large models within what floats draw well.
    const sides = box.high.map((x, i) => x - box.low[i]);
    this.size = sides.map((x) => x / (Math.hypot(...sides) || 1));
    this.camera = new Camera();
    this.panes = [null, null]; // { mesh, errors, upper }
    this.surface = 'edges';
    this.prepare(colours);
    new ResizeObserver(() => this.redraw()).observe(canvas);
    canvas.addEventListener('webglcontextlost', (event) => event.preventDefault());
    canvas.addEventListener('webglcontextrestored', () => location.reload());
    this.listen();
  }

  prepare(colours) {
    const gl = this.gl;
    this.program = gl.createProgram();
    for (const [type, source] of [[gl.VERTEX_SHADER, VERTEX_SHADER], [gl.FRAGMENT_SHADER, FRAGMENT_SHADER]]) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(this.program, shader);
    }
    gl.linkProgram(this.program);
    if (!gl.getProgramParameter(this.program, gl.LINK_STATUS)) throw new Error('the shaders do not compile here');
    gl.useProgram(this.program);
    this.place = (name) => gl.getUniformLocation(this.program, name);
    gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
    const ramp = new Uint8Array(256 * 4).fill(255), steps = colours.map(rgbOf);
    for (let i = 0; i < 256; ++i) {
      const at = i / 255 * (steps.length - 1), k = Math.min(Math.floor(at), steps.length - 2);
      for (let c = 0; c < 3; ++c) ramp[4 * i + c] = 255 * (steps[k][c] + (steps[k + 1][c] - steps[k][c]) * (at - k));
    }
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, 256, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, ramp);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
  }

  /** Returns a handle for `show`. Every corner becomes a vertex of its own, so that each knows its edges. */
  upload(geometry) {
    const gl = this.gl, { positions, faces } = geometry;
    const corners = new Uint16Array(4 * faces.length);
    for (let c = 0; c < faces.length; ++c)
      for (let i = 0; i < 3; ++i) corners[4 * c + i] = positions[3 * faces[c] + i];
    this.fitCamera(positions);
    const mesh = { faces, count: faces.length, array: gl.createVertexArray(), errors: gl.createBuffer(), shown: null };
    gl.bindVertexArray(mesh.array);
    this.attribute(0, corners, 3, gl.UNSIGNED_SHORT, 8);
    this.attribute(1, cornerNormals(geometry, this.size), 3, gl.BYTE, 4);
    gl.bindBuffer(gl.ARRAY_BUFFER, mesh.errors);
    gl.bufferData(gl.ARRAY_BUFFER, faces.length, gl.DYNAMIC_DRAW);
    gl.enableVertexAttribArray(2);
    gl.vertexAttribPointer(2, 1, gl.UNSIGNED_BYTE, true, 1, 0);
    return mesh;
  }

  /** Brings the camera as near as the first mesh allows. */
  fitCamera(positions) {
    if (this.fitted || positions.length === 0) return;
    let squares = 0;
    for (let v = 0; v < positions.length; v += 3) {
      const [x, y, z] = [0, 1, 2].map((i) => (positions[v + i] / 65535 - 0.5) * this.size[i]);
      squares = Math.max(squares, x * x + y * y + z * z);
    }
    this.camera.radius = Math.sqrt(squares) || 0.5;
    this.fitted = true;
  }

  attribute(place, data, width, type, stride) {
    const gl = this.gl;
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, width, type, true, stride, 0);
  }

  /** Puts a mesh in a pane, 0 or 1; with `errors`, a byte a vertex, it is coloured up to the share `upper`. */
  show(pane, mesh, errors, upper) {
    const gl = this.gl;
    if (errors && mesh.shown !== errors) {
      gl.bindBuffer(gl.ARRAY_BUFFER, mesh.errors);
      gl.bufferSubData(gl.ARRAY_BUFFER, 0, Uint8Array.from(mesh.faces, (v) => errors[v]));
      mesh.shown = errors;
    }
    this.panes[pane] = { mesh, upper: errors ? upper : 0 };
    this.redraw();
  }

  redraw() {
    if (this.frame) return;
    this.frame = requestAnimationFrame(() => {
      this.frame = 0;
      this.draw();
    });
  }

  /** The panes' places on the canvas, in device pixels: side by side, or one above the other where it is narrow. */
  layout(width, height) {
    if (matchMedia('(max-width: 40rem)').matches) {
      const half = Math.floor(height / 2);
      return [[0, height - half, width, half], [0, 0, width, half]];
    }
    const half = Math.floor(width / 2);
    return [[0, 0, half, height], [half, 0, half, height]];
  }

  draw() {
    const gl = this.gl, ratio = Math.min(devicePixelRatio || 1, 2);
    const width = Math.max(Math.round(this.canvas.clientWidth * ratio), 2);
    const height = Math.max(Math.round(this.canvas.clientHeight * ratio), 2);
    if (this.canvas.width !== width || this.canvas.height !== height) Object.assign(this.canvas, { width, height });
    const style = getComputedStyle(document.documentElement);
    const colour = (name) => rgbOf(style.getPropertyValue(name).trim());
    gl.clearColor(...colour('--stage'), 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.uniform3fv(this.place('size'), this.size);
    gl.uniform3fv(this.place('middle'), this.size.map((x) => x / 2));
    gl.uniform3fv(this.place('plain'), colour('--plain'));
    const wire = this.surface === 'wire' ? '--text' : '--edge';
    gl.uniform3fv(this.place('edgeColour'), colour(wire));
    gl.uniform1i(this.place('surface'), SURFACES.indexOf(this.surface));
    this.layout(width, height).forEach((place, i) => this.drawPane(this.panes[i], place));
  }

  drawPane(pane, [x, y, width, height]) {
    if (!pane) return;
    const gl = this.gl, { camera, turn } = this.camera.matrices(width / height);
    gl.viewport(x, y, width, height);
    gl.uniformMatrix4fv(this.place('camera'), false, camera);
    gl.uniformMatrix4fv(this.place('turn'), false, turn);
    gl.uniform1f(this.place('upper'), pane.upper);
    gl.bindVertexArray(pane.mesh.array);
    gl.drawArrays(gl.TRIANGLES, 0, pane.mesh.count);
  }

  listen() {
    const canvas = this.canvas, pointers = new Map();
    const spread = () => {
      const [a, b] = [...pointers.values()];
      return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, width: Math.hypot(a.x - b.x, a.y - b.y) || 1 };
    };
    canvas.addEventListener('pointerdown', (event) => {
      canvas.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    });
    canvas.addEventListener('pointermove', (event) => {
      const before = pointers.get(event.pointerId);
      if (!before) return;
      const height = this.layout(canvas.clientWidth, canvas.clientHeight)[0][3];
      const was = pointers.size === 2 ? spread() : null;
      pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
      const dx = event.clientX - before.x, dy = event.clientY - before.y;
      if (was) {
        const now = spread();
        this.camera.zoomBy(now.width / was.width);
        this.camera.pan((now.x - was.x) / height, (now.y - was.y) / height);
      } else if (event.shiftKey || event.buttons & 6) {
        this.camera.pan(dx / height, dy / height);
      } else {
        this.camera.orbit(dx * 0.008, dy * 0.008);
      }
      this.redraw();
    });
    for (const name of ['pointerup', 'pointercancel'])
      canvas.addEventListener(name, (event) => pointers.delete(event.pointerId));
    canvas.addEventListener('contextmenu', (event) => event.preventDefault());
    canvas.addEventListener('wheel', (event) => {
      event.preventDefault();
      this.camera.zoomBy(Math.exp(-event.deltaY * (event.deltaMode === 1 ? 0.05 : 0.0015)));
      this.redraw();
    }, { passive: false });
    canvas.addEventListener('keydown', (event) => this.press(event));
  }

  press(event) {
    const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    const arrow = arrows[event.key];
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    if (arrow && event.shiftKey) this.camera.pan(0.06 * arrow[0], 0.06 * arrow[1]);
    else if (arrow) this.camera.orbit(0.12 * arrow[0], 0.12 * arrow[1]);
    else if (event.key === '+' || event.key === '=') this.camera.zoomBy(1.15);
    else if (event.key === '-' || event.key === '_') this.camera.zoomBy(1 / 1.15);
    else if (event.key === '0' || event.key === 'Home') this.camera.reset();
    else return;
    event.preventDefault();
    this.redraw();
  }
}
