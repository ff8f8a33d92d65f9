// Runs the simulation beside the page: ticks at the scene's rate of wall-clock time, in small batches.
//
// The page asks for a frame per picture; the answer carries the snapshot of the newest tick and the rows since the last
// frame. The tool follows the scripted path ('demo'), rides on the organ under the page's pointer ('pointer'), repeats a
// recording ('replay') or follows an Inverse3 ('haply'). The riders are here, so that they move on with the ticks and not
// with the pictures.
import {HaplyError, HaplyLink} from './haply.js';
import {loadPalpate} from './palpate/palpate.js';
import {Playback, RecordingError} from './recording.js';
import {hasOwnTissue, optionsOf, TISSUE_SLIDERS} from './scenes.js';
import {add, clamp, norm, sub} from './vectors.js';

const BATCH = 4;            // ms between batches; browsers allow no shorter timer
const LONGEST_BATCH = 25;   // ms of simulated time; time beyond it is dropped and reported
const RIDE = 4;             // ticks between two steps of the riders
const CLICK = 40;           // ticks that a click closes the jaws or holds the marking button at least
const STALLED = 20;         // ms without a tick after which a device gets zero force (palpate.h)
const REST = 0.5;           // s between the end of the scripted path and its next beginning
const FAULT_STALLED_LOOP = 4;
const ROW = 6;              // numbers of a row: time, phase, depth, force at the hand, tissue force, noise
const CAPACITY = 4096;      // rows between two frames
const REPORT = 1000;        // ms between reports of the pace
const LEAST_DEPTH = 1e-3;   // m, of a felt stiffness
const SLOWEST = 0.25;       // least pace of the tool over stiff places
const FRESH = 3e-3, LATE = 8e-3;  // s, ages of an Inverse3's sample; over 5 ms is a fault
const ANOTHER = 2e-4;       // m: distances of a replay that differ by more are of another scene
const PULL = 2, INSERT = 3; // phases of a result
const ZERO = [0, 0, 0];

let palpate, sim, law, results, request, settings, link, recording;
let record = false, own = new Map();  // numbers of the scene's tissue
let riders = [], hands = [], hand = 0;  // per hand: rider; {rest, held, latched, least: ticks}. The pointer holds `hand`
let ray = null, lever = 0, dragging = false, marking = 0;
let anchor = ZERO;  // m, from the Inverse3 to the tool: the arm is at the path's start when the scene begins
let mode = 'demo', clock = 0, lastBatch = 0, tick = 0, paused = false, differs = false;
// Of the Inverse3: a sample came since the beginning; the last force was not zero; a sample is overdue.
let fresh = false, sentForce = false, late = false;
let count = 0;
const rows = new Float64Array(ROW * CAPACITY);
let simulated = 0, dropped = 0, busy = 0;  // ms since the last report

