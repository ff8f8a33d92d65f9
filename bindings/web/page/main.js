// The page: the worker ticks, a second instance of the module draws, and plots show the last seconds.
import {loadPalpate} from './palpate/palpate.js';
import {Controls, byId} from './controls.js';
import {drawForceOverDepth, drawStrip, History} from './plots.js';
import {listen, Steering} from './pointer.js';
import {EXERCISES, sceneText, TOLERANCE} from './scenes.js';
import {scoreOf, surfacePoint} from './search.js';
import {clamp, rotatedBack, sub} from './vectors.js';

const PULL_ROOM = 1.2;         // factor of the distance, for the tissue that a pull lifts
const MAP_RANGE = 10e-3;       // m
const PLOT_PERIOD = 40;        // ms
const WORDS_PERIOD = 100;      // ms, of numbers that people read
const SLOW_SHARE = 0.95;       // of real time
const LONGEST_RECORDING = 120; // s
const NO_WEBGL = 'This page draws with WebGL 2, which this browser does not offer. Switch on hardware acceleration in the ' +
  'browser\u2019s settings, or open the page in a current Chrome, Edge, Firefox or Safari.';
const LOST = 'The graphics driver was reset. Load the page again.';
const state = {
  palpate: null, sim: null, view: null, canvas: null, organ: null, snapshot: null, result: null,
  task: 'press', seed: 7, text: '', mode: 'demo', opened: false, asked: false, stale: true, replot: true,
  inclusions: [], marks: [], ended: false, law: null, recording: false,
  shown: 0, since: 0, plotted: 0, told: 0,
};
const history = new History(), steering = new Steering();
const worker = new Worker('worker.js', {type: 'module'});
const send = (what, fields = {}) => worker.postMessage({do: what, ...fields});
const stage = byId('stage'), picture = byId('picture');

const controls = new Controls({
  send, steering,
  take,
  jaws() {
    if (state.task !== 'pull' || !take()) return;
    steering.closed = !steering.closed;
    controls.jaws(steering.closed);
  },
  mark, finish,
  open: task => open(task, state.seed),
    restart: () => send('restart'),
  view(closeUp) { firstView(closeUp); },
  map(on) {
    state.view?.showDisplacement(on ? MAP_RANGE : 0);
    state.stale = true;
  },
  record,
});

/** The pointer takes the tool from the demonstration. @return whether the pointer moves the tool */
function take() {
  if (!state.opened || state.mode === 'haply') return false;
  if (state.mode === 'demo') {
    state.mode = 'pointer';
    send('take');
  }
  return true;
}

function say(words) {
  byId('message').hidden = !words;
  byId('message').textContent = words;
}

// ---- Scenes

function open(task, seed, demo = true) {
  Object.assign(state, {task, seed, opened: false, marks: [], ended: false});
  say(`Preparing the ${EXERCISES[task].organ}`);
  controls.exercise(task);
  send('open', {task, seed, demo});
  setTimeout(() => show(sceneText(task, seed, null)), 30);  // after the message is on the screen
}

/** Opens the scene in the page's own instance, which only draws. */
function show(text) {
  if (text === state.text || !state.palpate) return;
  state.view?.close();
  state.sim?.close();
  state.canvas?.remove();
  state.text = text;
  state.sim = state.palpate.open({scene: text, noHand: true});
  state.sim.tick([state.sim.scriptedSample(0, 0)]);  // the tool beside the organ until the first snapshot
  const {positions, picture: pose} = state.sim.surface();
  state.organ = {positions, position: pose.organPosition, orientation: pose.organOrientation};
  const canvas = state.canvas = document.createElement('canvas');
  canvas.addEventListener('webglcontextlost', () => { if (canvas === state.canvas) say(LOST); });
  picture.replaceChildren(canvas);
  resize();
  state.view = state.palpate.view(canvas, state.sim);
  if (byId('map').checked) state.view.showDisplacement(MAP_RANGE);
  state.snapshot = null;
  firstView(false);
  draw();
  say('');
  requestAnimationFrame(() => performance.mark('first picture'));
}

function firstView(closeUp) {
  if (!state.view) return;
  state.view.frame(closeUp);
  // From above the view already fits the picture's width, and moves back once more for a narrow picture.
  const narrow = picture.clientWidth / picture.clientHeight / (4 / 3);
  if (!closeUp && state.task === 'palpate' && narrow < 1) state.view.zoom(1.3 * narrow);
  if (!closeUp && state.task === 'pull') state.view.zoom(PULL_ROOM);
  state.stale = true;
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
  state.stale = false;
}

// ---- The search

function mark() {
  if (state.task !== 'palpate' || state.ended || !state.result || state.marks.length >= 16) return;
  state.marks.push(rotatedBack(state.organ.orientation, sub(state.result.contact, state.organ.position)));
  showMarks(state.marks.map(position => ({position, kind: 'found'})));  // no mark shows whether it is right
}

function showMarks(marks) {
  state.view.showMarks(marks);
  state.stale = true;
  controls.marks(state.marks.length);
}

function finish() {
  if (state.ended) return open('palpate', state.seed + 1, false);
  const hidden = state.inclusions.filter(inclusion => !inclusion.visible);
  const lumps = hidden.map(inclusion => surfacePoint(state.organ.positions, inclusion.position));
  const score = scoreOf(lumps, state.marks, TOLERANCE);
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
  opened(message) {
    Object.assign(state, {opened: true, mode: message.mode, inclusions: message.inclusions, recording: message.record});
    show(message.text);
    controls.opened(message);
  },
  begun(message) {
    Object.assign(state, {mode: message.mode, result: null, freshLever: true});
    history.clear();
    steering.take(message);
    controls.jaws(false);
    controls.begun(message.mode);
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
    if (state.freshLever) {
      state.freshLever = false;
      controls.lever(message.result.distance);
    }
    // Pseudo-haptics, as in the program's window: over stiff places the pointer moves the tool less (docs/lumps.md).
    steering.gain = state.task === 'palpate' && message.felt ? clamp(message.felt ** -3, 0.25, 1) : 1;
    const now = performance.now();
    if (message.fault || now - state.told >= WORDS_PERIOD) {
      state.told = now;
      controls.frame(message, state.task);
    }
    if (message.pace) controls.pace(message.pace, SLOW_SHARE);
    if (state.recording && message.result.time > LONGEST_RECORDING) record();
  },
  csv: message => save(message.text),
  haply: message => controls.haply(message),
  error(message) {
    if (!state.opened) say(message.words); else controls.trouble(message);
  },
};
worker.onmessage = ({data}) => hear[data.is](data);
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
    send('frame', steering.input);
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

async function begin() {
  if (!document.createElement('canvas').getContext('webgl2')) return say(NO_WEBGL);
  open('press', state.seed);
  try {
    state.palpate = await loadPalpate();
    show(sceneText(state.task, state.seed, null));
    requestAnimationFrame(animate);
  } catch (error) {
    say(error.message);
  }
}

listen(stage, picture, {
  view: () => state.view, steering, take,
  moved: () => { state.stale = true; },
  commands: {' ': () => controls.page.jaws(), m: mark, r: () => send('resetFault'), n: () => controls.toggleNoise(),
    Home: () => firstView(false), Enter: () => send('restart')},
});
addEventListener('resize', () => { state.replot = true; });
document.addEventListener('visibilitychange', () => send('pause', {on: document.hidden}));
addEventListener('pagehide', () => send('haply', {address: null}));
begin();
