import * as THREE from 'three';
import { colourTable, levels, vertexLevels, type Lights } from './light';
import { halve, pixelOf, Raster, subpixels, type ColourTable, type Look, type Vertices } from './raster';

// Draws a scene of three.js on the processor into a plain canvas: meshes with smooth normals, lit, without gloss and shadow; lines. What a mesh is
// coloured by is told by its material's colour, or by userData.look.

// A surface with a front and a back, and perhaps a number at each node.
export interface SurfaceLook {
  sides: { front: number; back: number }[]; // 0xrrggbb, a group of the geometry
  palette: number[] | null; // 0xrrggbb by value, instead of the sides' colours
  values: Float32Array | null; // 0 to palette.length - 1, a number a vertex
  flat: boolean; // values are kinds, not to be mixed
  dimmed: Uint8Array | null;
}

const matrix = new THREE.Matrix4();
const vector = new THREE.Vector3();

export class SoftRenderer {
  private readonly context: CanvasRenderingContext2D;
  private raster = new Raster(1, 1);
  private image: ImageData;
  private pixels: Uint32Array;
  private readonly prepared = new WeakMap<THREE.BufferGeometry, Vertices>();
  private readonly tables = new Map<string, ColourTable>();
  private background = { top: 0xffffff, bottom: 0xffffff };

  constructor(private readonly canvas: HTMLCanvasElement) {
    const context = canvas.getContext('2d', { alpha: false });
    if (!context) throw new Error('this browser has no canvas');
    this.context = context;
    this.image = context.createImageData(1, 1);
    this.pixels = new Uint32Array(this.image.data.buffer);
  }

  // Two colours, as #rrggbb, and those in between.
  setBackground(top: string, bottom: string) {
    this.background = { top: parseInt(top.slice(1), 16) || 0, bottom: parseInt(bottom.slice(1), 16) || 0 };
  }

  // `fine`: each pixel is the mean of four.
  render(scene: THREE.Scene, camera: THREE.PerspectiveCamera, width: number, height: number, fine: boolean) {
    this.resize(width, height, fine);
    this.raster.clear(this.background.top, this.background.bottom);
    scene.updateMatrixWorld();
    camera.matrixWorldInverse.copy(camera.matrixWorld).invert();
    const meshes: THREE.Mesh[] = [], lines: THREE.LineSegments[] = [];
    scene.traverseVisible((object) => {
      if (object instanceof THREE.Mesh && !(object.material instanceof THREE.ShadowMaterial)) meshes.push(object);
      if (object instanceof THREE.LineSegments) lines.push(object);
    });
    const isClear = (mesh: THREE.Mesh) => !Array.isArray(mesh.material) && mesh.material.transparent;
    for (const mesh of meshes) if (!isClear(mesh)) this.drawMesh(mesh, scene, camera);
    for (const line of lines) this.drawLines(line, camera);
    for (const mesh of meshes) if (isClear(mesh)) this.drawMesh(mesh, scene, camera);
    if (fine) halve(this.raster, this.pixels);
    else this.pixels.set(this.raster.colour);
    this.context.putImageData(this.image, 0, 0);
  }

  private resize(width: number, height: number, fine: boolean) {
    if (this.canvas.width !== width || this.canvas.height !== height || this.image.width !== width) {
      this.canvas.width = width;
      this.canvas.height = height;
      this.image = this.context.createImageData(width, height);
      this.pixels = new Uint32Array(this.image.data.buffer);
    }
    const factor = fine ? 2 : 1;
    if (this.raster.width !== factor * width || this.raster.height !== factor * height) this.raster = new Raster(factor * width, factor * height);
  }

  private drawMesh(mesh: THREE.Mesh, scene: THREE.Scene, camera: THREE.PerspectiveCamera) {
    const geometry = mesh.geometry as THREE.BufferGeometry;
    const index = geometry.index?.array;
    if (!index) return;
    const look = mesh.userData.look as SurfaceLook | undefined;
    const vertices = this.place(mesh, camera);
    this.light(mesh, scene, vertices);
    vertices.value = look?.values ?? null;
    const materials = (Array.isArray(mesh.material) ? mesh.material : [mesh.material]) as THREE.MeshStandardMaterial[];
    const groups = geometry.groups.length > 0 && materials.length > 1 ? geometry.groups : [{ start: 0, count: index.length, materialIndex: 0 }];
    for (const { start, count, materialIndex } of groups) {
      const material = materials[materialIndex ?? 0];
      const drawn = this.lookOf(material, look, materialIndex ?? 0);
      const first = start / 3, end = (start + count) / 3;
      if (material.wireframe) {
        this.drawWires(vertices, index, first, end, drawn);
        continue;
      }
      const hidden: number[] = [];
      this.raster.triangles(vertices, index, first, end, drawn, hidden);
      if (hidden.length > 0) this.drawCut(mesh, camera, vertices, index, hidden, drawn);
    }
  }

