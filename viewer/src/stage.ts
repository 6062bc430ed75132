import * as THREE from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import type { Palette } from './palette';
import type { Quality } from './quality';

const viewDirection = new THREE.Vector3(0.75, -1.35, 0.65).normalize();
const lightDirection = new THREE.Vector3(0.35, -0.5, 1).normalize();

// Camera, lights and ground. It draws only when something has changed. z is up.
export class Stage {
  readonly scene = new THREE.Scene();
  private readonly renderer: THREE.WebGLRenderer;
  private readonly camera = new THREE.PerspectiveCamera(32, 1, 0.01, 100);
  private readonly controls: OrbitControls;
  private readonly sky = new THREE.HemisphereLight(0xffffff, 0xb0aaa0, 2.0);
  private readonly key = new THREE.DirectionalLight(0xffffff, 1.9);
  private readonly head = new THREE.DirectionalLight(0xffffff, 0.6);
  private readonly ground: THREE.Mesh<THREE.PlaneGeometry, THREE.ShadowMaterial>;
  private grid: THREE.GridHelper | null = null;
  private gridColour = 0;
  private groundShown = true;
  private size = 1;
  private dirty = true;

  constructor(
    private readonly holder: HTMLElement,
    canvas: HTMLCanvasElement,
    quality: Quality,
  ) {
    const fine = quality === 'high';
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: fine, alpha: true });
    this.renderer.setClearAlpha(0);
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.shadowMap.enabled = fine;
    this.renderer.shadowMap.type = THREE.PCFShadowMap;
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
    if (!this.dirty) return;
    this.dirty = false;
    this.renderer.render(this.scene, this.camera);
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
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.camera.aspect = clientWidth / clientHeight;
    this.camera.updateProjectionMatrix();
    this.dirty = true;
    this.draw();
  }
}
