import * as THREE from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import type { Palette } from './palette';
import type { Quality } from './quality';
import { Resolution } from './soft/resolution';
import { SoftRenderer } from './soft/soft_renderer';

const viewDirection = new THREE.Vector3(0.75, -1.35, 0.65).normalize();
const lightDirection = new THREE.Vector3(0.35, -0.5, 1).normalize();

// What draws the scene into the canvas. `still`: nothing moves, so that it may take its time.
interface Painter {
  setSize(width: number, height: number): void;
  setBackground(top: string, bottom: string): void;
  paint(scene: THREE.Scene, camera: THREE.PerspectiveCamera, still: boolean): void;
}

class GraphicsPainter implements Painter {
  private readonly renderer: THREE.WebGLRenderer;

  constructor(canvas: HTMLCanvasElement) {
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.renderer.setClearAlpha(0);
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = THREE.PCFShadowMap;
  }

  setSize(width: number, height: number) {
    this.renderer.setSize(width, height, false);
  }

  // The page's own shines through.
  setBackground() {}

  paint(scene: THREE.Scene, camera: THREE.PerspectiveCamera) {
    this.renderer.render(scene, camera);
  }
}

class ProcessorPainter implements Painter {
  private readonly renderer: SoftRenderer;
  private readonly resolution = new Resolution();
  private width = 1;
  private height = 1;

  constructor(canvas: HTMLCanvasElement) {
    this.renderer = new SoftRenderer(canvas);
  }

  setBackground(top: string, bottom: string) {
    this.renderer.setBackground(top, bottom);
  }

  setSize(width: number, height: number) {
    this.width = width;
    this.height = height;
  }

  paint(scene: THREE.Scene, camera: THREE.PerspectiveCamera, still: boolean) {
    const begin = performance.now();
    const dots = Math.min(window.devicePixelRatio, 2);
    const scale = still ? dots : this.resolution.scale;
    const size = (length: number) => Math.max(1, Math.round(scale * length));
    this.renderer.render(scene, camera, size(this.width), size(this.height), still && dots < 2);
    if (!still) this.resolution.note(performance.now() - begin);
  }
}

// A picture drawn in haste is drawn anew, finely, when nothing has moved for this long, ms.
const stillAfter = 200;

// Camera, lights and ground. It draws only when something has changed. z is up.
export class Stage {
  readonly scene = new THREE.Scene();
  private readonly painter: Painter;
  private readonly camera = new THREE.PerspectiveCamera(32, 1, 0.01, 100);
  private readonly controls: OrbitControls;
  private readonly sky = new THREE.HemisphereLight(0xffffff, 0xb0aaa0, 1.6);
  private readonly key = new THREE.DirectionalLight(0xffffff, 1.9);
  private readonly head = new THREE.DirectionalLight(0xffffff, 0.6);
  private readonly ground: THREE.Mesh<THREE.PlaneGeometry, THREE.ShadowMaterial>;
  private grid: THREE.GridHelper | null = null;
  private gridColour = 0;
  private groundShown = true;
  private size = 1;
  private dirty = true;
  private readonly needsSecondLook: boolean;
  private hastyAt = -1; // when the picture was drawn that is still to be drawn finely; -1: none

  constructor(
    private readonly holder: HTMLElement,
    canvas: HTMLCanvasElement,
    readonly quality: Quality,
  ) {
    this.painter = quality === 'high' ? new GraphicsPainter(canvas) : new ProcessorPainter(canvas);
    this.needsSecondLook = quality === 'low';
    this.sky.position.set(0, 0, 1);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener('change', () => this.invalidate());
    this.ground = new THREE.Mesh(new THREE.PlaneGeometry(1, 1), new THREE.ShadowMaterial());
    this.ground.receiveShadow = true;
    this.key.castShadow = true;
    this.key.shadow.mapSize.set(2048, 2048);
    this.key.shadow.radius = 3;
    this.scene.add(this.sky, this.key, this.key.target, this.camera, this.ground);
    this.camera.add(this.head);
    new ResizeObserver(() => this.fit()).observe(holder);
    this.fit();
  }

