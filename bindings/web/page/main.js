// The page: the worker ticks, a second instance of the module draws, and plots show the last seconds.
import {loadPalpate} from './palpate/palpate.js';
import {Controls, byId} from './controls.js';
import {builtinRequest, linkTo, requestOf, requestOfFiles} from './load.js';
import {drawMarks} from './marks.js';
import {drawForceOverDepth, drawStrip, History} from './plots.js';
import {listen} from './pointer.js';
import {readRecording} from './recording.js';
import {EXERCISES, optionsOf, organIn, textOf} from './scenes.js';
import {scoreOf, surfacePoint} from './search.js';
import {clamp, placeOf, rotatedBack, sub} from './vectors.js';

const MAP_RANGE = 10e-3;       // m
const PLOT_PERIOD = 40;        // ms
const WORDS_PERIOD = 100;      // ms, of numbers that people read
const SLOW_SHARE = 0.95;       // of real time
const LONGEST_RECORDING = 120; // s
const MOST_MARKS = 16;
const FIRST_SEED = 7;          // of the built-in search
const NO_WEBGL = 'This page draws with WebGL 2, which this browser does not offer. Switch on hardware acceleration in the ' +
  'browser\u2019s settings, or open the page in a current Chrome, Edge, Firefox or Safari.';
const LOST = 'The graphics driver was reset. Load the page again.';
const state = {
  palpate: null, sim: null, view: null, canvas: null, organ: null, snapshot: null, result: null,
  request: null, scene: null, shownRequest: null, mode: 'demo', opened: false, asked: false, stale: true, replot: true,
  inclusions: [], marks: [], ended: false, law: null, recording: false, closed: false,
  touched: false, pulled: false, viewUsed: false,  // since the beginning: the tissue was touched, pulled; the user moved the view
  shown: 0, since: 0, plotted: 0, told: 0,
};
const history = new History();
const worker = new Worker('worker.js', {type: 'module'});
let ray = null, aimed = false;  // the pointer's line of sight; whether there was one since the beginning
function send(what, fields = {}) {
  if (what === 'point') {
    ray = fields.ray;
    aimed ||= ray !== null;
  }
  worker.postMessage({do: what, ...fields});
}
const stage = byId('stage'), picture = byId('picture');
const task = () => state.scene?.task;

const controls = new Controls({
  send, takeByLever, mark, finish, record,
  jaws() {
    if (!controls.jawed || !take(true)) return;
    state.closed = !state.closed;
    send('latch', {on: state.closed});
    controls.jaws(state.closed);
  },
  openScene: name => attempt(async () => open(await builtinRequest((await loaded).scenes, name, new URL('scenes/', location)))),
  restart: () => send('restart'),
  view: firstView,
  map(on) {
    state.view?.showDisplacement(on ? MAP_RANGE : 0);
    state.stale = true;
  },
  drape(on) {
    state.view?.showDrape(on);
    state.stale = true;
  },
  marks() { state.stale = true; },
  hand: which => send('hand', {which}),
  tissueNames: () => state.palpate?.tissueNames ?? [],
  link: copyLink,
  files: openFiles,
});

/** Whether the pointer holds the tool. @param fromDemonstration takes it from demonstration or recording */
function take(fromDemonstration) {
  if (!state.opened || state.mode === 'haply') return false;
  if (state.mode === 'pointer') return true;
  if (!fromDemonstration) return false;
  state.mode = 'pointer';
  send('take');
  return true;
}

/** Place of the organ nearest to the tool [m], world frame. */
const nearest = () => state.result?.contact ?? state.sim.surface().picture.organPosition;

/** Takes the tool for lever and keys, which say no place: without one it goes to the nearest. */
function takeByLever() {
  const had = take(false);
  if (!take(true)) return false;
  if (had && aimed) return true;
  const {x, y} = placeOf(state.view.camera, picture.clientWidth / picture.clientHeight, nearest());
  send('point', {ray: state.view.ray(x, y)});
  return true;
}

function say(words) {
  byId('message').hidden = !words;
  byId('message').textContent = words;
}

