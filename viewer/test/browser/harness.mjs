// A browser, the program and its results, for the tests beside this file.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { accessSync, constants, existsSync, mkdirSync, writeFileSync } from 'node:fs';
import { delimiter, join, resolve } from 'node:path';
import { decodePng } from './png.mjs';

// assert, but the test goes on, so that one run tells all that is wrong.
export const failures = [];
export const check = new Proxy(assert, {
  get: (target, name) => (...args) => {
    try {
      target[name](...args);
    } catch (error) {
      failures.push(error);
      console.log(`  FAILED: ${error.message.split('\n')[0]}${error.stack.match(/run\.mjs:\d+/) ? ' (' + error.stack.match(/run\.mjs:\d+/)[0] + ')' : ''}`);
    }
  },
});

export function skip(why) {
  console.log(`skipped: ${why}`);
  process.exit(77);
}

function findBrowser() {
  if (process.env.CHROMIUM) return process.env.CHROMIUM;
  for (const name of ['chromium', 'chromium-browser', 'google-chrome'])
    for (const folder of (process.env.PATH ?? '').split(delimiter)) {
      try {
        accessSync(join(folder, name), constants.X_OK);
        return join(folder, name);
      } catch {
        // the next one
      }
    }
  return null;
}

// By WebGL that the processor imitates, the same on every machine; without: as the browser draws by itself.
export const imitated = ['--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'];

export async function startBrowser(graphics = imitated) {
  const executablePath = findBrowser();
  if (!executablePath) skip('there is no Chromium here (Debian: chromium)');
  const playwright = await import('playwright-core').catch(() => skip('playwright-core is not installed: npm ci in viewer/'));
  const args = ['--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync', '--disable-extensions'];
  args.push(...graphics);
  return playwright.chromium.launch({ executablePath, args, chromiumSandbox: process.getuid?.() !== 0 });
}

export const scene = (frames, perFrame) => `title = "Test sheet"
[time]
step = 5e-3
frames = ${frames}
steps_per_frame = ${perFrame}
[[cloth]]
name = "sheet"
grid = { nodes = [21, 21], origin = [-0.5, -0.5, 0.42], u = [1, 0, 0], v = [0, 1, 0] }
density = 0.15
k_stretch = 500
[[cloth]]
name = "patch"
grid = { nodes = [8, 8], origin = [0.6, -0.2, 0.3], u = [0.3, 0, 0], v = [0, 0.1, 0.3] }
density = 0.15
k_stretch = 500
[[cloth.pin]]
edges = ["v1"]
[[solid]]
shape = "sphere"
radius = 0.4
friction = 0.5
thickness = 0.012
`;

export class Workshop {
  constructor(program, folder) {
    this.program = resolve(program);
    this.folder = resolve(folder);
    this.children = [];
    mkdirSync(folder, { recursive: true });
  }

  writeScene(name, frames, perFrame) {
    writeFileSync(join(this.folder, name), scene(frames, perFrame));
  }

  taut(...args) {
    const end = spawnSync(this.program, args, { cwd: this.folder, encoding: 'utf8' });
    if (end.status !== 0) throw new Error(`taut ${args.join(' ')} ended with ${end.status}: ${end.stderr}`);
  }

  start(...args) {
    const child = spawn(this.program, args, { cwd: this.folder, stdio: ['ignore', 'pipe', 'pipe'] });
    child.ended = new Promise((done) => child.on('exit', done));
    this.children.push(child);
    return child;
  }

  // The address that it prints.
  async view(result) {
    const child = this.start('view', result, '--no-open');
    let said = '';
    child.stderr.on('data', (text) => (said += text));
    const address = await new Promise((found, failed) => {
      child.stdout.on('data', (text) => {
        said += text;
        const match = said.match(/http:\S+/);
        if (match) found(match[0]);
      });
      child.on('exit', () => failed(new Error(`taut view ended: ${said}`)));
    });
    return { address, child };
  }

  has(name) {
    return existsSync(join(this.folder, name));
  }

  end() {
    for (const child of this.children) if (child.exitCode === null) child.kill('SIGKILL');
  }
}

// A page that watches for what must not happen: errors, and requests to anyone else.
export async function openPage(browser, address, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1100, height: 640 }, colorScheme: 'light', ...options });
  const page = await context.newPage();
  const origin = new URL(address).origin;
  page.faults = [];
  page.requests = 0;
  page.tolerated = () => false; // network errors while the server is gone
  page.on('console', (message) => {
    if (['error', 'warning'].includes(message.type()) && !page.tolerated(message.text())) page.faults.push(`console ${message.type()}: ${message.text()}`);
  });
  page.on('pageerror', (error) => page.faults.push(`error: ${error.message}`));
  page.on('request', (request) => {
    ++page.requests;
    if (new URL(request.url()).origin !== origin && !request.url().startsWith('data:')) page.faults.push(`request to ${request.url()}`);
  });
  await page.goto(address);
  return page;
}

// The stage's picture as soon as `holds` says that it is what is waited for; after five seconds whatever it shows then. A busy machine draws late.
export async function pictureThat(page, holds, file) {
  const deadline = Date.now() + 5000;
  for (;;) {
    const picture = await stagePicture(page, file);
    if (holds(picture) || Date.now() > deadline) return picture;
    await page.waitForTimeout(100);
  }
}

export const shownFrame = (page) => page.evaluate(() => Number(document.querySelector('#stage').dataset.frame ?? -1));
export const waitForFrame = (page, least, most = 1e9) =>
  page.waitForFunction(
    ([least, most]) => {
      const frame = Number(document.querySelector('#stage').dataset.frame ?? -1);
      return frame >= least && frame <= most;
    },
    [least, most],
    { timeout: 20000 },
  );
export const waitForStatus = (page, text) => page.waitForFunction((wanted) => document.querySelector('#status').textContent === wanted, text, { timeout: 20000 });

// The stage as pixels, after what was changed has been drawn.
export async function stagePicture(page, keepAs) {
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => requestAnimationFrame(done)))));
  // Of a stage that is played or grows there may never be a fine one.
  await page.waitForFunction(() => document.querySelector('#stage').dataset.picture !== 'hasty', null, { timeout: 1500 }).catch(() => {});
  return decodePng(await page.locator('#stage').screenshot(keepAs ? { path: keepAs } : {}));
}

// Where each plot's playhead stands, in pixels from the left of its plot.
export const playheads = (page) =>
  page.evaluate(() => [...document.querySelectorAll('.playhead')].map((head) => head.getBoundingClientRect().left - head.parentElement.getBoundingClientRect().left));
