// taut view in a real browser:  node run.mjs TAUT_PROGRAM WORK_FOLDER [page|webgl|live]
// Ends with 77 where there is no browser, no playwright-core or no built page; screenshots stay in WORK_FOLDER.
import { cpSync, mkdirSync, readdirSync, rmSync } from 'node:fs';
import { join } from 'node:path';
import { countPixels, difference } from './png.mjs';
import { check, failures, openPage, pictureThat, playheads, shownFrame, skip, stagePicture, startBrowser, waitForFrame, waitForStatus, Workshop } from './harness.mjs';

const [program, folder, part] = process.argv.slice(2);
rmSync(folder, { recursive: true, force: true });
const shop = new Workshop(program, folder);

const isCloth = (r, g, b) => b > 90 && b > r + 40 && b > g + 15; // the blue front in any light
const isPatch = (r, g, b) => r > 90 && r > g + 40 && r > b + 50 && b > 25; // the second cloth, in red
const isOrange = (r, g, b) => r > 130 && r > g + 30 && g > b + 60; // touched by a solid
const isGrey = (r, g, b) => r > 60 && r < 200 && Math.abs(r - g) < 16 && b > r && b < r + 40; // touched by nothing
const press = async (page, ...keys) => {
  for (const key of keys) await page.keyboard.press(key);
};
const label = (page) => page.textContent('#time');
const keep = (name) => join(folder, name + '.png');