  private lookOf(material: THREE.MeshStandardMaterial, look: SurfaceLook | undefined, group: number): Look {
    const opacity = material.transparent ? material.opacity : 1;
    if (!look) {
      const table = this.table([material.color.getHex()], 0);
      return { front: table, back: material.side === THREE.DoubleSide ? table : null, dimmed: null, flat: false, opacity };
    }
    const { palette, sides, flat, dimmed } = look;
    if (palette && look.values) {
      const table = this.table(palette, 0.5);
      return { front: table, back: table, dimmed, flat, opacity };
    }
    const side = sides[group];
    return { front: this.table([side.front], 0), back: this.table([side.back], 0), dimmed, flat: false, opacity };
  }

  private table(colours: number[], glow: number): ColourTable {
    const key = `${colours.join()} ${glow}`;
    let table = this.tables.get(key);
    if (!table) this.tables.set(key, (table = colourTable(colours, glow)));
    return table;
  }

  private room(geometry: THREE.BufferGeometry): Vertices {
    const count = geometry.getAttribute('position').count;
    let room = this.prepared.get(geometry);
    if (!room || room.x.length !== count) {
      room = {
        x: new Float64Array(count), y: new Float64Array(count), z: new Float64Array(count), hidden: new Uint8Array(count),
        frontLevel: new Float32Array(count), backLevel: new Float32Array(count), value: null,
      };
      this.prepared.set(geometry, room);
    }
    return room;
  }

  // Where the vertices are on the screen.
  private place(mesh: THREE.Mesh, camera: THREE.PerspectiveCamera): Vertices {
    const vertices = this.room(mesh.geometry);
    const points = mesh.geometry.getAttribute('position').array as Float32Array;
    const { x, y, z, hidden } = vertices;
    const e = this.toScreen(mesh, camera).elements;
    const [m0, m1, m2, m3, m4, m5, m6, m7, m8, m9, m10, m11, m12, m13, m14, m15] = e;
    for (let k = 0, n = 0; k < x.length; ++k, n += 3) {
      const px = points[n], py = points[n + 1], pz = points[n + 2];
      const w = m3 * px + m7 * py + m11 * pz + m15;
      if (w < camera.near) {
        hidden[k] = 1;
        continue;
      }
      hidden[k] = 0;
      const over = 1 / w;
      x[k] = Math.round((m0 * px + m4 * py + m8 * pz + m12) * over);
      y[k] = Math.round((m1 * px + m5 * py + m9 * pz + m13) * over);
      z[k] = (m2 * px + m6 * py + m10 * pz + m14) * over;
    }
    return vertices;
  }

  // From a mesh's coordinates to pixels times 16.
  private toScreen(object: THREE.Object3D, camera: THREE.PerspectiveCamera): THREE.Matrix4 {
    const across = (subpixels * this.raster.width) / 2, down = (subpixels * this.raster.height) / 2;
    return matrix
      .set(across, 0, 0, across, 0, -down, 0, down, 0, 0, 1, 0, 0, 0, 0, 1)
      .multiply(camera.projectionMatrix)
      .multiply(camera.matrixWorldInverse)
      .multiply(object.matrixWorld);
  }

  private light(mesh: THREE.Mesh, scene: THREE.Scene, { frontLevel, backLevel }: Vertices) {
    const normals = mesh.geometry.getAttribute('normal')?.array;
    if (normals) vertexLevels(normals, lightsAt(mesh, scene), frontLevel, backLevel);
    else frontLevel.fill(0.6 * levels), backLevel.fill(0.6 * levels);
  }

  private drawWires(vertices: Vertices, index: ArrayLike<number>, first: number, end: number, look: Look) {
    const { x, y, z, hidden, frontLevel, value } = vertices;
    for (let t = first; t < end; ++t)
      for (let corner = 0; corner < 3; ++corner) {
        const a = index[3 * t + corner], b = index[3 * t + ((corner + 1) % 3)];
        if (hidden[a] | hidden[b]) continue;
        const shown = look.front.colours[(frontLevel[a] | 0) * look.front.stride + (value ? value[a] | 0 : 0)];
        this.raster.line(x[a], y[a], z[a], x[b], y[b], z[b], shown, look.opacity);
      }
  }

