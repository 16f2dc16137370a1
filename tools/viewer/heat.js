// The error map: colours by how far vertices that have arrived lie from the surface that is shown. A worker measures it.
import { BufferAttribute, MeshStandardMaterial } from 'three';

const COLOURS = ['#30308c', '#2b8cbe', '#41b86a', '#f2d338', '#d7301f'];

/** Returns a material that shows the attribute `heat` by COLOURS; `scale`, a uniform, is what the last of them stands for. */
export function makeHeatMaterial() {
  const material = new MeshStandardMaterial({ roughness: 0.9, metalness: 0, toneMapped: false });
  material.userData.scale = { value: 1 };
  material.onBeforeCompile = (shader) => {
    shader.uniforms.heatScale = material.userData.scale;
    const ramp = COLOURS.map((colour) => `vec3(${[1, 3, 5].map((at) => ((parseInt(colour.slice(at, at + 2), 16) / 255) ** 2.2).toFixed(4)).join(', ')})`);
    shader.vertexShader = `attribute float heat;\nvarying float vHeat;\n${shader.vertexShader}`.replace('#include <begin_vertex>', '#include <begin_vertex>\nvHeat = heat;');
    shader.fragmentShader = `uniform float heatScale;\nvarying float vHeat;\n${shader.fragmentShader}`.replace('#include <color_fragment>', `#include <color_fragment>
      float place = 4.0 * clamp(heatScale > 0.0 ? vHeat / heatScale : 0.0, 0.0, 1.0);
      vec3 heated = mix(${ramp[0]}, ${ramp[1]}, clamp(place, 0.0, 1.0));
      heated = mix(heated, ${ramp[2]}, clamp(place - 1.0, 0.0, 1.0));
      heated = mix(heated, ${ramp[3]}, clamp(place - 2.0, 0.0, 1.0));
      diffuseColor.rgb = mix(heated, ${ramp[4]}, clamp(place - 3.0, 0.0, 1.0));`);
  };
  return material;
}

/** What the geometries of one stream show: they share their vertices. */
export class HeatMap {
  #geometries;
  #level; // () => the level that is drawn, or undefined
  #onChange;
  #worker = new Worker(new URL('./heat_worker.js', import.meta.url), { type: 'module' });
  #attribute;
  #measured = ''; // what the last measure was of
  #busy = false;
  worst = 0; // distance

  constructor(geometries, level, onChange) {
    this.#geometries = geometries;
    this.#level = level;
    this.#onChange = onChange;
    this.#worker.onmessage = ({ data }) => this.#receive(data);
  }

  /** Whether the measure of what is drawn is there. */
  get isReady() {
    return this.#measured === this.#now() && !this.#busy;
  }

  #now() {
    const level = this.#level();
    return level ? `${level.position} ${this.#geometries[0].userData.lodestone?.wedgeCount}` : '';
  }

  /** Has the level that is drawn measured, where that has not been done; call it in each frame. */
  update() {
    const now = this.#now();
    if (now === '') return;
    this.#fit();
    if (this.#busy || now === this.#measured) return;
    this.#busy = true;
    this.#measured = now;
    const { position } = this.#geometries[0].attributes;
    const { wedgeCount } = this.#geometries[0].userData.lodestone;
    const corners = this.#geometries.map(({ index, drawRange }) => index.array.slice(0, drawRange.count));
    const positions = position.array.slice(0, 3 * wedgeCount);
    this.#worker.postMessage({ positions, corners, shown: this.#level().wedgeCount }, [positions.buffer, ...corners.map(({ buffer }) => buffer)]);
  }

  /** Buffers of vertices grow: this one with them. */
  #fit() {
    const { count } = this.#geometries[0].attributes.position;
    if (this.#attribute?.count !== count) {
      const array = new Float32Array(count);
      if (this.#attribute) array.set(this.#attribute.array.subarray(0, Math.min(count, this.#attribute.count)));
      this.#attribute = new BufferAttribute(array, 1);
    }
    for (const geometry of this.#geometries) if (geometry.attributes.heat !== this.#attribute) geometry.setAttribute('heat', this.#attribute);
  }

  #receive({ heat, worst }) {
    this.#busy = false;
    this.#fit();
    this.#attribute.array.fill(0);
    this.#attribute.array.set(heat.subarray(0, this.#attribute.count));
    this.#attribute.needsUpdate = true;
    this.worst = worst;
    this.#onChange();
  }

  dispose() {
    this.#worker.terminate();
  }
}