// `quality`: high is drawn by WebGL, low by the page itself.
async function finishedRun(browser, quality) {
  const keep = (name) => join(folder, `${name}-${quality}.png`);
  if (!shop.has('done')) {
    shop.writeScene('scene.toml', 24, 4);
    shop.taut('run', 'scene.toml', '--out', 'done', '--quiet', '--no-picture');
  }
  const { address, child } = await shop.view('done').catch((error) => (/has not been built/.test(error.message) ? skip(error.message) : Promise.reject(error)));
  const page = await openPage(browser, address + `?quality=${quality}`);
  await waitForFrame(page, 0, 0);
  await waitForStatus(page, 'Finished');
  check.equal(await page.textContent('#title'), 'Test sheet');

  console.log('  the cloth is there, and the solid, on the ground');
  const start = await stagePicture(page, keep('start'));
  const all = start.width * start.height;
  check.ok(countPixels(start, isCloth) > 0.03 * all, 'no cloth to be seen');
  check.ok(countPixels(start, isCloth) < 0.6 * all, 'nothing but cloth');
  check.ok(countPixels(start, isPatch) > 0.002 * all, 'no second cloth in its own colour');

  console.log('  it plays, stops, scrubs');
  await press(page, ' ');
  await waitForFrame(page, 4);
  await press(page, ' ');
  const stopped = await shownFrame(page);
  check.equal(await page.getAttribute('#play', 'aria-label'), 'Play');
  await page.waitForTimeout(200);
  check.equal(await shownFrame(page), stopped);
  await press(page, 'Home');
  await waitForFrame(page, 0, 0);
  await press(page, 'ArrowRight', 'ArrowRight', 'ArrowLeft');
  await waitForFrame(page, 1, 1);
  await press(page, 'Shift+ArrowRight');
  await waitForFrame(page, 11, 11);
  await press(page, 'End');
  await waitForFrame(page, 24, 24);
  check.match(await label(page), /^0\.480 s/);
  const end = await pictureThat(page, (picture) => difference(start, picture) > 0.02, keep('end'));
  check.ok(difference(start, end) > 0.02, 'the last frame looks like the first');

  console.log('  the playheads follow the scrubber, and a click into a plot jumps');
  await page.waitForSelector('.playhead');
  const width = await page.evaluate(() => document.querySelector('.u-over').clientWidth);
  const scrub = async (share) => {
    const box = await page.locator('#scrubber').boundingBox();
    await page.mouse.click(box.x + 7 + share * (box.width - 14), box.y + box.height / 2);
    await waitForFrame(page, 24 * share, 24 * share);
    return playheads(page);
  };
  for (const share of [0.25, 0.75]) {
    const heads = await scrub(share);
    check.equal(heads.length, 5);
    for (const head of heads) check.ok(Math.abs(head - share * width) < 3, `playhead at ${head} of ${width}, scrubber at ${share}`);
  }
  const plot = await page.locator('.u-over').nth(1).boundingBox();
  await page.mouse.click(plot.x + plot.width / 2, plot.y + plot.height / 2);
  await waitForFrame(page, 12, 12);

  console.log('  each colouring looks different, with its legend');
  await press(page, 'End');
  await waitForFrame(page, 24, 24);
  const pictures = [end];
  for (const [key, mode, unit] of [['2', 'stretch', '%'], ['3', 'speed', 'm/s'], ['4', 'contact', 'Touched by']]) {
    await press(page, key);
    await page.waitForFunction((wanted) => document.querySelector(`#modes [aria-checked=true]`).dataset.mode === wanted, mode);
    const picture = await pictureThat(page, (taken) => pictures.every((other) => difference(taken, other) > 0.02), keep(mode));
    for (const other of pictures) check.ok(difference(picture, other) > 0.02, `${mode} looks like another colouring`);
    check.ok((await page.textContent('#legend-title')).endsWith(unit), mode);
    check.equal(await page.isVisible('#legend'), true);
    pictures.push(picture);
  }
  const contact = pictures[3];
  check.ok(countPixels(contact, isOrange) > 0.002 * all, 'no contact to be seen on the sphere');
  check.ok(countPixels(contact, isGrey) > 0.002 * all, 'all of the cloth touches');
  check.match(await page.textContent('#legend-ticks'), /nothing.*solid.*cloth/);
  await page.click('[data-mode=cloth]');
  check.ok(difference(await pictureThat(page, (taken) => difference(taken, end) < 0.01), end) < 0.01, 'back to plain colours');
  check.equal(await page.isVisible('#legend'), false);

  console.log('  wireframe, orbit, frame all, help, theme');
  await press(page, 'w');
  const wires = await pictureThat(page, (taken) => countPixels(taken, isCloth) < 0.8 * countPixels(end, isCloth), keep('wireframe'));
  check.ok(countPixels(wires, isCloth) < 0.8 * countPixels(end, isCloth), 'wires cover as much as the cloth');
  await press(page, 'w');
  const canvas = await page.locator('#canvas').boundingBox();
  await page.mouse.move(canvas.x + 200, canvas.y + 250);
  await page.mouse.down();
  await page.mouse.move(canvas.x + 320, canvas.y + 200, { steps: 4 });
  await page.mouse.up();
  check.ok(difference(await pictureThat(page, (taken) => difference(taken, end) > 0.02), end) > 0.02, 'dragging did not orbit');
  await page.mouse.wheel(0, 2000);
  await page.waitForTimeout(300);
  const far = countPixels(await stagePicture(page), isCloth);
  await press(page, 'f');
  const isNearer = (picture) => countPixels(picture, isCloth) > 1.3 * far;
  check.ok(isNearer(await pictureThat(page, isNearer)), 'frame all did not come nearer');
  await press(page, '?');
  check.equal(await page.isVisible('#help'), true);
  await press(page, 'Escape');
  check.equal(await page.isVisible('#help'), false);
  await press(page, 't');
  const isDark = (picture) => countPixels(picture, (r, g, b) => r + g + b < 180) > 0.3 * all;
  check.ok(isDark(await pictureThat(page, isDark, keep('dark'))), 'the dark theme is not dark');
  for (const head of await playheads(page)) check.ok(Math.abs(head - width) < 3, `playhead at ${head} of ${width} after the theme has changed`);

  console.log('  every control has a name');
  const nameless = await page.evaluate(() => [...document.querySelectorAll('button, input, select, #canvas, figure')].filter((control) =>
    !(control.getAttribute('aria-label') || control.textContent.trim() || control.labels?.length)).map((control) => control.outerHTML));
  check.deepEqual(nameless, []);
  check.deepEqual(page.faults, []);
  if (quality === 'low') return page.context().close();

  console.log('  when the server ends, the page says so and goes on');
  page.tolerated = (text) => /ERR_CONNECTION_REFUSED|ERR_CONNECTION_RESET|ERR_EMPTY_RESPONSE|ERR_CONTENT_LENGTH_MISMATCH/.test(text);
  child.kill('SIGINT');
  check.equal(await child.ended, 0);
  await waitForStatus(page, 'Disconnected');
  await press(page, 'Home');
  await waitForFrame(page, 0, 0);
  check.deepEqual(page.faults, []);
  await page.context().close();
}

async function withoutWebGl() {
  const poor = await startBrowser(['--disable-3d-apis']);
  const { address } = await shop.view('done');
  const page = await openPage(poor, address);
  await waitForFrame(page, 0, 0);
  check.equal(await page.evaluate(() => document.createElement('canvas').getContext('webgl2')), null);
  await press(page, 'End');
  await waitForFrame(page, 24, 24);
  check.ok(countPixels(await stagePicture(page, keep('without-webgl')), isCloth) > 2000, 'no cloth to be seen');
  check.deepEqual(page.faults, []);
  await poor.close();
}