  // Triangles that reach behind the camera: what is before it, as two triangles at most.
  private drawCut(mesh: THREE.Mesh, camera: THREE.PerspectiveCamera, all: Vertices, index: ArrayLike<number>, cut: number[], look: Look) {
    const points = mesh.geometry.getAttribute('position').array;
    const transform = this.toScreen(mesh, camera).clone();
    const corners: number[][] = [];
    for (const t of cut) {
      const polygon = [0, 1, 2].map((corner) => {
        const k = index[3 * t + corner];
        const at = new THREE.Vector4(points[3 * k], points[3 * k + 1], points[3 * k + 2], 1).applyMatrix4(transform);
        return [at.x, at.y, at.z, at.w, all.frontLevel[k], all.backLevel[k], all.value ? all.value[k] : 0];
      });
      const before = clipped(polygon, camera.near);
      for (let k = 2; k < before.length; ++k) corners.push(before[0], before[k - 1], before[k]);
    }
    const vertices: Vertices = {
      x: Float64Array.from(corners, (c) => Math.round(c[0] / c[3])),
      y: Float64Array.from(corners, (c) => Math.round(c[1] / c[3])),
      z: Float64Array.from(corners, (c) => c[2] / c[3]),
      hidden: new Uint8Array(corners.length),
      frontLevel: Float32Array.from(corners, (c) => c[4]),
      backLevel: Float32Array.from(corners, (c) => c[5]),
      value: all.value ? Float32Array.from(corners, (c) => c[6]) : null,
    };
    this.raster.triangles(vertices, corners.map((_, k) => k), 0, corners.length / 3, { ...look, dimmed: null }, null);
  }

  private drawLines(lines: THREE.LineSegments, camera: THREE.PerspectiveCamera) {
    const points = lines.geometry.getAttribute('position');
    const colours = lines.geometry.getAttribute('color');
    const material = lines.material as THREE.LineBasicMaterial;
    const transform = this.toScreen(lines, camera);
    const end = (k: number) => {
      const at = new THREE.Vector4(points.getX(k), points.getY(k), points.getZ(k), 1).applyMatrix4(transform);
      return [at.x, at.y, at.z, at.w];
    };
    for (let k = 0; k + 1 < points.count; k += 2) {
      const before = clipped([end(k), end(k + 1)], camera.near);
      if (before.length < 2) continue;
      const [a, b] = before;
      const hex = (colours ? new THREE.Color(colours.getX(k), colours.getY(k), colours.getZ(k)) : material.color).getHex();
      const shown = pixelOf(hex);
      this.raster.line(a[0] / a[3], a[1] / a[3], a[2] / a[3], b[0] / b[3], b[1] / b[3], b[2] / b[3], shown, material.transparent ? material.opacity : 1);
    }
  }
}

// Corners [x, y, z, w, ...] of a polygon, or the ends of a line: what has w >= near.
function clipped(corners: number[][], near: number): number[][] {
  const kept: number[][] = [];
  corners.forEach((from, k) => {
    const to = corners[(k + 1) % corners.length];
    if (from[3] >= near) kept.push(from);
    if (from[3] >= near !== to[3] >= near && (corners.length > 2 || k === 0)) {
      const share = (near - from[3]) / (to[3] - from[3]);
      kept.push(from.map((value, c) => value + share * (to[c] - value)));
    }
  });
  return kept;
}

const brightness = (colour: THREE.Color) => 0.2126 * colour.r + 0.7152 * colour.g + 0.0722 * colour.b;

// The scene's lights as a mesh sees them that may be turned, not sheared.
function lightsAt(mesh: THREE.Mesh, scene: THREE.Scene): Lights {
  const turned = new THREE.Quaternion();
  mesh.matrixWorld.decompose(new THREE.Vector3(), turned, new THREE.Vector3());
  turned.invert();
  const lights: Lights = { up: [0, 0, 1], sky: 0, floor: 0, suns: [] };
  const from = (light: THREE.Light, target: THREE.Vector3) => vector.setFromMatrixPosition(light.matrixWorld).sub(target).normalize().applyQuaternion(turned).toArray();
  scene.traverseVisible((object) => {
    if (object instanceof THREE.HemisphereLight) {
      lights.up = from(object, new THREE.Vector3());
      lights.sky = object.intensity * brightness(object.color);
      lights.floor = object.intensity * brightness(object.groundColor);
    }
    if (object instanceof THREE.DirectionalLight)
      lights.suns.push({ direction: from(object, new THREE.Vector3().setFromMatrixPosition(object.target.matrixWorld)), strength: object.intensity * brightness(object.color) });
  });
  return lights;
}
