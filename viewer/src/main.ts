import './style.css';
import { readState, ServerError, type RunState } from './api';
import { modes, type Mode } from './colouring';
import { icons } from './icons';
import { bindKeys } from './keys';
import { showLegend } from './legend';
import { darkPalette, lightPalette } from './palette';
import { plottedColumns, PlotPanel } from './plots';
import { chooseQuality } from './quality';
import { Session } from './session';
import { Stage } from './stage';
import { StatsFollower } from './stats';
import { emptyMessage, statusChip, type Trouble } from './status';
import { wantedTimings } from './timings';

const element = <T extends HTMLElement = HTMLElement>(id: string) => document.getElementById(id) as T;
const button = (id: string) => element<HTMLButtonElement>(id);
const press = (id: string, pressed: boolean) => element(id).setAttribute('aria-pressed', String(pressed));

const scrubber = element<HTMLInputElement>('scrubber');
const stageElement = element('stage');
const panel = new PlotPanel(element('panel'));
const stage = new Stage(stageElement, element<HTMLCanvasElement>('canvas'), chooseQuality());

let session: Session | null = null;
let stats = new StatsFollower(plottedColumns);
let state: RunState | null = null;
let mode: Mode = 'cloth';
let wireframe = false;
let following = true;
let dark = matchMedia('(prefers-color-scheme: dark)').matches;

// ---- what is shown -----------------------------------------------------------------------------------------------------------------------

const palette = () => (dark ? darkPalette : lightPalette);
const isRunning = () => state?.status === 'running' || state?.status === 'starting';

function showTheme() {
  document.documentElement.dataset.theme = dark ? 'dark' : 'light';
  element('theme').textContent = dark ? 'Light' : 'Dark';
  session?.setPalette(palette());
  panel.build();
}

function showPlayButton() {
  const playing = session?.clock.playing ?? false;
  const play = button('play');
  play.innerHTML = playing ? icons.pause : icons.play;
  play.setAttribute('aria-label', playing ? 'Pause' : 'Play');
}

function showFrame() {
  if (!session || session.shownFrame < 0) return;
  const frame = session.shownFrame;
  const last = Math.max((session.scene.frames_expected ?? session.frames) - 1, session.frames - 1);
  const time = frame * session.scene.frame_s;
  scrubber.max = String(last);
  if (document.activeElement !== scrubber || !scrubber.matches(':active')) scrubber.value = String(frame);
  scrubber.setAttribute('aria-valuetext', `frame ${frame} of ${last}, ${time.toFixed(3)} seconds`);
  element('time').innerHTML = `<b>${time.toFixed(3)} s</b> <span class="faint">frame ${frame} of ${last}</span>`;
  element('loaded').style.width = `${last > 0 ? (100 * (session.frames - 1)) / last : 100}%`;
  stageElement.dataset.frame = String(frame);
  panel.setTime(time);
}

function showModes() {
  for (const choice of document.querySelectorAll<HTMLButtonElement>('#modes button')) {
    const offered = choice.dataset.mode as Mode;
    const why = session?.colouring.available(offered) ?? null;
    choice.setAttribute('aria-checked', String(offered === mode));
    choice.tabIndex = offered === mode ? 0 : -1;
    choice.disabled = why !== null;
    if (why !== null) choice.title = why;
  }
  showLegend(mode === 'cloth' || !session ? null : session.colouring.scale(mode));
}

function showState(trouble: Trouble | null) {
  const chip = statusChip(state, trouble);
  const status = element('status');
  if (status.textContent !== chip.text) status.textContent = chip.text;
  status.dataset.kind = chip.kind;
  status.title = chip.detail;
  element('follow').hidden = !isRunning();
  press('follow', following);
  const message = session ? '' : trouble?.message || (state ? emptyMessage(state) : '');
  element('message').textContent = message;
  element('message').hidden = message === '';
}

function showNote(note: string) {
  element('note').textContent = note;
  element('note').hidden = note === '';
}

function showScene() {
  if (!session) return;
  const { title, folder, nodes, triangles, solids, note } = session.scene;
  element('title').textContent = title || folder;
  element('facts').textContent = `${nodes.toLocaleString('en')} nodes, ${triangles.toLocaleString('en')} triangles`;
  document.title = `${title || folder} – Taut`;
  const undrawn = solids.filter((solid) => solid.shape === 'unknown').map((solid) => solid.name);
  showNote([note, undrawn.length > 0 ? `Not drawn: ${undrawn.join(', ')}` : ''].filter(Boolean).join('\n'));
  stageElement.dataset.ready = 'true';
}

// ---- what can be done --------------------------------------------------------------------------------------------------------------------

const actions = {
  play() {
    if (!session) return;
    const clock = session.clock;
    clock.playing = !clock.playing;
    // From the end one wants to see it again.
    if (clock.playing && clock.frame >= session.frames - 1 && !isRunning()) clock.jump(0);
    showPlayButton();
  },
  jump(frame: number) {
    if (!session || session.frames === 0) return;
    const last = session.frames - 1;
    session.clock.jump(Math.min(Math.max(Math.round(frame), 0), last));
    following = session.clock.frame === last;
    press('follow', following);
  },
  step(frames: number) {
    if (!session) return;
    session.clock.playing = false;
    showPlayButton();
    actions.jump(session.clock.frame + frames);
  },
  first: () => actions.jump(0),
  last: () => actions.jump(Infinity),
  setMode(chosen: Mode) {
    if (!session || session.colouring.available(chosen) !== null) return;
    mode = chosen;
    stageElement.dataset.mode = mode;
    void session.setMode(mode);
    showModes();
  },
  wireframe() {
    wireframe = !wireframe;
    press('wireframe', wireframe);
    session?.setWireframe(wireframe);
  },
  frameAll: () => session?.frameAll(),
  loop() {
    if (!session) return;
    session.clock.loop = !session.clock.loop;
    press('loop', session.clock.loop);
  },
  follow() {
    following = !following;
    press('follow', following);
    if (following) actions.last();
  },
  plots() {
    const hidden = document.body.classList.toggle('no-panel');
    press('panel-button', !hidden);
  },
  theme() {
    dark = !dark;
    showTheme();
  },
  help() {
    const dialog = element<HTMLDialogElement>('help');
    if (dialog.open) dialog.close();
    else dialog.showModal();
  },
};

