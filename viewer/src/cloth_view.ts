import * as THREE from 'three';
import type { SceneInfo } from './api';
import { viridisTexels } from './colour_map';
import { nodeNormals } from './normals';
import type { Palette } from './palette';

// Above this many triangles the graphics processor makes normals itself, one a triangle; below, they are smooth and cost some ms a frame.
const mostSmoothTriangles = 300_000;

// What is added to three.js's standard material: the colour of each side, or a number at each node through a colour map; thin lines of constant
// u and v, which show how the cloth is sheared and stretched.
const vertexHead = `
attribute float value;
varying float vValue;
varying vec2 vClothUv;
`;
const vertexBody = `
vValue = value;
vClothUv = uv;
`;
const fragmentHead = `
uniform float fieldShare, lineShare, fieldLow, fieldHigh;
uniform sampler2D fieldMap;
uniform vec3 frontColour, backColour;
varying float vValue;
varying vec2 vClothUv;
float uvLine() {
  vec2 place = vClothUv * 20.0, width = fwidth(place) + 1e-7;
  vec2 near = abs(fract(place - 0.5) - 0.5) / width;
  float line = 1.0 - min(min(near.x, near.y), 1.0);
  return line * (1.0 - smoothstep(0.15, 0.5, max(width.x, width.y)));
}
`;
const fragmentBody = `
vec3 plain = gl_FrontFacing ? frontColour : backColour;
float place = clamp((vValue - fieldLow) / (fieldHigh - fieldLow), 0.0, 1.0);
vec3 mapped = texture2D(fieldMap, vec2(place * 255.0 / 256.0 + 0.5 / 256.0, 0.5)).rgb;
diffuseColor.rgb = mix(plain, mapped, fieldShare) * (1.0 - lineShare * uvLine());
`;
// Numbers are to be read off: half of their colour does not depend on the light.
const fragmentLight = `
totalEmissiveRadiance += 0.5 * fieldShare * diffuseColor.rgb;
diffuseColor.rgb *= 1.0 - 0.45 * fieldShare;
`;

function mapTexture(reversed: boolean): THREE.DataTexture {
  const texture = new THREE.DataTexture(viridisTexels(reversed), 256, 1, THREE.RGBAFormat);
  texture.colorSpace = THREE.SRGBColorSpace;
  texture.magFilter = texture.minFilter = THREE.LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

export class ClothView {
  readonly mesh: THREE.Mesh<THREE.BufferGeometry, THREE.MeshStandardMaterial[]>;
  private readonly positions: THREE.BufferAttribute;
  private readonly normals: THREE.BufferAttribute | null = null;
  private readonly values: THREE.BufferAttribute;
  private readonly maps = { usual: mapTexture(false), reversed: mapTexture(true) };
  private readonly uniforms = {
    fieldShare: { value: 0 },
    lineShare: { value: 0 },
    fieldLow: { value: 0 },
    fieldHigh: { value: 1 },
    fieldMap: { value: this.maps.usual },
  };
  private readonly sides: { frontColour: { value: THREE.Color }; backColour: { value: THREE.Color } }[];

  constructor(
    scene: SceneInfo,
    private readonly triangles: Uint32Array,
    uv: Float32Array | null,
  ) {
    const geometry = new THREE.BufferGeometry();
    const smooth = scene.triangles <= mostSmoothTriangles;
    this.positions = new THREE.BufferAttribute(new Float32Array(3 * scene.nodes), 3).setUsage(THREE.DynamicDrawUsage);
    this.values = new THREE.BufferAttribute(new Float32Array(scene.nodes), 1).setUsage(THREE.DynamicDrawUsage);
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
    this.uniforms.lineShare.value = uv && uv.some((number) => number !== 0) ? 0.22 : 0;
    this.mesh = new THREE.Mesh(geometry, materials);
    this.mesh.frustumCulled = false; // the bounding sphere would have to follow every frame
    this.mesh.castShadow = this.mesh.receiveShadow = smooth;
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
    this.sides.forEach((side, k) => {
      const { front, back } = palette.cloths[k % palette.cloths.length];
      side.frontColour.value.setHex(front);
      side.backColour.value.setHex(back);
    });
  }

  setPositions(positions: Float32Array) {
    this.positions.array.set(positions);
    this.positions.needsUpdate = true;
    if (!this.normals) return;
    nodeNormals(positions, this.triangles, this.normals.array as Float32Array);
    this.normals.needsUpdate = true;
  }

  // The numbers to colour by, to be filled in before showField.
  get field(): Float32Array {
    return this.values.array as Float32Array;
  }

  showField(low: number, high: number, reversed: boolean) {
    this.values.needsUpdate = true;
    this.uniforms.fieldShare.value = 1;
    this.uniforms.fieldLow.value = low;
    this.uniforms.fieldHigh.value = high;
    this.uniforms.fieldMap.value = reversed ? this.maps.reversed : this.maps.usual;
  }

  hideField() {
    this.uniforms.fieldShare.value = 0;
  }

  setWireframe(on: boolean) {
    for (const material of this.mesh.material) material.wireframe = on;
  }

  dispose() {
    this.mesh.geometry.dispose();
    for (const material of this.mesh.material) material.dispose();
    this.maps.usual.dispose();
    this.maps.reversed.dispose();
  }
}
