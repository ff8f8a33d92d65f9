// Runs the simulation beside the page: ticks at the scene's rate of wall-clock time, in small batches.
//
// The page asks for a frame per picture; the answer carries the snapshot of the newest tick and the rows since the last
// frame. The tool follows the scripted path ('demo'), the page's pointer ('pointer') or an Inverse3 ('haply').
import {HaplyError, HaplyLink} from './haply.js';
import {loadPalpate} from './palpate/palpate.js';
import {EXERCISES, NOISE, sceneText, TISSUE_SLIDERS} from './scenes.js';
import {add, norm, sub} from './vectors.js';

const BATCH = 4;            // ms between batches; browsers allow no shorter timer
const LONGEST_BATCH = 25;   // ms of simulated time; time beyond it is dropped and reported
const STALLED = 20;         // ms without a tick after which a device gets zero force (palpate.h)
const REST = 0.5;           // s between the end of the scripted path and its next beginning
const FAULT_STALLED_LOOP = 4;
const ROW = 6;              // numbers of a row: time, phase, depth, force at the hand, tissue force, noise
const CAPACITY = 4096;      // rows between two frames
const REPORT = 1000;        // ms between reports of the pace
const LEAST_DEPTH = 1e-3;   // m, of a felt stiffness
const FRESH = 3e-3, LATE = 8e-3;  // s, ages of an Inverse3's sample; over 5 ms is a fault
const ZERO = [0, 0, 0];

let palpate, sim, law, follower, results, scene, settings, link;
let anchor = ZERO;  // m, from the Inverse3 to the tool: the arm is at the path's start when the scene begins
let mode = 'demo', target = ZERO, gripper = 0, buttons = 0;
let clock = 0, lastBatch = 0, tick = 0, epoch = 0, paused = false;
// Of the Inverse3: a sample came since the beginning; the last force was not zero; a sample is overdue.
let fresh = false, sentForce = false, late = false;
let count = 0;
const rows = new Float64Array(ROW * CAPACITY);
let simulated = 0, dropped = 0, busy = 0;  // ms since the last report

const handlers = {
  open({task, seed, demo}) {
    if (demo && mode !== 'haply') mode = 'demo';
    settings = {tissue: EXERCISES[task].organ, values: new Map(), noise: NOISE};
    openScene({task, seed, record: false});
  },
  frame(input) {
    // Input for an earlier beginning does not count.
    if (input.epoch === epoch) [target, gripper, buttons] = [input.target, input.gripper, input.buttons];
    if (mode !== 'haply') advance();
    postFrame();
  },
  /** The pointer takes over from the script, from the start of the path. */
  take() { if (mode === 'demo') begin('pointer'); },
  demonstrate() { if (mode === 'pointer') begin('demo'); },
  restart() { begin(mode); },
  record({on}) { openScene({...scene, record: on}); },
  csv: () => postMessage({is: 'csv', text: sim.recordingCsv()}),
  tissue({name}) {
    Object.assign(settings, {tissue: name, values: new Map()});
    sim.setTissue(name);
    setLaw(name);
  },
  tissueValue({field, value}) {
    settings.values.set(field, value);
    sim.setTissueValue(field, value);
    if (law) setLaw(null);
  },
  noise({noise}) {
    settings.noise = noise;
    sim.setNoise(noise);
  },
  resetFault() { sim.resetFault(1); },
  pause({on}) {
    paused = on && mode !== 'haply';  // a held device has no pause
    if (!on) clock = performance.now();
  },
  haply({address}) {
    link?.close();
    link = null;
    postMessage({is: 'haply', address: ''});
    if (mode === 'haply') openScene(scene);
    if (!address) return;
    link = new HaplyLink(address, {
      onReady: at => guarded('haply', () => {
        postHaply(at);
        if (mode !== 'haply') openScene(scene); else at.send(ZERO);
      }),
      onSample: exchange,
      onTrouble(at) {
        fresh = true;  // the next ticks latch the fault
        postHaply(at);
      },
    });
    postHaply(link);
  },
};

function guarded(what, act) {
  try {
    act();
  } catch (error) {
    postMessage({is: 'error', of: what, words: error.message});
    if (!(error.name === 'PalpateError' || error instanceof HaplyError)) throw error;
  }
}

const loaded = loadPalpate().then(module => {
  palpate = module;
  loop();
});

onmessage = async ({data}) => {
  await loaded;
  guarded(data.do, () => handlers[data.do](data));
};

function openScene({task, seed, record}) {
  const haply = link?.connected ? link : null;
  const text = sceneText(task, seed, haply);
  const opened = palpate.open({scene: text, noHand: !haply, record: Boolean(record)});
  if (sim) sim.close();
  sim = opened;
  scene = {task, seed, record: Boolean(record)};
  tick = 0;
  applySettings();
  setLaw(settings.values.size ? null : settings.tissue);
  if (haply) mode = 'haply';
  else if (mode === 'haply') mode = 'pointer';
  postMessage({is: 'opened', text, ...scene, mode, name: sim.name, rate: sim.info.rate, maxForce: sim.info.maxForce,
    remarks: sim.remarks, inclusions: sim.inclusions(), noise: settings.noise});
  begin(mode);
}