/** Runs what opens something; an error stays in words over the picture, or on it if something is open. */
async function attempt(act) {
  try {
    controls.fileNote('');
    await act();
  } catch (error) {
    failed(error.message);
  }
}

function failed(words) {
  controls.fileNote(words);
  if (state.view && state.request) {
    say('');
    controls.note(words);
  } else {
    say(words);
    if (location.search) byId('message').append(document.createElement('br'), firstLink());
  }
}

// ---- Scenes

let serial = 0;  // of requests

/** @param request as load.js makes it */
function open(request, demo = true) {
  request = {...request, serial: ++serial};
  Object.assign(state, {opened: false, marks: [], ended: false, wanted: request});
  const {scenes} = state.palpate ?? {};
  say(`Preparing the ${request.organ ?? (scenes ? organIn(textOf(scenes, request)) : EXERCISES.press.organ)} \u2026`);
  controls.opening();
  send('open', {request, demo});
}

/** Opens the scene in the page's own instance, which only draws. */
function show(request) {
  if (request === state.shownRequest || !state.palpate) return;
  state.view?.close();
  state.sim?.close();
  state.canvas?.remove();
  [state.view, state.sim, state.shownRequest] = [null, null, request];
  state.sim = state.palpate.open({...optionsOf(state.palpate.scenes, request, null), noHand: true});
  // The tools beside the organ until the first snapshot.
  state.sim.tick(Array.from({length: state.sim.info.hands}, (_, hand) => state.sim.scriptedSample(hand, 0)));
  const {positions, picture: pose} = state.sim.surface();
  state.organ = {positions, position: pose.organPosition, orientation: pose.organOrientation};
  const canvas = state.canvas = document.createElement('canvas');
  canvas.addEventListener('webglcontextlost', () => { if (canvas === state.canvas) say(LOST); });
  picture.replaceChildren(canvas);
  resize();
  state.view = state.palpate.view(canvas, state.sim);
  if (byId('map').checked) state.view.showDisplacement(MAP_RANGE);
  state.view.showDrape(byId('drape').checked);
  Object.assign(state, {snapshot: null, scene: state.sim.scene});
  const builtin = state.palpate.scenes.find(({name}) => name === request.builtin);
  controls.exercise(state.scene, state.sim.name, request.organ || request.tissue ? '' : builtin?.line, request.builtin);
  firstView(false);
  draw();
  say('');
  requestAnimationFrame(() => performance.mark('first picture'));
}

/** The view of the window's start, or nearer. */
function firstView(closeUp) {
  if (!state.view) return;
  state.view.frame(closeUp);
  // From above the view already fits the picture's width, and moves back once more for a narrow picture.
  const narrow = picture.clientWidth / picture.clientHeight / (4 / 3);
  if (!closeUp && task() === 'palpate' && narrow < 1) state.view.zoom(1.3 * narrow);
  Object.assign(state, {stale: true, viewUsed: closeUp});
}

function resize() {
  const ratio = devicePixelRatio || 1;
  const [w, h] = [picture.clientWidth, picture.clientHeight].map(side => clamp(Math.round(side * ratio), 1, 4096));
  if (!state.canvas || (state.canvas.width === w && state.canvas.height === h)) return;
  [state.canvas.width, state.canvas.height] = [w, h];
  state.stale = true;
}

function draw() {
  if (state.snapshot) state.view.draw(state.snapshot); else state.view.draw();
  drawMarks(byId('overlay'), state.view, controls.marksShown);
  // A tool under the pointer is inside the picture.
  state.stale = state.mode !== 'pointer' && !state.viewUsed && state.view.keepInFrame();
}

// ---- Files and links

function openFiles(files) {
  attempt(async () => {
    const {request, recording} = await requestOfFiles(files, state.request, name => controls.unitOf(name));
    if (request) open(request);
    if (!recording) return;
    send('replay', {recording: readRecording(recording)});
    controls.fileNote(`${files[0].name} plays in the open scene.`);
  });
}