async function olderResult(browser) {
  console.log('  without recorded contact, by distance');
  cpSync(join(folder, 'done'), join(folder, 'older'), { recursive: true });
  for (const file of readdirSync(join(folder, 'older/frames'))) if (file.startsWith('contact_')) rmSync(join(folder, 'older/frames', file));
  const { address } = await shop.view('older');
  const page = await openPage(browser, address);
  await waitForFrame(page, 0, 0);
  await press(page, 'End', '4');
  await waitForFrame(page, 24, 24);
  await page.waitForFunction(() => document.querySelector('#legend-title').textContent.endsWith('mm'));
  const isBright = (r, g, b) => r > 150 && g > 140 && b < 110; // the yellow end of viridis
  const touching = (picture) => countPixels(picture, isBright) > 1000;
  check.ok(touching(await pictureThat(page, touching, keep('older'))), 'no contact to be seen on the sphere');
  check.deepEqual(page.faults, []);
  await page.context().close();
}

async function runningRun(browser) {
  shop.writeScene('scene.toml', 24, 4);
  shop.writeScene('long.toml', 40000, 2);
  mkdirSync(join(folder, 'live'));
  const { address } = await shop.view('live');
  const page = await openPage(browser, address, { colorScheme: 'dark' });

  console.log('  an empty folder says so, and shows what comes without a reload');
  await waitForStatus(page, 'Empty');
  check.match(await page.textContent('#message'), /live holds no result yet/);
  const loads = [];
  page.on('framenavigated', () => loads.push(page.url()));
  let run = shop.start('run', 'long.toml', '--out', 'live', '--quiet', '--no-picture');
  await waitForStatus(page, 'Running');
  await waitForFrame(page, 3);
  check.equal(await page.isVisible('#message'), false);
  check.ok(countPixels(await stagePicture(page, keep('live')), isCloth) > 2000);

  console.log('  it follows the newest frame until it is scrubbed');
  const seen = await shownFrame(page);
  await waitForFrame(page, seen + 5);
  await press(page, 'Home');
  await waitForFrame(page, 0, 0);
  await page.waitForTimeout(900);
  check.equal(await shownFrame(page), 0);
  await press(page, 'n');
  await waitForFrame(page, seen + 6);
  await page.waitForSelector('.playhead');

  console.log('  a killed simulator is survived, and one that goes on is followed');
  run.kill('SIGKILL');
  await run.ended;
  await waitForStatus(page, 'Killed');
  await press(page, 'Home', ' ');
  await waitForFrame(page, 2);
  await press(page, ' ', 'End');
  await waitForFrame(page, seen);
  run = shop.start('resume', 'live', '--quiet', '--no-picture');
  await waitForStatus(page, 'Running');
  run.kill('SIGINT');
  await run.ended;
  await waitForStatus(page, 'Interrupted');

  console.log('  a new run in the same folder replaces the old one');
  page.tolerated = (text) => /status of 404|status of 500|ERR_CONTENT_LENGTH_MISMATCH|ERR_INCOMPLETE/.test(text); // frames that were just removed
  shop.taut('run', 'scene.toml', '--out', 'live', '--quiet', '--no-picture');
  await waitForStatus(page, 'Finished');
  await waitForFrame(page, 0, 24);
  check.match(await label(page), /of 24$/);
  check.deepEqual(loads, []);
  check.deepEqual(page.faults, []);
  await page.context().close();
}

const browser = await startBrowser();
try {
  const tests = {
    page: [['finished run, drawn by the page', (browser) => finishedRun(browser, 'low')], ['without WebGL', withoutWebGl], ['result of an older Taut', olderResult]],
    webgl: [['finished run, drawn by WebGL', (browser) => finishedRun(browser, 'high')]],
    live: [['running run', runningRun]],
  };
  for (const [name, test] of part ? tests[part] : Object.values(tests).flat()) {
    const begin = Date.now();
    console.log(name);
    await test(browser);
    console.log(`  ${((Date.now() - begin) / 1000).toFixed(1)} s`);
  }
} catch (error) {
  failures.push(error);
}
await browser.close();
shop.end();
for (const failure of failures) console.error(failure);
process.exit(failures.length > 0 ? 1 : 0);