const handlers = {
  open(message) {
    if (message.demo && mode !== 'haply') mode = 'demo';
    const before = settings;
    settings = {tissue: null, values: new Map(), noise: null};
    try {
      openScene(message.request, false);
    } catch (error) {
      settings = before;
      throw error;
    }
  },
  frame() {
    if (mode !== 'haply') advance();
    postFrame();
  },
  /** The pointer takes over from script or recording, from the start of the path. */
  take() { if (mode === 'demo' || mode === 'replay') begin('pointer'); },
  demonstrate() { if (mode === 'pointer' || mode === 'replay') begin('demo'); },
  restart() { begin(mode); },
  /** The pointer's line of sight; null: it is elsewhere. */
  point(message) {
    ray = message.ray;
    riders[hand]?.pointAt(ray);
  },
  press({deeper}) {
    riders[hand]?.press(deeper);
    if (dragging) lever += deeper;
  },
  park() {
    const rider = riders[hand];
    rider?.park(!rider.parked);
  },
  grip({on}) {
    if (on) hands[hand].least = CLICK;
    hands[hand].held = on;
  },
  latch({on}) {
    hands[hand].latched = on;
    postMessage({is: 'jaws', closed: on});  // after what taking the tool has said
  },
  rest() { hands[hand].rest = 1 - hands[hand].rest; },
  mark() { marking = CLICK; },
  hand({which}) {
    if (which >= hands.length) return;
    riders[hand]?.pointAt(null);
    hands[hand].held = false;
    hand = which;
    count = 0;
    postMessage({is: 'hand', hand, closed: hands[hand].latched});
  },
  replay({recording: read}) {
    if (mode === 'haply') throw new RecordingError('The Inverse3 holds the tool: disconnect it first.');
    if (record) throw new RecordingError('A recording is being made: save it first.');
    if (read.hands !== sim.info.hands) {
      throw new RecordingError(`The recording has ${read.hands} hands, the open scene ${sim.info.hands}: open the scene it was made in first.`);
    }
    if (Math.abs(read.rate - sim.info.rate) > 0.01 * sim.info.rate) {
      throw new RecordingError(`The recording has ${read.rate.toFixed(0)} ticks a second, the open scene ${sim.info.rate}.`);
    }
    recording = new Playback(read);
    begin('replay');
  },
  record({on}) { openScene(request, on); },
  csv: () => postMessage({is: 'csv', text: sim.recordingCsv()}),
  /** @param name of a built-in tissue; null: the scene's own @param values of numbers that differ */
  tissue({name, values}) {
    const before = settings.tissue, changed = settings.values;
    Object.assign(settings, {tissue: name, values: new Map(values)});
    try {
      if (name === null && before !== null) return begin(mode);
      if (name !== null) sim.setTissue(name); else for (const field of changed.keys()) sim.setTissueValue(field, own.get(field));
      for (const [field, value] of values) sim.setTissueValue(field, value);
    } catch (error) {
      Object.assign(settings, {tissue: before, values: changed});  // a refused value is not applied again
      throw error;
    }
    setLaw();
  },
  tissueValue({field, value}) {
    sim.setTissueValue(field, value);
    settings.values.set(field, value);
    if (law) setLaw();
  },
  noise({noise}) {
    settings.noise = noise;
    sim.setNoise(noise);
  },
  resetFault() { sim.resetFault((1 << sim.info.hands) - 1); },
  pause({on}) {
    paused = on && mode !== 'haply';  // a held device has no pause
    if (!on) clock = performance.now();
  },
  haply({address}) {
    link?.close();
    link = null;
    postMessage({is: 'haply', address: ''});
    if (mode === 'haply') openScene(request, record);
    if (!address) return;
    link = new HaplyLink(address, {
      onReady: at => guarded('haply', () => {
        postHaply(at);
        if (mode !== 'haply') openScene(request, record); else at.send(ZERO);
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

/** @param serial of the request, of 'open' */
function guarded(what, act, serial) {
  try {
    act();
  } catch (error) {
    postMessage({is: 'error', of: what, words: error.message, serial});
    if (!(error.name === 'PalpateError' || error instanceof HaplyError || error instanceof RecordingError)) throw error;
  }
}

const loaded = loadPalpate().then(module => {
  palpate = module;
  loop();
});

onmessage = async ({data}) => {
  await loaded;
  guarded(data.do, () => handlers[data.do](data), data.request?.serial);
};

function openScene(wanted, records) {
  const haply = link?.connected ? link : null;
  const opened = palpate.open({...optionsOf(palpate.scenes, wanted, haply), noHand: !haply, record: records});
  closeRiders();
  if (sim) sim.close();
  [sim, request, record, tick, hand] = [opened, wanted, records, 0, 0];
  own = new Map(TISSUE_SLIDERS.map(({field}) => [field, sim.tissueValue(field)]));
  try {
    applySettings();
  } catch (error) {  // the scene before took them
    Object.assign(settings, {tissue: null, values: new Map()});
    postMessage({is: 'error', of: 'tissue', words: error.message});
  }
  if (haply) mode = 'haply';
  else if (mode === 'haply' || mode === 'replay') mode = 'pointer';
  postMessage({is: 'opened', request, record, mode, name: sim.name, scene: sim.scene, hands: sim.info.hands, rate: sim.info.rate,
    maxForce: sim.info.maxForce, remarks: sim.remarks, ownTissue: hasOwnTissue(wanted), inclusions: sim.inclusions(), noise: sim.noise()});
  setLaw();
  begin(mode);
}

function closeRiders() {
  for (const rider of riders) rider.close();
  riders = [];
}

/** Starts again at tick 0. */
function begin(next) {
  mode = next;
  if (tick > 0 && record) return openScene(request, record);  // a recording begins with its simulation
  if (tick > 0) {
    sim.restart();
    applySettings();
  }
  closeRiders();
  const rest = sim.scene.task === 'pull' ? 1 : 0;
  hands = Array.from({length: sim.info.hands}, () => ({rest, held: false, latched: false, least: 0}));
  if (mode === 'pointer') {
    riders = hands.map((_, i) => sim.rider(i));
    riders[hand].pointAt(ray);
    lever = riders[hand].depth;
  }
  [tick, count, results, dragging, marking, differs] = [0, 0, undefined, false, 0, false];
  clock = lastBatch = performance.now();
  if (mode === 'haply') {
    fresh = sentForce = false;
    link.send(ZERO);  // asks for a sample
  }
  postMessage({is: 'begun', mode});
}

/** Tissue and noise outlast a new beginning of the scene. */
function applySettings() {
  if (settings.tissue !== null) sim.setTissue(settings.tissue);
  for (const [field, value] of settings.values) sim.setTissueValue(field, value);
  if (settings.noise) sim.setNoise(settings.noise);
}

/** Law for the felt stiffness and the plot; null: the tissue is not built in, or has changed numbers. */
function setLaw() {
  const name = settings.tissue ?? (hasOwnTissue(request) ? null : sim.scene.tissue);
  law?.close();
  law = null;
  if (name !== null && !settings.values.size && palpate.tissueNames.includes(name)) {
    law = palpate.law(name, sim.scene.task === 'pull' ? 'pull' : 'press', sim.info.rate);
  }
  // A needle leaves the law at the puncture.
  const curve = law && sim.scene.task !== 'insert' && Array.from({length: 81}, (_, i) => [i / 4, law.forceAt(i / 4000).force]);
  const values = TISSUE_SLIDERS.map(({field}) => [field, sim.tissueValue(field)]);
  postMessage({is: 'tissue', curve, values});
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
    if (i % RIDE === 0) ride(Math.min(RIDE, due - i) * period / 1000);
    if (!tickOnce(stalled && i === 0)) return;
  }
  simulated += due * period;
  busy += performance.now() - now;
  if (mode === 'haply' && due > 0) passForce();
}

/** Moves the riders on. Over stiff places the tool goes more slowly: pseudo-haptics, as in the program's window (docs/lumps.md). */
function ride(seconds) {
  riders.forEach((rider, i) => {
    const result = results?.[i], closed = isClosed(hands[i]);
    const drags = closed && result?.phase === PULL;
    const felt = result && sim.scene.task === 'palpate' ? feltStiffness(result) : null;
    rider.move(seconds, {dragging: drags, pace: felt === null ? 1 : clamp(felt ** -3, SLOWEST, 1)});
    if (i !== hand) return;
    dragging = drags;
    if (!drags) lever = rider.depth;
  });
}

const isClosed = ({held, latched, least}) => held || latched || least > 0;

/** @return false when the demonstration began again */
function tickOnce(stalled) {
  const {rate, scriptedTicks} = sim.info;
  const end = mode === 'replay' ? recording.ticks : scriptedTicks;
  if ((mode === 'demo' || mode === 'replay') && tick >= end + REST * rate && !record) {
    begin(mode);
    return false;
  }
  results = sim.tick(hands.map((_, i) => sampleOfMode(i, stalled)), results);
  if (mode === 'replay') compare();
  tick++;
  for (const one of hands) one.least = Math.max(0, one.least - 1);
  marking = Math.max(0, marking - 1);
  if (count === CAPACITY) return true;
  const {time, phase, deviceForce, tissueForce, noiseForce} = results[hand];
  rows.set([time, phase, depthOf(results[hand]), norm(deviceForce), tissueForce, noiseForce], ROW * count++);
  return true;
}

function sampleOfMode(i, stalled) {
  if (mode === 'demo') return sim.scriptedSample(i, Math.min(tick, sim.info.scriptedTicks - 1));
  if (mode === 'replay') return recording.sample(i, Math.min(tick, recording.ticks - 1));
  if (mode === 'pointer') {
    const closed = isClosed(hands[i]);
    const sample = riders[i].advance(closed ? 0 : hands[i].rest);
    return {...sample, buttons: closed || (i === hand && marking > 0) ? 1 : 0};
  }
  const sample = link.sample();
  sample.position = add(sample.position, anchor);
  return stalled && !sample.fault ? {...sample, fault: FAULT_STALLED_LOOP} : sample;
}

/** Says once that a recording is not of the open scene. */
function compare() {
  if (differs || tick >= recording.ticks) return;
  const recorded = recording.distance(0, tick), here = results[0].distance;
  if (!(Math.abs(recorded - here) > ANOTHER)) return;
  differs = true;
  postMessage({is: 'differs', time: results[0].time, recorded, here});
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
    anchor = sub(sim.scriptedSample(0, 0).position, link.newest.position);
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

/** The depth that the page shows: with a needle inside, the way of its tip from the entry. */
const depthOf = ({phase, depth, distance}) => phase === INSERT ? -distance : depth;

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
  const snapshot = sim.snapshot(), sent = rows.slice(0, ROW * count), result = {...results[hand], depth: depthOf(results[hand])};
  count = 0;
  let pace = null;
  if (simulated + dropped >= REPORT) {
    pace = {share: simulated / (simulated + dropped), tickMicroseconds: 1000 * busy * 1000 / sim.info.rate / simulated};
    [simulated, dropped, busy] = [0, 0, 0];
  }
  const fault = results.find(one => one.fault)?.fault, words = fault ? palpate.describeFault(fault) : '';
  postMessage({is: 'frame', mode, snapshot, rows: sent, result, felt: feltStiffness(results[hand]), pace, lever, parked: Boolean(riders[hand]?.parked),
    fault: words && link?.trouble ? `${words} (${link.trouble})` : words}, [snapshot.buffer, sent.buffer]);
}