async function copyLink() {
  const link = linkTo(location.href, state.request, state.request.seed);
  if (!link) return controls.fileNote('A file of this computer has no address: put it on a server, and open it by ?scene=, ?organ= or ?tissue=.');
  try {
    await navigator.clipboard.writeText(link);
    controls.fileNote(`Copied: ${link}`);
  } catch {
    controls.fileNote(link);  // the browser does not let the page copy
  }
}

// ---- The search

function mark() {
  if (task() !== 'palpate' || state.ended || state.marks.length >= MOST_MARKS) return;
  if (!state.result?.phase) return controls.note('Nothing is marked: the tool does not touch the tissue.');
  state.marks.push(rotatedBack(state.organ.orientation, sub(state.result.contact, state.organ.position)));
  send('mark');
  showMarks(state.marks.map(position => ({position, kind: 'found'})));  // no mark shows whether it is right
}

function showMarks(marks) {
  state.view.showMarks(marks);
  state.stale = true;
  controls.marks(state.marks.length);
}

function finish() {
  if (state.ended) {
    const seed = Number(state.request.seed ?? FIRST_SEED) + 1;
    return open({...state.request, seed}, false);
  }
  const hidden = state.inclusions.filter(inclusion => !inclusion.visible);
  const lumps = hidden.map(inclusion => surfacePoint(state.organ.positions, inclusion.position));
  const score = scoreOf(lumps, state.marks, state.scene.tolerance);
  state.ended = true;
  state.view.showInclusions(hidden);
  showMarks([...state.marks.map((position, i) => ({position, kind: score.kinds[i]})),
    ...lumps.map(position => ({position, kind: 'lump'}))]);
  controls.score(score);
}

// ---- Recording

function record() {
  if (!state.recording) return send('record', {on: true});
  state.recording = false;
  send('csv');
}

function save(text) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(new Blob([text], {type: 'text/csv'}));
  link.download = `palpate-${new Date().toISOString().slice(0, 19).replaceAll(':', '')}.csv`;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  send('record', {on: false});
}

// ---- Messages of the worker

const hear = {
  async opened(message) {
    await loaded;
    if (message.request.serial !== state.wanted?.serial) return;  // another scene was chosen meanwhile
    const fresh = state.wanted !== state.request;
    try {
      show(state.wanted);
    } catch (error) {
      return failed(error.message);
    }
    Object.assign(state, {opened: true, request: state.wanted, mode: message.mode, inclusions: message.inclusions, recording: message.record});
    controls.opened(message, fresh);
  },
  begun(message) {
    Object.assign(state, {mode: message.mode, result: null, closed: false, touched: false, pulled: false});
    aimed = ray !== null;
    history.clear();
    controls.jaws(false);
    controls.begun(task());
    controls.hint(state.mode, false, false, false);
    state.replot = true;
  },
  tissue(message) {
    state.law = message.curve;
    controls.tissue(message);
  },
  frame(message) {
    state.asked = false;
    if (!message.result || !state.opened) return;  // of the scene before
    history.add(message.rows);
    Object.assign(state, {snapshot: message.snapshot, result: message.result, stale: true, replot: true});
    state.touched ||= message.result.phase !== 0;
    state.pulled ||= message.result.phase === 2;
    const now = performance.now();
    if (message.fault || now - state.told >= WORDS_PERIOD) {
      state.told = now;
      controls.frame(message, task());
      controls.hint(state.mode, state.touched, state.pulled, message.result.phase === 3);
    }
    if (message.pace) controls.pace(message.pace, SLOW_SHARE);
    if (state.recording && message.result.time > LONGEST_RECORDING) record();
  },
  jaws({closed}) {
    state.closed = closed;
    controls.jaws(closed);
  },
  hand({hand, closed}) {
    history.clear();
    state.closed = closed;
    controls.hand(hand);
    controls.jaws(closed);
  },
  csv: message => save(message.text),
  haply: message => controls.haply(message),
  differs({time, recorded, here}) {
    const mm = metres => (1e3 * metres).toFixed(1);
    controls.fileNote(`The recording is of another scene than the open one: at ${time.toFixed(2)} s the tool was ${mm(recorded)} mm from the tissue, here it is ${mm(here)} mm.`);
  },
  error(message) {
    if (message.of === 'haply') return controls.trouble(message);
    if (message.of === 'open') {
      if (message.serial !== state.wanted?.serial) return;  // another scene was chosen meanwhile
      // The scene before is still open.
      Object.assign(state, {wanted: state.request, opened: state.request !== null});
      if (state.opened) controls.begun(task());
    }
    failed(message.words);
  },
};
// One message after another, also while one waits for the module.
let heard = Promise.resolve();
worker.onmessage = ({data}) => { heard = heard.then(() => hear[data.is](data)).catch(error => reportError(error)); };
worker.onerror = event => say(`The simulation stopped: ${event.message}. Load the page again.`);