function bind() {
  button('play').onclick = actions.play;
  button('back').onclick = () => actions.step(-1);
  button('forward').onclick = () => actions.step(1);
  button('back').innerHTML = icons.back;
  button('forward').innerHTML = icons.forward;
  button('wireframe').onclick = actions.wireframe;
  button('frame-all').onclick = actions.frameAll;
  button('loop').onclick = actions.loop;
  button('follow').onclick = actions.follow;
  button('panel-button').onclick = actions.plots;
  button('theme').onclick = actions.theme;
  button('help-button').onclick = actions.help;
  button('legend-fit').onclick = () => session?.fitScale();
  scrubber.oninput = () => actions.jump(Number(scrubber.value));
  element<HTMLSelectElement>('speed').onchange = (event) => {
    if (session) session.clock.speed = Number((event.target as HTMLSelectElement).value);
  };
  for (const choice of document.querySelectorAll<HTMLButtonElement>('#modes button')) choice.onclick = () => actions.setMode(choice.dataset.mode as Mode);
  element('modes').onkeydown = (event) => {
    const step = event.key === 'ArrowRight' ? 1 : event.key === 'ArrowLeft' ? -1 : 0;
    if (!step) return;
    event.preventDefault();
    event.stopPropagation();
    const open = modes.filter((each) => session?.colouring.available(each) === null);
    actions.setMode(open[(open.indexOf(mode) + step + open.length) % open.length]);
    document.querySelector<HTMLElement>('#modes [aria-checked=true]')?.focus();
  };
  // After a click with the mouse the space bar plays; who comes by keyboard keeps it for the button.
  document.addEventListener('pointerup', (event) => (event.target as HTMLElement).closest?.('button')?.blur());
  bindKeys({
    ' ': actions.play,
    ArrowLeft: (event) => actions.step(event.shiftKey ? -10 : -1),
    ArrowRight: (event) => actions.step(event.shiftKey ? 10 : 1),
    Home: actions.first,
    End: actions.last,
    1: () => actions.setMode('cloth'),
    2: () => actions.setMode('stretch'),
    3: () => actions.setMode('speed'),
    4: () => actions.setMode('contact'),
    w: actions.wireframe,
    f: actions.frameAll,
    l: actions.loop,
    n: () => isRunning() && actions.follow(),
    p: actions.plots,
    t: actions.theme,
    '?': actions.help,
  });
  panel.jump = (time) => session && actions.jump(time / session.scene.frame_s);
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', (event) => {
    dark = event.matches;
    showTheme();
  });
}

// ---- what the simulator does meanwhile ---------------------------------------------------------------------------------------------------

async function openSession() {
  const old = session;
  session = null;
  old?.close();
  stats = new StatsFollower(plottedColumns);
  const opened = await Session.open(stage, palette());
  session = opened;
  opened.clock.speed = Number(element<HTMLSelectElement>('speed').value);
  opened.setWireframe(wireframe);
  opened.onTrouble = showNote;
  opened.onScale = () => showLegend(mode === 'cloth' ? null : opened.colouring.scale(mode));
  if (opened.colouring.available(mode) !== null) mode = 'cloth';
  void opened.setMode(mode);
  stageElement.dataset.mode = mode;
  showScene();
  showModes();
  showPlayButton();
}

async function update() {
  const previous = state;
  state = await readState();
  if (state.frames > 0 && (!session || previous?.run !== state.run)) await openSession();
  if (state.frames === 0 && session && previous?.run !== state.run) {
    session.close();
    session = null;
    delete stageElement.dataset.ready;
  }
  if (!session) return;
  const grown = session.frames !== state.frames;
  const atEnd = session.frames === 0 || session.clock.frame >= session.frames - 1;
  session.setTotal(state.frames);
  if (grown && isRunning() && following && !session.clock.playing && atEnd) session.clock.jump(state.frames - 1);
  if (grown) showFrame();
  if (state.stats && (await stats.update())) {
    panel.show(stats.table, ((session.scene.frames_expected ?? 1) - 1) * session.scene.frame_s);
  }
}

async function watch() {
  for (;;) {
    let trouble: Trouble | null = null;
    try {
      await update();
    } catch (error) {
      trouble = error instanceof ServerError ? { kind: 'unreadable', message: error.message } : { kind: 'gone', message: '' };
    }
    showState(trouble);
    await new Promise((done) => setTimeout(done, isRunning() && !trouble ? 400 : 1500));
  }
}

const timings = wantedTimings();
let last = performance.now();
function tick(now: number) {
  const seconds = (now - last) / 1000;
  last = now;
  const begin = performance.now();
  let moved = false;
  if (session) {
    const playing = session.clock.playing;
    moved = session.tick(seconds, isRunning());
    if (moved) showFrame();
    if (playing !== session.clock.playing) showPlayButton();
  }
  const drawing = performance.now();
  stage.draw();
  if (moved) timings?.note(drawing - begin, performance.now() - drawing);
  requestAnimationFrame(tick);
}

bind();
showTheme();
showPlayButton();
showModes();
void watch();
requestAnimationFrame(tick);
