// What touches a node, from the bits that a run records: 1 a solid, 2 cloth, 4 held with its neighbours as a rigid body.

export const contactKinds = [
  { name: 'nothing', colour: 0xaeb6c0 },
  { name: 'solid', colour: 0xe69f00 },
  { name: 'cloth', colour: 0x0072b2 },
  { name: 'both', colour: 0x009e73 },
  { name: 'held in a rigid zone', colour: 0xcc3b3b },
];

const kindOfBits = Uint8Array.from({ length: 256 }, (_, bits) => (bits & 4 ? 4 : bits & 3));

// The number of its kind at each node.
export function kindField(bits: Uint8Array, out: Float32Array) {
  for (let k = 0; k < out.length; ++k) out[k] = kindOfBits[bits[k]];
}
