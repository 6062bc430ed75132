import * as THREE from 'three';
import type { SceneInfo } from './api';
import { viridisTexels } from './colour_map';
import { contactKinds } from './contact_kinds';
import { nodeNormals } from './normals';
import type { Palette } from './palette';
import type { Quality } from './quality';
import type { SurfaceLook } from './soft/soft_renderer';
import { lineTriangles } from './uv_lines';

// Above this many triangles the graphics processor makes normals itself, one a triangle; below, they are smooth and cost some ms a frame.
const mostSmoothTriangles = 300_000;

// What is added to three.js's standard material: the colour of each side, or a number at each node through a colour map; thin lines of constant
// u and v, which show how the cloth is sheared and stretched. Kinds have no colours in between: each node has its own.
const vertexHead = `
attribute float value;
uniform float kinds, fieldLow, fieldHigh;
uniform sampler2D fieldMap;
varying float vValue;
varying vec2 vClothUv;
varying vec3 vKind;
`;
const vertexBody = `
vValue = (value - fieldLow) / (fieldHigh - fieldLow);
vClothUv = uv;
vKind = kinds > 0.0 ? texture2D(fieldMap, vec2((value + 0.5) / 256.0, 0.5)).rgb : vec3(0.0);
`;
const fragmentHead = `
uniform float fieldShare, lineShare, kinds;
uniform sampler2D fieldMap;
uniform vec3 frontColour, backColour;
varying float vValue;
varying vec2 vClothUv;
varying vec3 vKind;
float uvLine() {
  vec2 place = vClothUv * 20.0, width = fwidth(place) + 1e-7;
  vec2 near = abs(fract(place - 0.5) - 0.5) / width;
  float line = 1.0 - min(min(near.x, near.y), 1.0);
  return line * (1.0 - smoothstep(0.15, 0.5, max(width.x, width.y)));
}
`;
const fragmentBody = `
vec3 plain = gl_FrontFacing ? frontColour : backColour;
vec3 mapped = texture2D(fieldMap, vec2(clamp(vValue, 0.0, 1.0) * 255.0 / 256.0 + 0.5 / 256.0, 0.5)).rgb;
diffuseColor.rgb = mix(plain, mix(mapped, vKind, kinds), fieldShare) * (1.0 - lineShare * uvLine());
`;
// Numbers are to be read off: half of their colour does not depend on the light.
const fragmentLight = `
totalEmissiveRadiance += 0.5 * fieldShare * diffuseColor.rgb;
diffuseColor.rgb *= 1.0 - 0.45 * fieldShare;
`;

function texture(texels: Uint8Array): THREE.DataTexture {
  const made = new THREE.DataTexture(texels, 256, 1, THREE.RGBAFormat);
  made.colorSpace = THREE.SRGBColorSpace;
  made.magFilter = made.minFilter = THREE.LinearFilter;
  made.needsUpdate = true;
  return made;
}

function kindTexels(): Uint8Array {
  const texels = new Uint8Array(4 * 256);
  contactKinds.forEach(({ colour }, k) => texels.set([colour >> 16, (colour >> 8) & 255, colour & 255, 255], 4 * k));
  return texels;
}

const packed = (texels: Uint8Array) => Array.from({ length: 256 }, (_, k) => (texels[4 * k] << 16) | (texels[4 * k + 1] << 8) | texels[4 * k + 2]);

const maps = { usual: viridisTexels(false), reversed: viridisTexels(true), kinds: kindTexels() };

export class ClothView {
  readonly mesh: THREE.Mesh<THREE.BufferGeometry, THREE.MeshStandardMaterial[]>;
  private readonly positions: THREE.BufferAttribute;
  private readonly normals: THREE.BufferAttribute | null = null;
  private readonly values: THREE.BufferAttribute;
  private readonly textures = { usual: texture(maps.usual), reversed: texture(maps.reversed), kinds: texture(maps.kinds) };
  private readonly palettes = { usual: packed(maps.usual), reversed: packed(maps.reversed), kinds: packed(maps.kinds) };
  private readonly uniforms = {
    fieldShare: { value: 0 },
    lineShare: { value: 0 },
    kinds: { value: 0 },
    fieldLow: { value: 0 },
    fieldHigh: { value: 1 },
    fieldMap: { value: this.textures.usual },
  };
  private readonly sides: { frontColour: { value: THREE.Color }; backColour: { value: THREE.Color } }[];
  private readonly look: SurfaceLook; // what the picture is made from where there is no graphics processor
  private readonly softValues: Float32Array;

