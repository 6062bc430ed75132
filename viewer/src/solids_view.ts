import * as THREE from 'three';
import { readSolidPoints, readSolidTriangles, type SolidInfo } from './api';
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

// A solid that is a mesh: where its vertices are at each frame, or once if it never moves.
interface MeshSolid {
  geometry: THREE.BufferGeometry;
  points: Float32Array;
  shown: number;
}

function showSample(solid: MeshSolid, frame: number) {
  const positions = solid.geometry.getAttribute('position') as THREE.BufferAttribute;
  const values = positions.array.length;
  const sample = Math.min(frame, solid.points.length / values - 1);
  if (sample === solid.shown) return;
  solid.shown = sample;
  (positions.array as Float32Array).set(solid.points.subarray(sample * values, (sample + 1) * values));
  positions.needsUpdate = true;
  solid.geometry.computeVertexNormals();
  solid.geometry.computeBoundingBox();
  solid.geometry.computeBoundingSphere();
}

export class SolidsView {
  readonly group = new THREE.Group();
  private readonly material = new THREE.MeshStandardMaterial({ roughness: 0.6 });
  private readonly planeMaterial = new THREE.MeshStandardMaterial({ roughness: 0.95 });
  // Meshes may be open, and their triangles turned either way.
  private readonly meshMaterial = new THREE.MeshStandardMaterial({ roughness: 0.6, side: THREE.DoubleSide });
  private readonly drawn: { solid: SolidInfo; mesh: THREE.Mesh }[] = [];

  private readonly meshes: MeshSolid[] = [];
  private frame = 0;

  constructor(solids: readonly SolidInfo[]) {
    for (const solid of solids) {
      if (solid.shape === 'unknown' || solid.shape === 'mesh') continue;
      const plane = solid.shape === 'plane';
      const mesh = new THREE.Mesh(geometryOf(solid), plane ? this.planeMaterial : this.material);
      mesh.castShadow = !plane;
      mesh.receiveShadow = true;
      this.group.add(mesh);
      this.drawn.push({ solid, mesh });
    }
    this.setFrame(0);
  }

  // Fetches the solids that are meshes.
  async loadMeshes(solids: readonly SolidInfo[]) {
    const numbers = solids.flatMap((solid, k) => (solid.shape === 'mesh' ? [k] : []));
    await Promise.all(
      numbers.map(async (k) => {
        const [triangles, points] = await Promise.all([readSolidTriangles(k), readSolidPoints(k)]);
        let vertices = 0;
        for (const vertex of triangles) vertices = Math.max(vertices, vertex + 1);
        const geometry = new THREE.BufferGeometry();
        geometry.setIndex(new THREE.BufferAttribute(triangles, 1));
        geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(3 * vertices), 3));
        const mesh = new THREE.Mesh(geometry, this.meshMaterial);
        mesh.castShadow = mesh.receiveShadow = true;
        this.group.add(mesh);
        this.meshes.push({ geometry, points, shown: -1 });
      }),
    );
    this.setFrame(this.frame);
  }

  get hasPlane(): boolean {
    return this.drawn.some(({ solid }) => solid.shape === 'plane');
  }

  setColour(solid: number, plane: number) {
    this.material.color.setHex(solid);
    this.meshMaterial.color.setHex(solid);
    this.planeMaterial.color.setHex(plane);
  }

  // To see the cloth behind them.
  setTranslucent(on: boolean) {
    for (const material of [this.material, this.meshMaterial]) {
      material.transparent = on;
      material.opacity = on ? 0.35 : 1;
      material.depthWrite = !on;
      material.needsUpdate = true;
    }
  }

  setFrame(frame: number) {
    this.frame = frame;
    for (const mesh of this.meshes) showSample(mesh, frame);
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
    for (const { geometry, points } of this.meshes) {
      const rests = points.length === geometry.getAttribute('position').array.length;
      if (geometry.boundingBox && (rests || !onlyResting)) box.union(geometry.boundingBox);
    }
    return box;
  }

  dispose() {
    for (const { mesh } of this.drawn) mesh.geometry.dispose();
    for (const { geometry } of this.meshes) geometry.dispose();
    this.material.dispose();
    this.meshMaterial.dispose();
    this.planeMaterial.dispose();
  }
}