// ---- Pictures

function count(now) {
  state.shown++;
  if (now - state.since < 1000) return;
  controls.frames(state.shown * 1000 / (now - state.since));
  [state.shown, state.since] = [0, now];
}

function animate(now) {
  requestAnimationFrame(animate);
  if (state.opened && !state.asked) {
    state.asked = true;
    send('frame');
  }
  if (!state.view) return;
  count(now);
  resize();
  if (state.stale) draw();
  if (state.replot && now - state.plotted >= PLOT_PERIOD) plot(now);
}

function plot(now) {
  Object.assign(state, {replot: false, plotted: now});
  const colours = controls.colours();
  drawStrip(byId('force_plot'), history, {column: 'force', factor: 1, least: 0.5, colour: colours.force}, colours);
  drawStrip(byId('depth_plot'), history, {column: 'depth', factor: 1e3, least: 5, colour: colours.depth, unitX: 's'}, colours);
  if (byId('felt').clientWidth) drawForceOverDepth(byId('felt_plot'), history, state.law, colours);
}

const loaded = document.createElement('canvas').getContext('webgl2') ? loadPalpate() : new Promise(() => say(NO_WEBGL));

async function begin() {
  const first = {builtin: 'press', text: null, link: {scene: 'press'}};
  // Without a wish in the address the worker opens the first scene while the page loads its own instance.
  if (!location.search) open(first);
  try {
    state.palpate = await loaded;
    controls.scenes = state.palpate.scenes;
    requestAnimationFrame(animate);
    if (location.search) {
      say('Loading \u2026');
      await requestOf(location.search, state.palpate.scenes, location.href).then(request => open(request ?? first));
    }
    show(state.wanted);
  } catch (error) {
    failed(error.message);
  }
}

/** A link to the page without its wishes, for a wrong address. */
function firstLink() {
  const link = document.createElement('a');
  [link.href, link.textContent] = [location.pathname, 'Open the first scene'];
  return link;
}

const toggled = id => () => { byId(id).click(); };
listen(stage, picture, {
  view: () => state.view, send, take, takeByLever,
  nearest,
  moved: () => Object.assign(state, {stale: true, viewUsed: true}),
  primary(down) {
    if (task() !== 'palpate') send('grip', {on: down}); else if (down) mark();
  },
  touched() { controls.touch = true; },
  commands: {
    ' ': () => controls.page.jaws(), g: () => { if (controls.jawed && take(true)) send('rest'); }, f: () => { if (take(true)) send('park'); },
    m: mark, r: () => send('resetFault'), n: () => controls.toggleNoise(),
    a: toggled('show_force'), b: toggled('show_scale'), x: toggled('show_axes'), d: toggled('drape'),
    c: toggled('show_section'), i: toggled('show_inside'),
    ...Object.fromEntries([1, 2, 3, 4].map(number => [number, () => send('hand', {which: number - 1})])),
    'Ctrl+z': () => controls.undo(), 'Ctrl+y': () => controls.redo(), 'Ctrl+Shift+z': () => controls.redo(),
    Home: () => firstView(false), Enter: () => send('restart'),
  },
});
addEventListener('resize', () => { state.replot = true; });
document.addEventListener('visibilitychange', () => send('pause', {on: document.hidden}));
addEventListener('pagehide', () => send('haply', {address: null}));
begin();