  constructor(
    scene: SceneInfo,
    private readonly triangles: Uint32Array,
    uv: Float32Array | null,
    private readonly quality: Quality,
  ) {
    const geometry = new THREE.BufferGeometry();
    const smooth = quality === 'low' || scene.triangles <= mostSmoothTriangles;
    this.positions = new THREE.BufferAttribute(new Float32Array(3 * scene.nodes), 3).setUsage(THREE.DynamicDrawUsage);
    this.values = new THREE.BufferAttribute(new Float32Array(scene.nodes), 1).setUsage(THREE.DynamicDrawUsage);
    this.softValues = new Float32Array(quality === 'low' ? scene.nodes : 0);
    geometry.setAttribute('position', this.positions);
    geometry.setAttribute('value', this.values);
    if (uv) geometry.setAttribute('uv', new THREE.BufferAttribute(uv, 2));
    if (smooth) {
      this.normals = new THREE.BufferAttribute(new Float32Array(3 * scene.nodes), 3).setUsage(THREE.DynamicDrawUsage);
      geometry.setAttribute('normal', this.normals);
    }
    geometry.setIndex(new THREE.BufferAttribute(triangles, 1));
    scene.cloths.forEach((cloth, k) => geometry.addGroup(3 * cloth.first_triangle, 3 * cloth.triangles, k));
    this.sides = scene.cloths.map(() => ({ frontColour: { value: new THREE.Color() }, backColour: { value: new THREE.Color() } }));
    const materials = scene.cloths.map((_, k) => this.material(k, !smooth));
    const hasUv = uv !== null && uv.some((number) => number !== 0);
    this.uniforms.lineShare.value = hasUv ? 0.22 : 0;
    this.mesh = new THREE.Mesh(geometry, materials);
    this.mesh.frustumCulled = false; // the bounding sphere would have to follow every frame
    this.mesh.castShadow = this.mesh.receiveShadow = smooth;
    this.look = { sides: [], palette: null, values: null, flat: false, dimmed: quality === 'low' && hasUv ? lineTriangles(triangles, uv) : null };
    this.mesh.userData.look = this.look;
  }

  private material(k: number, flatShading: boolean): THREE.MeshStandardMaterial {
    const material = new THREE.MeshStandardMaterial({ side: THREE.DoubleSide, shadowSide: THREE.DoubleSide, roughness: 0.85, flatShading });
    material.onBeforeCompile = (shader) => {
      Object.assign(shader.uniforms, this.uniforms, this.sides[k]);
      shader.vertexShader = shader.vertexShader
        .replace('#include <common>', '#include <common>' + vertexHead)
        .replace('#include <begin_vertex>', '#include <begin_vertex>' + vertexBody);
      shader.fragmentShader = shader.fragmentShader
        .replace('#include <common>', '#include <common>' + fragmentHead)
        .replace('#include <color_fragment>', '#include <color_fragment>' + fragmentBody)
        .replace('#include <emissivemap_fragment>', '#include <emissivemap_fragment>' + fragmentLight);
    };
    return material;
  }

  setPalette(palette: Palette) {
    this.look.sides = this.sides.map((side, k) => {
      const { front, back } = palette.cloths[k % palette.cloths.length];
      side.frontColour.value.setHex(front);
      side.backColour.value.setHex(back);
      return { front, back };
    });
  }

  setPositions(positions: Float32Array) {
    this.positions.array.set(positions);
    this.positions.needsUpdate = true;
    if (!this.normals) return;
    nodeNormals(positions, this.triangles, this.normals.array as Float32Array);
    this.normals.needsUpdate = true;
  }

  // The numbers to colour by, to be filled in before showField or showKinds.
  get field(): Float32Array {
    return this.values.array as Float32Array;
  }

  // The numbers through the colour map, from `low` to `high`.
  showField(low: number, high: number, reversed: boolean) {
    this.show(reversed ? 'reversed' : 'usual', low, high);
    const { softValues, field } = this;
    const scale = 255 / (high - low);
    for (let k = 0; k < softValues.length; ++k) softValues[k] = Math.min(Math.max((field[k] - low) * scale, 0), 255);
  }

  // Each number is that of a kind (contact_kinds.ts).
  showKinds() {
    this.show('kinds', 0, 1);
    if (this.quality === 'low') this.softValues.set(this.field);
  }

  private show(map: keyof typeof maps, low: number, high: number) {
    this.values.needsUpdate = true;
    this.uniforms.fieldShare.value = 1;
    this.uniforms.fieldLow.value = low;
    this.uniforms.fieldHigh.value = high;
    this.uniforms.kinds.value = map === 'kinds' ? 1 : 0;
    this.uniforms.fieldMap.value = this.textures[map];
    this.look.palette = this.palettes[map];
    this.look.values = this.softValues;
    this.look.flat = map === 'kinds';
  }

  hideField() {
    this.uniforms.fieldShare.value = 0;
    this.look.palette = this.look.values = null;
  }

  setWireframe(on: boolean) {
    for (const material of this.mesh.material) material.wireframe = on;
  }

  dispose() {
    this.mesh.geometry.dispose();
    for (const material of this.mesh.material) material.dispose();
    for (const made of Object.values(this.textures)) made.dispose();
  }
}
