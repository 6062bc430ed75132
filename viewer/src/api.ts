// What `taut view` answers: see apps/taut/view/view_server.h. All addresses are relative, so that they keep the key in the page's own.

export type Status = 'empty' | 'starting' | 'running' | 'finished' | 'interrupted' | 'failed' | 'crashed';

export interface RunState {
  status: Status;
  message: string;
  folder: string;
  run: string; // changes when the folder is filled anew
  stats: string; // changes when stats.csv is replaced
  frames: number;
}

export interface ClothInfo {
  name: string;
  first_node: number;
  nodes: number;
  first_triangle: number;
  triangles: number;
}

// [x, y, z, qx, qy, qz, qw]
export type Pose = [number, number, number, number, number, number, number];

export interface SolidInfo {
  name: string;
  shape: 'sphere' | 'plane' | 'cylinder' | 'box' | 'mesh' | 'unknown';
  radius: number;
  height: number;
  size: [number, number, number];
  thickness: number;
  poses: Pose[];
}

export interface SceneInfo {
  title: string;
  folder: string;
  nodes: number;
  triangles: number;
  springs: number;
  uv: boolean;
  contact: boolean; // every frame has been recorded with what touches each node
  frame_s: number;
  frames_expected: number | null;
  cloths: ClothInfo[];
  solids: SolidInfo[];
  note: string;
}

export class ServerError extends Error {}

async function get(path: string): Promise<Response> {
  const response = await fetch('api/' + path);
  if (response.ok) return response;
  const told = await response.json().catch(() => ({}));
  throw new ServerError(typeof told.error === 'string' ? told.error : `status ${response.status}`);
}

const bytes = async (path: string) => (await get(path)).arrayBuffer();

export const readState = async (): Promise<RunState> => (await get('state')).json();
export const readScene = async (): Promise<SceneInfo> => (await get('scene')).json();
export const readTriangles = async () => new Uint32Array(await bytes('triangles'));
export const readUv = async () => new Float32Array(await bytes('uv'));
export const readSprings = async () => new Uint32Array(await bytes('springs'));
export const readRestLengths = async () => new Float32Array(await bytes('rest_lengths'));
export const readSolidTriangles = async (solid: number) => new Uint32Array(await bytes(`solid_triangles?solid=${solid}`));
export const readSolidPoints = async (solid: number) => new Float32Array(await bytes(`solid_points?solid=${solid}`));
export const readFrames = (first: number, count: number) => bytes(`frames?first=${first}&count=${count}`);

export const readContact = (first: number, count: number) => bytes(`contact?first=${first}&count=${count}`);

// The rows from a byte on, and which file they are of.
export async function readStats(from: number): Promise<{ text: string; bytes: number; file: string }> {
  const response = await get(`stats?from=${from}`);
  const content = await response.arrayBuffer();
  return { text: new TextDecoder().decode(content), bytes: content.byteLength, file: response.headers.get('Taut-Stats') ?? '' };
}
