// How fast a result is played:  node bench.mjs TAUT_PROGRAM WORK_FOLDER [NODES_A_SIDE [FRAMES [WIDTH HEIGHT]]]   (npm run bench in viewer/)
// A sheet with waves, 161 x 161 nodes unless told otherwise, 120 frames at 60 a second, in a headless Chromium without a graphics processor, in a
// window of 1280 x 720 unless told otherwise.
import { spawnSync } from 'node:child_process';
import { mkdirSync, rmSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { openPage, skip, startBrowser, waitForFrame, Workshop } from './harness.mjs';

const [program, folder, sideText, framesText, widthText, heightText] = process.argv.slice(2);
const side = Number(sideText ?? 161), frames = Number(framesText ?? 120), width = Number(widthText ?? 1280), height = Number(heightText ?? 720), nodes = side * side, seconds = 6;
const shop = new Workshop(program, folder);

function writeNpy(name, type, shape, numbers) {
  const dictionary = `{'descr': '${type}', 'fortran_order': False, 'shape': (${shape.join(', ')}${shape.length === 1 ? ',' : ''}), }`;
  const header = dictionary.padEnd(Math.ceil((dictionary.length + 11) / 64) * 64 - 11) + '\n';
  const start = Buffer.from('\x93NUMPY\x01\x00', 'latin1');
  const length = Buffer.alloc(2);
  length.writeUInt16LE(header.length);
  writeFileSync(join(shop.folder, 'sheet/frames', name), Buffer.concat([start, length, Buffer.from(header), Buffer.from(numbers.buffer)]));
}

// A results folder as docs/results.md describes it.
function makeResult() {
  rmSync(join(shop.folder, 'sheet'), { recursive: true, force: true });
  mkdirSync(join(shop.folder, 'sheet/frames'), { recursive: true });
  writeFileSync(
    join(shop.folder, 'sheet/scene.toml'),
    `title = "Waves"
[time]
step = ${1 / 60}
frames = ${frames}
[[cloth]]
grid = { nodes = [${side}, ${side}], origin = [0, 0, 0], u = [1, 0, 0], v = [0, 0, 1] }
density = 0.15
`,
  );
  writeFileSync(join(shop.folder, 'sheet/summary.json'), JSON.stringify({ status: 'finished', message: '' }));
  const columns = ['step', 'time', 'frame', 'iterations', 'bound_iterations', 'step_ms', 'assemble_ms', 'factor_ms', 'solve_ms', 'contact_ms', 'kinetic_J', 'elastic_J', 'max_stretch', 'contacts'];
  const rows = Array.from({ length: frames }, (_, k) => [k + 1, (k + 1) / 60, k + 1, ...columns.slice(3).map((_, c) => 2 + Math.sin(k / 9 + c))].join());
  writeFileSync(join(shop.folder, 'sheet/stats.csv'), [columns.join(), ...rows, ''].join('\n'));
  const triangles = [], springs = [], uv = [];
  for (let j = 0, k = 0; j < side; ++j)
    for (let i = 0; i < side; ++i, ++k) {
      uv.push(i / (side - 1), j / (side - 1));
      if (i + 1 < side) springs.push(k, k + 1);
      if (j + 1 < side) springs.push(k, k + side);
      if (i + 1 < side && j + 1 < side) triangles.push(k, k + 1, k + side + 1, k, k + side + 1, k + side);
    }
  writeNpy('triangles.npy', '<i4', [triangles.length / 3, 3], Int32Array.from(triangles));
  writeNpy('uv.npy', '<f4', [nodes, 2], Float32Array.from(uv));
  writeNpy('stretch_springs.npy', '<i4', [springs.length / 2, 2], Int32Array.from(springs));
  writeNpy('rest_lengths.npy', '<f4', [springs.length / 2], new Float32Array(springs.length / 2).fill(1 / (side - 1)));
  for (let frame = 0; frame <= frames; ++frame) {
    const time = (2 * Math.PI * frame) / frames, x = new Float32Array(3 * nodes);
    for (let k = 0; k < nodes; ++k) x.set([uv[2 * k], 0.15 * uv[2 * k + 1] * Math.sin(12 * uv[2 * k] + time) * Math.cos(9 * uv[2 * k + 1] - 2 * time), uv[2 * k + 1]], 3 * k);
    const name = String(frame).padStart(6, '0');
    writeNpy(`contact_${name}.npy`, '|u1', [nodes], Uint8Array.from({ length: nodes }, (_, k) => Number(uv[2 * k] < 0.5 + 0.4 * Math.sin(time))));
    writeNpy(`${name}.npy`, '<f4', [nodes, 3], x);
  }
}

const part = (values, share) => [...values].sort((a, b) => a - b)[Math.floor(share * (values.length - 1))];
const told = (values) => `median ${part(values, 0.5).toFixed(1)} ms, 95 of 100 below ${part(values, 0.95).toFixed(1)} ms`;

// Pictures that the browser has put on its screen, from its own trace.
async function countDisplayed(browser, during) {
  const session = await browser.newBrowserCDPSession();
  let count = 0;
  session.on('Tracing.dataCollected', ({ value }) => (count += value.filter(({ name }) => name === 'Display::FrameDisplayed').length));
  await session.send('Tracing.start', { traceConfig: { includedCategories: ['benchmark', 'viz', 'disabled-by-default-display.framedisplayed'] } });
  const result = await during();
  const complete = new Promise((done) => session.once('Tracing.tracingComplete', done));
  await session.send('Tracing.end');
  await complete;
  return { count, result };
}

async function measure(browser, address, key, name) {
  const page = await openPage(browser, address + '?timings', { viewport: { width, height } });
  await page.waitForFunction(() => document.querySelector('#stage').dataset.ready);
  await waitForFrame(page, 0);
  await page.keyboard.press(key);
  await page.keyboard.press(' ');
  await page.waitForTimeout(2000);
  const { count, result } = await countDisplayed(browser, () =>
    page.evaluate(
      (milliseconds) =>
        new Promise((done) => {
          const { work, draw } = window.tautTimings;
          const [first, begin] = [work.length, performance.now()];
          setTimeout(() => {
            const canvas = document.querySelector('#canvas');
            done({ seconds: (performance.now() - begin) / 1000, work: work.slice(first), draw: draw.slice(first), width: canvas.width, height: canvas.height });
          }, milliseconds);
        }),
      1000 * seconds,
    ),
  );
  const box = await page.locator('#canvas').boundingBox();
  console.log(`${name}
  frames shown a second        ${(result.work.length / result.seconds).toFixed(1)}
  pictures displayed a second  ${(count / result.seconds).toFixed(1)}
  the page's own work a frame  ${told(result.work)}
  drawing a frame              ${told(result.draw)}
  canvas                       ${result.width} x ${result.height} pixels, shown at ${box.width} x ${box.height}`);
  if (page.faults.length > 0) console.log(page.faults.join('\n'));
  await page.context().close();
}

makeResult();
const browser = await startBrowser([]);
const { address, child } = await shop.view('sheet').catch((error) => skip(error.message));
const cores = spawnSync('nproc', { encoding: 'utf8' }).stdout.trim();
console.log(`${nodes.toLocaleString('en')} nodes, ${(2 * (side - 1) ** 2).toLocaleString('en')} triangles, Chromium ${browser.version()}, ${cores} cores, no graphics processor`);
for (const [key, name] of [['1', 'plain colours'], ['2', 'by stretch'], ['3', 'by speed'], ['4', 'by contact']]) await measure(browser, address, key, name);
await browser.close();
child.kill('SIGINT');
