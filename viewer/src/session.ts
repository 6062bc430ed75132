import * as THREE from 'three';
import { readContact, readFrames, readRestLengths, readScene, readSprings, readTriangles, readUv, type SceneInfo } from './api';
import { ClothView } from './cloth_view';
import { Clock } from './clock';
import { Colouring, type Mode } from './colouring';
import { FrameStore } from './frame_store';
import type { Palette } from './palette';
import { SolidsView } from './solids_view';
import type { Stage } from './stage';

// One run, as long as its folder holds it: the geometry, the frames and what is shown of them.
export class Session {
  readonly clock: Clock;
  readonly colouring: Colouring;
  private readonly store: FrameStore<Float32Array>;
  private readonly contact: FrameStore<Uint8Array>; // fetched only while it is looked at
  private readonly cloth: ClothView;
  private readonly solids: SolidsView;
  private bounds = new THREE.Box3();
  private mode: Mode = 'cloth';
  private shown = -1;
  private outdated = true;
  onScale: () => void = () => {};
  onTrouble: (message: string) => void = () => {};

  static async open(stage: Stage, palette: Palette): Promise<Session> {
    const scene = await readScene();
    const [triangles, uv] = await Promise.all([readTriangles(), scene.uv ? readUv() : null]);
    return new Session(stage, scene, triangles, uv, palette);
  }

  private constructor(
    private readonly stage: Stage,
    readonly scene: SceneInfo,
    triangles: Uint32Array,
    uv: Float32Array | null,
    palette: Palette,
  ) {
    this.clock = new Clock(scene.frame_s);
    this.colouring = new Colouring(scene);
    const arrived = () => (this.outdated = true);
    const trouble = (message: string) => this.onTrouble(message);
    this.store = new FrameStore({ frameBytes: 12 * scene.nodes, read: readFrames, view: (frame) => new Float32Array(frame) }, arrived, trouble);
    this.contact = new FrameStore({ frameBytes: scene.nodes, read: readContact, view: (frame) => new Uint8Array(frame) }, arrived, trouble);
    this.cloth = new ClothView(scene, triangles, uv, stage.quality);
    this.solids = new SolidsView(scene.solids);
    stage.scene.add(this.cloth.mesh, this.solids.group);
    this.setPalette(palette);
    this.solids.loadMeshes(scene.solids).then(
      () => (this.outdated = true),
      (error) => this.onTrouble(`Solids that are meshes are not drawn: ${error.message}`),
    );
  }

  private get needsContact(): boolean {
    return this.mode === 'contact' && this.scene.contact;
  }

  get frames(): number {
    return this.store.total;
  }

  get shownFrame(): number {
    return this.shown;
  }

  isThere(frame: number): boolean {
    return this.store.isSettled(frame);
  }

  setTotal(total: number) {
    this.store.setTotal(total);
    if (this.needsContact) this.contact.setTotal(total);
    else this.contact.forgetFrom(total);
    if (this.clock.frame >= total) this.clock.jump(total - 1);
  }

  setPalette(palette: Palette) {
    this.cloth.setPalette(palette);
    this.solids.setColour(palette.solid, palette.ground);
    this.stage.setPalette(palette);
  }

  setWireframe(on: boolean) {
    this.cloth.setWireframe(on);
    this.stage.invalidate();
  }

  async setMode(mode: Mode) {
    this.mode = mode;
    this.outdated = true;
    this.solids.setTranslucent(mode === 'contact');
    if (this.needsContact) this.contact.setTotal(this.store.total);
    if (mode === 'cloth') this.cloth.hideField();
    if (mode === 'stretch' && !this.colouring.springs && this.scene.springs > 0) {
      const [ends, restLengths] = await Promise.all([readSprings(), readRestLengths()]);
      this.colouring.springs = { ends, restLengths };
      this.outdated = true;
    }
  }

  fitScale() {
    this.colouring.fitScale(this.mode, this.cloth.field);
    this.outdated = true;
  }

  // Advances playback and draws what is due. Returns true when another frame is shown than before.
  tick(seconds: number, more: boolean): boolean {
    const wanted = this.clock.advance(seconds, this.store.total, more, (frame) => this.isThere(frame));
    this.store.moveTo(wanted);
    if (this.needsContact) this.contact.moveTo(wanted);
    const moved = wanted !== this.shown;
    if (!moved && !this.outdated) return false;
    const positions = this.store.get(wanted);
    if (!positions) return false;
    this.outdated = false;
    const first = this.shown < 0;
    this.shown = wanted;
    this.cloth.setPositions(positions);
    this.solids.setFrame(wanted);
    this.colour();
    this.include(positions, first);
    this.stage.invalidate();
    return moved;
  }

  private colour() {
    if (this.mode === 'cloth') return;
    const field = this.cloth.field;
    const frames = { positions: (frame: number) => this.store.get(frame), contact: (frame: number) => this.contact.get(frame) };
    if (!this.colouring.fill(this.mode, this.shown, frames, field)) {
      this.outdated = true;
      return;
    }
    this.colouring.updateScale(this.mode, field);
    const { high, reversed, kinds } = this.colouring.scale(this.mode);
    if (kinds) this.cloth.showKinds();
    else this.cloth.showField(0, high, reversed);
    this.onScale();
  }

  // The ground goes below all that has been seen; some room to spare, so that it does not move with every frame.
  private include(positions: Float32Array, first: boolean) {
    const box = this.solids.extend(new THREE.Box3().setFromArray(positions), true);
    if (first) this.stage.frame(this.frameBox(positions), true);
    if (this.bounds.containsBox(box)) return;
    this.bounds.union(box);
    const size = this.bounds.getSize(new THREE.Vector3()).length();
    if (!first) this.bounds.expandByScalar(0.1 * size);
    this.solids.setReach(4 * size);
    this.stage.setBounds(this.bounds, !this.solids.hasPlane);
  }

  private frameBox(positions: Float32Array): THREE.Box3 {
    return this.solids.extend(new THREE.Box3().setFromArray(positions), false);
  }

  frameAll(fromFront = false) {
    const positions = this.store.get(this.shown);
    if (positions) this.stage.frame(this.frameBox(positions), fromFront);
  }

  close() {
    this.store.close();
    this.contact.close();
    this.stage.scene.remove(this.cloth.mesh, this.solids.group);
    this.cloth.dispose();
    this.solids.dispose();
    this.stage.invalidate();
  }
}
