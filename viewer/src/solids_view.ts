import * as THREE from 'three';
import type { SolidInfo } from './api';
import { poseAt } from './fields';

function geometryOf(solid: SolidInfo): THREE.BufferGeometry {
  switch (solid.shape) {
    case 'sphere':
      return new THREE.SphereGeometry(solid.radius, 96, 48).rotateX(Math.PI / 2);
    case 'cylinder':
      return new THREE.CylinderGeometry(solid.radius, solid.radius, solid.height, 96).rotateX(Math.PI / 2);
    case 'box':
      return new THREE.BoxGeometry(...solid.size);
    default:
      return new THREE.CircleGeometry(1, 96); // a piece of a plane, front +z; setReach says how large
  }
}

export class SolidsView {
  readonly group = new THREE.Group();
  private readonly material = new THREE.MeshStandardMaterial({ roughness: 0.6 });
  private readonly planeMaterial = new THREE.MeshStandardMaterial({ roughness: 0.95, side: THREE.DoubleSide });
  private readonly drawn: { solid: SolidInfo; mesh: THREE.Mesh }[] = [];

  constructor(solids: readonly SolidInfo[]) {
    for (const solid of solids) {
      if (solid.shape === 'unknown') continue;
      const plane = solid.shape === 'plane';
      const mesh = new THREE.Mesh(geometryOf(solid), plane ? this.planeMaterial : this.material);
      mesh.castShadow = !plane;
      mesh.receiveShadow = true;
      this.group.add(mesh);
      this.drawn.push({ solid, mesh });
    }
    this.setFrame(0);
  }

  get hasPlane(): boolean {
    return this.drawn.some(({ solid }) => solid.shape === 'plane');
  }

  setColour(solid: number, plane: number) {
    this.material.color.setHex(solid);
    this.planeMaterial.color.setHex(plane);
  }

  // To see the cloth behind them.
  setTranslucent(on: boolean) {
    this.material.transparent = on;
    this.material.opacity = on ? 0.35 : 1;
    this.material.depthWrite = !on;
    this.material.needsUpdate = true;
  }

  setFrame(frame: number) {
    for (const { solid, mesh } of this.drawn) {
      const [x, y, z, qx, qy, qz, qw] = poseAt(solid, frame);
      mesh.position.set(x, y, z);
      mesh.quaternion.set(qx, qy, qz, qw);
    }
  }

  // How far planes are drawn.
  setReach(radius: number) {
    for (const { solid, mesh } of this.drawn) if (solid.shape === 'plane') mesh.scale.set(radius, radius, 1);
  }

  // The box grown to hold the solids where they are now: planes not, which have no end, nor, if so asked, those that move.
  extend(box: THREE.Box3, onlyResting: boolean): THREE.Box3 {
    this.group.updateMatrixWorld(true);
    for (const { solid, mesh } of this.drawn) {
      if (solid.shape === 'plane' || (onlyResting && solid.poses.length > 1)) continue;
      mesh.geometry.computeBoundingBox();
      if (mesh.geometry.boundingBox) box.union(mesh.geometry.boundingBox.clone().applyMatrix4(mesh.matrixWorld));
    }
    return box;
  }

  dispose() {
    for (const { mesh } of this.drawn) mesh.geometry.dispose();
    this.material.dispose();
    this.planeMaterial.dispose();
  }
}