/** Starts again at tick 0. */
function begin(next) {
  mode = next;
  if (tick > 0 && scene.record) return openScene(scene);  // a recording begins with its simulation
  if (tick > 0) {
    sim.restart();
    applySettings();
  }
  follower = sim.follower(0);
  [target, gripper, buttons] = [follower.start, follower.gripper, 0];
  [tick, count, results] = [0, 0, undefined];
  clock = lastBatch = performance.now();
  if (mode === 'haply') {
    fresh = sentForce = false;
    link.send(ZERO);  // asks for a sample
  }
  postMessage({is: 'begun', mode, epoch: ++epoch, start: follower.start, axis: follower.axis, gripper: follower.gripper});
}

/** Tissue and noise outlast a new beginning of the scene. */
function applySettings() {
  if (settings.tissue !== EXERCISES[scene.task].organ) sim.setTissue(settings.tissue);
  for (const [field, value] of settings.values) sim.setTissueValue(field, value);
  if (settings.noise !== NOISE) sim.setNoise(settings.noise);
}

/** Law of a built-in tissue, for the felt stiffness and the plot; null: the tissue has changed numbers. */
function setLaw(name) {
  law?.close();
  law = name && palpate.law(name, EXERCISES[scene.task].direction, sim.info.rate);
  const curve = law && Array.from({length: 81}, (_, i) => [i / 4, law.forceAt(i / 4000).force]);
  const values = TISSUE_SLIDERS.map(({field}) => [field, sim.tissueValue(field)]);
  postMessage({is: 'tissue', name, curve, values});
}

function loop() {
  if (mode === 'haply') watch(); else advance();
  setTimeout(loop, BATCH);
}

/** Computes the ticks that are due. */
function advance() {
  if (!sim || paused || (mode === 'haply' && !fresh)) return;
  const now = performance.now(), period = 1000 / sim.info.rate;
  let due = Math.floor((now - clock) / period);
  const most = Math.ceil(LONGEST_BATCH / period);
  if (due > most) {
    dropped += (due - most) * period;
    clock += (due - most) * period;
    due = most;
  }
  const stalled = now - lastBatch >= STALLED;
  if (due > 0) lastBatch = now;
  for (let i = 0; i < due; i++) {
    clock += period;
    if (!tickOnce(stalled && i === 0)) return;
  }
  simulated += due * period;
  busy += performance.now() - now;
  if (mode === 'haply' && due > 0) passForce();
}

/** @return false when the demonstration began again */
function tickOnce(stalled) {
  const {rate, scriptedTicks} = sim.info;
  if (mode === 'demo' && tick >= scriptedTicks + REST * rate && !scene.record) {
    begin('demo');
    return false;
  }
  results = sim.tick([sampleOfMode(stalled)], results);
  tick++;
  if (count === CAPACITY) return true;
  const {time, phase, depth, deviceForce, tissueForce, noiseForce} = results[0];
  rows.set([time, phase, depth, norm(deviceForce), tissueForce, noiseForce], ROW * count++);
  return true;
}

function sampleOfMode(stalled) {
  if (mode === 'demo') return sim.scriptedSample(0, Math.min(tick, sim.info.scriptedTicks - 1));
  if (mode === 'pointer') return {...follower.advance(target, gripper), buttons};
  const sample = link.sample();
  sample.position = add(sample.position, anchor);
  return stalled && !sample.fault ? {...sample, fault: FAULT_STALLED_LOOP} : sample;
}

/** Sends the newest force to the Inverse3: one command a reply, but zero force at once. */
function passForce() {
  const force = results[0].deviceForce, zero = norm(force) === 0;
  if (link.awaits && !(zero && sentForce)) return;
  sentForce = !zero;
  link.send(force);
}

/** The ticks of an Inverse3 follow its samples: those that are due, and a command, which asks for the next sample. */
function exchange() {
  if (mode !== 'haply') return;
  if (!fresh) {
    fresh = true;
    anchor = sub(follower.start, link.newest.position);
    clock = lastBatch = performance.now();
  }
  late = false;
  advance();
  if (!link.awaits) setTimeout(askAgain, 1);  // no tick was due
}

function askAgain() {
  if (mode !== 'haply' || link.awaits) return;
  if (link.sample().age < FRESH) advance();
  if (!link.awaits) link.send(results ? results[0].deviceForce : ZERO);
}

/** Without samples the ticks go on, and latch a fault. A sample that waits behind this timer comes first. */
function watch() {
  if (!fresh || (link.connected && link.sample().age < LATE)) return;
  if (late || !link.connected) advance();
  late = true;
}

function postHaply({address, arm, grip, trouble, connected}) {
  postMessage({is: 'haply', address, arm, grip, trouble, connected});
}

/** Felt stiffness over that of the uniform tissue; null out of contact or without its law. */
function feltStiffness({phase, depth, tissueForce, friction}) {
  if (!law || phase === 0 || depth < LEAST_DEPTH) return null;
  return Math.sqrt(Math.max(0, tissueForce ** 2 - friction ** 2)) / law.forceAt(depth).force;
}

function postFrame() {
  if (!results) return postMessage({is: 'frame', rows: new Float64Array(0)});
  const snapshot = sim.snapshot(), sent = rows.slice(0, ROW * count), result = results[0];
  count = 0;
  let pace = null;
  if (simulated + dropped >= REPORT) {
    pace = {share: simulated / (simulated + dropped), tickMicroseconds: 1000 * busy * 1000 / sim.info.rate / simulated};
    [simulated, dropped, busy] = [0, 0, 0];
  }
  const words = result.fault ? palpate.describeFault(result.fault) : '';
  postMessage({is: 'frame', mode, snapshot, rows: sent, result, felt: feltStiffness(result), pace,
    fault: words && link?.trouble ? `${words} (${link.trouble})` : words}, [snapshot.buffer, sent.buffer]);
}