  invalidate() {
    this.dirty = true;
  }

  setPalette(palette: Palette) {
    const style = getComputedStyle(this.holder);
    this.painter.setBackground(style.getPropertyValue('--sky-top').trim(), style.getPropertyValue('--sky-bottom').trim());
    this.sky.color.setHex(palette.skyLight);
    this.sky.groundColor.setHex(palette.floorLight);
    this.ground.material.opacity = palette.shadow;
    this.gridColour = palette.groundLine;
    this.makeGrid();
    this.invalidate();
  }

  // Where the ground lies and how far the light reaches: below and around everything.
  setBounds(box: THREE.Box3, showGround: boolean) {
    const centre = box.getCenter(new THREE.Vector3());
    this.size = Math.max(box.getSize(new THREE.Vector3()).length(), 1e-6);
    this.groundShown = showGround;
    this.ground.visible = showGround;
    this.ground.scale.setScalar(8 * this.size);
    this.ground.position.set(centre.x, centre.y, box.min.z - 0.01 * this.size);
    this.key.position.copy(centre).addScaledVector(lightDirection, 2 * this.size);
    this.key.target.position.copy(centre);
    const reach = 0.75 * this.size;
    Object.assign(this.key.shadow.camera, { left: -reach, right: reach, top: reach, bottom: -reach, near: 0.5 * this.size, far: 4 * this.size });
    this.key.shadow.camera.updateProjectionMatrix();
    this.key.shadow.bias = -0.0004;
    this.key.shadow.normalBias = 0.004 * this.size;
    this.makeGrid();
    this.invalidate();
  }

  // The whole box in view, seen from where the camera is, or from the front.
  frame(box: THREE.Box3, fromFront: boolean) {
    const sphere = box.getBoundingSphere(new THREE.Sphere());
    const direction = fromFront ? viewDirection.clone() : this.camera.position.clone().sub(this.controls.target).normalize();
    const half = THREE.MathUtils.degToRad(this.camera.fov / 2);
    const narrower = Math.min(half, Math.atan(Math.tan(half) * this.camera.aspect));
    const distance = (0.92 * Math.max(sphere.radius, 1e-6)) / Math.sin(narrower);
    this.controls.target.copy(sphere.center);
    this.camera.position.copy(sphere.center).addScaledVector(direction, distance);
    this.camera.near = distance / 200;
    this.camera.far = distance * 60;
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.invalidate();
  }

  draw() {
    const now = performance.now();
    const still = !this.dirty && this.hastyAt >= 0 && now - this.hastyAt > stillAfter;
    if (!this.dirty && !still) return;
    this.dirty = false;
    this.painter.paint(this.scene, this.camera, still);
    this.hastyAt = still || !this.needsSecondLook ? -1 : now;
    this.holder.dataset.picture = this.hastyAt < 0 ? 'fine' : 'hasty';
  }

  private makeGrid() {
    if (this.grid) {
      this.scene.remove(this.grid);
      this.grid.dispose();
      this.grid = null;
    }
    if (!this.groundShown) return;
    // Squares of a round size, some ten across what is seen.
    const square = 10 ** Math.floor(Math.log10(this.size / 3));
    const count = 2 * Math.min(40, Math.ceil((1.5 * this.size) / square));
    this.grid = new THREE.GridHelper(count * square, count, this.gridColour, this.gridColour);
    this.grid.rotation.x = Math.PI / 2;
    this.grid.material.transparent = true;
    this.grid.material.opacity = 0.6;
    this.grid.position.copy(this.ground.position);
    this.scene.add(this.grid);
  }

  private fit() {
    const { clientWidth, clientHeight } = this.holder;
    if (clientWidth === 0 || clientHeight === 0) return;
    this.painter.setSize(clientWidth, clientHeight);
    this.camera.aspect = clientWidth / clientHeight;
    this.camera.updateProjectionMatrix();
    this.dirty = true;
    this.draw();
  }
}
