// Colours of what is drawn in space, by theme. Those of the page itself are in style.css.

export interface Palette {
  cloths: { front: number; back: number }[];
  solid: number;
  ground: number;
  groundLine: number;
  skyLight: number;
  floorLight: number;
  shadow: number;
}

// Front and back tell a fold's two sides apart; as in the contact sheets.
const cloths = [
  { front: 0x3a7cbd, back: 0xe9a040 },
  { front: 0xb5533c, back: 0x6fae9e },
  { front: 0x5b8c3e, back: 0xb77fb5 },
  { front: 0x7a62b3, back: 0xc9b458 },
];

export const lightPalette: Palette = {
  cloths,
  solid: 0xc9c6c0,
  ground: 0xdfe3e8,
  groundLine: 0xb4bcc6,
  skyLight: 0xffffff,
  floorLight: 0xc4c0ba,
  shadow: 0.22,
};

export const darkPalette: Palette = {
  cloths,
  solid: 0x9a9894,
  ground: 0x23272d,
  groundLine: 0x3d444d,
  skyLight: 0xe8eefc,
  floorLight: 0x6a6762,
  shadow: 0.5,
};
