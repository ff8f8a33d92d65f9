// Tests of the npm package in Node: node --test bindings/web/test
// PALPATE_WEB: folder of the package (tools/make_web), default build/npm. PALPATE_PROGRAM: the native program,
// default build/release/app/palpate.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {mkdtempSync, readFileSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import path from 'node:path';
import test from 'node:test';
import {fileURLToPath, pathToFileURL} from 'node:url';

const root = fileURLToPath(new URL('../../..', import.meta.url));
const packageFolder = path.resolve(process.env.PALPATE_WEB ?? path.join(root, 'build/npm'));
const program = process.env.PALPATE_PROGRAM ?? path.join(root, 'build/release/app/palpate');
const {loadPalpate, PalpateError} = await import(pathToFileURL(path.join(packageFolder, 'palpate.js')));
const palpate = await loadPalpate();

/** The native program's CSV of the same run. */
function nativeCsv(...flags) {
  const folder = mkdtempSync(path.join(tmpdir(), 'palpate-'));
  try {
    const recording = path.join(folder, 'run.h5');
    execFileSync(program, ['run', '--offline', '--record', recording, ...flags], {stdio: 'pipe'});
    execFileSync(program, ['export', recording, '--csv', path.join(folder, 'run.csv')], {stdio: 'pipe'});
    return readFileSync(path.join(folder, 'run.csv'), 'utf8');
  } finally {
    rmSync(folder, {recursive: true});
  }
}

/** Columns of a CSV as text; the native run's durations are not compared. */
function columns(csv) {
  const rows = csv.trimEnd().split('\n').filter((line) => !line.startsWith('#')).map((line) => line.split(','));
  return new Map(rows[0].map((name, i) => [name, rows.slice(1).map((row) => row[i])]));
}

/** Ticks along the scripted motion. @return results of the first hand */
function play(simulation, ticks = simulation.info.scriptedTicks) {
  const results = [];
  for (let tick = 0; tick < ticks; ++tick) {
    const samples = [];
    for (let hand = 0; hand < simulation.info.hands; ++hand) samples.push(simulation.scriptedSample(hand, tick));
    results.push(simulation.tick(samples)[0]);
  }
  return results;
}

/** The error that a call throws. */
function errorOf(call) {
  try {
    call();
  } catch (error) {
    assert.ok(error instanceof PalpateError, String(error));
    return error;
  }
  return assert.fail('no error');
}

for (const task of ['press', 'pull']) {
  test(`a scripted ${task} gives every column of the native run bit for bit`, () => {
    const native = columns(nativeCsv('--task', task));
    const simulation = palpate.open({task, noHand: true, record: true});
    play(simulation, native.get('tick').length);
    const here = columns(simulation.recordingCsv());
    simulation.close();
    assert.deepEqual([...here.keys()], [...native.keys()]);
    assert.ok(Math.max(...here.get('depth_m').map(Number)) > 0.01);
    for (const [name, values] of native) {
      if (name !== 'tick_ns' && name !== 'late_ns') assert.deepEqual(here.get(name), values, name);
    }
  });
}

/** Columns of the CSV that hold a field of a result. */
const axes = (name, unit) => ['x', 'y', 'z'].map((axis) => `${name}_${axis}${unit}`);
const RECORDED = {
  tick: 'tick', time: 'time_s', gripperForce: 'gripper_force_N', force: axes('force', '_N'), torque: axes('torque', '_N_m'),
  tissueForce: 'tissue_force_N', noiseForce: 'noise_force_N', friction: 'friction_N', distance: 'distance_m', depth: 'depth_m',
  contact: axes('contact', '_m'), normal: axes('normal', ''), toolPosition: axes('tool', '_m'),
  toolOrientation: ['tool_qw', 'tool_qx', 'tool_qy', 'tool_qz'], gripper: 'gripper', energy: 'energy_J', engagement: 'engagement',
  cutoffLayer: 'cutoff_layer', saturated: 'saturated', status: 'status', fault: 'fault',
};

test('the CSV holds the results of the ticks', () => {
  const simulation = palpate.open({task: 'pull', noHand: true, record: true});
  const results = play(simulation, 3000);
  const csv = columns(simulation.recordingCsv());
  for (const [field, column] of Object.entries(RECORDED)) {
    const recorded = [column].flat().map((name) => csv.get(name).map(Number));
    const felt = recorded.map((_, axis) => results.map((result) => [result[field]].flat()[axis]));
    assert.deepEqual(recorded, felt, field);
  }
  assert.deepEqual(Object.keys(results[0]).filter((field) => !(field in RECORDED)), ['deviceForce', 'deviceTorque', 'phase']);
  play(simulation, 1);
  assert.equal(columns(simulation.recordingCsv()).get('tick').length, 3001);
  simulation.close();
});

test('results of an earlier tick are filled again', () => {
  const simulation = palpate.open({noHand: true});
  const samples = [simulation.scriptedSample(0, 0)];
  const results = simulation.tick(samples);
  const [first] = results;
  const {force} = first;
  assert.equal(simulation.tick(samples, results), results);
  assert.equal(results[0], first);
  assert.equal(results[0].force, force);
  assert.equal(results[0].tick, 1);
  simulation.close();
});

test('info describes the built-in press', () => {
  const simulation = palpate.open();
  const {info} = simulation;
  assert.equal(info.hands, 1);
  assert.equal(info.held, 1);
  assert.equal(info.rate, 1000);
  assert.equal(info.maxForce, 20);
  assert.equal(info.seed, 1n);
  assert.equal(simulation.name, 'gallbladder press');
  assert.match(simulation.remarks[0], /device host: its stability/);
  assert.equal(simulation.surface().positions.length, 3 * info.vertices);
  assert.equal(simulation.surface().triangles.length, 3 * info.triangles);
  simulation.close();
});

test('a held hand feels nothing before it was still outside the tissue', () => {
  const simulation = palpate.open();
  const results = play(simulation);
  assert.equal(results[0].engagement, 0);
  assert.equal(Math.max(...results.map((result) => result.engagement)), 1);
  simulation.close();
});

test('errors have the message of the C interface', () => {
  assert.match(errorOf(() => palpate.open({scene: '[scene]\ntask = "push"'})).message, /task = .*push.*press/);
  assert.equal(errorOf(() => palpate.open({scene: 'x = 1'})).kind, 'input');
  assert.match(errorOf(() => palpate.open({surfaceEdge: 2})).message, /surface_edge/);
  assert.match(errorOf(() => palpate.law('stone', 'press')).message, /stone/);
  assert.match(errorOf(() => palpate.noiseSample({gain: 1, threshold: 0})).message, /threshold/);
});

test('wrong calls are refused before they reach the module', () => {
  const simulation = palpate.open({noHand: true});
  assert.match(errorOf(() => simulation.tick([])).message, /samples: 0, must be 1/);
  assert.match(errorOf(() => simulation.tick([{}])).message, /position/);
  assert.match(errorOf(() => simulation.scriptedSample(0, -1)).message, /tick = -1/);
  assert.match(errorOf(() => simulation.recordingCsv()).message, /record/);
  assert.match(errorOf(() => palpate.open({files: {'../a': ''}})).message, /\.\.\/a/);
  simulation.close();
  assert.match(errorOf(() => simulation.tick([{position: [0, 0, 0]}])).message, /closed/);
  simulation.close();
});

test('a sample that is not finite latches a fault with zero force until it is reset', () => {
  const simulation = palpate.open({noHand: true});
  play(simulation, 2500);
  const [faulty] = simulation.tick([{position: [NaN, 0, 0]}]);
  assert.equal(faulty.fault, 1);
  assert.match(palpate.describeFault(1), /not finite/);
  const sample = simulation.scriptedSample(0, 2501);
  for (let i = 0; i < 100; ++i) simulation.tick([sample]);
  assert.deepEqual(simulation.tick([sample])[0].deviceForce, [0, 0, 0]);
  simulation.resetFault(1);
  assert.equal(simulation.tick([sample])[0].fault, 0);
  simulation.close();
});


test('an inclusion moves and changes its stiffness', () => {
  const simulation = palpate.open({task: 'palpate', noHand: true});
  const [before] = simulation.inclusions();
  const position = before.position.map((x) => x + 0.001);
  simulation.setInclusion(0, {position, stiffnessRatio: 3});
  play(simulation, 1);
  const [after] = simulation.inclusions();
  assert.deepEqual(after, {...before, position, stiffnessRatio: 3});
  assert.match(errorOf(() => simulation.setInclusion(0, {stiffnessRatio: 1000})).message, /1000/);
  assert.equal(errorOf(() => simulation.setInclusion(99, {stiffnessRatio: 2})).kind, 'use');
  simulation.close();
});

test('two simulations at once do not change each other', () => {
  const alone = palpate.open({noHand: true});
  const expected = play(alone, 2500).map((result) => result.force);
  alone.close();
  const press = palpate.open({noHand: true});
  const pull = palpate.open({task: 'pull', noHand: true});
  for (let tick = 0; tick < 2500; ++tick) {
    const [result] = press.tick([press.scriptedSample(0, tick)]);
    assert.deepEqual(result.force, expected[tick]);
    pull.tick([pull.scriptedSample(0, tick)]);
  }
  press.close();
  pull.close();
});

test('restart repeats the same forces', () => {
  const simulation = palpate.open({noHand: true});
  const first = play(simulation, 2500).map((result) => result.force);
  simulation.restart();
  assert.deepEqual(play(simulation, 2500).map((result) => result.force), first);
  simulation.close();
});

test('closing a simulation frees its memory', () => {
  const use = () => {
    const simulation = palpate.open({noHand: true, record: true, progress: () => {}});
    simulation.follower(0);
    simulation.rider(0);
    play(simulation, 300);
    simulation.snapshot();
    simulation.surface();
    simulation.close();
  };
  use();
  const before = palpate.memoryInUse();
  for (let i = 0; i < 3; ++i) use();
  assert.ok(palpate.memoryInUse() - before < 4096, `${palpate.memoryInUse() - before} bytes more`);
});

test('a scene reads its files by their relative path', () => {
  // A regular tetrahedron of 60 mm.
  const mesh = 'v 30 30 30\nv 30 -30 -30\nv -30 30 -30\nv -30 -30 30\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n';
  const scene = '[organ]\nmesh = "meshes/organ.obj"\nunit = "mm"\ntissue = "liver"\n[tool]\nmesh = "sphere:5"\n';
  const simulation = palpate.open({scene, files: {'meshes/organ.obj': mesh}, noHand: true});
  assert.equal(simulation.info.triangles > 0, true);
  simulation.close();
  assert.match(errorOf(() => palpate.open({scene})).message, /meshes\/organ\.obj/);
});

test('an exception of the progress function reaches the caller', () => {
  assert.throws(() => palpate.open({progress: () => { throw new RangeError('stop'); }}), RangeError);
});

test('a follower approaches its target no faster than a hand', () => {
  const simulation = palpate.open({noHand: true});
  const follower = simulation.follower(0);
  const target = follower.start.map((x, i) => x + 0.02 * follower.axis[i]);
  let sample = null;
  let fastest = 0;
  for (let i = 0; i < 1000; ++i) {
    sample = follower.advance(target, 0);
    fastest = Math.max(fastest, Math.hypot(...sample.velocity));
  }
  assert.ok(fastest <= 0.1 + 1e-12 && fastest > 0.05, `${fastest} m/s`);
  const [result] = simulation.tick([sample]);
  for (let i = 0; i < 3; ++i) assert.ok(Math.abs(result.toolPosition[i] - target[i]) < 1e-6);
  const far = follower.withinReach(follower.start.map((x, i) => x - follower.axis[i]));
  assert.ok(Math.abs(Math.hypot(...far.map((x, i) => x - follower.start[i])) - 0.15) < 1e-12);
  simulation.close();
});

test('a rider keeps its set depth while its pointer moves over the organ', () => {
  const simulation = palpate.open({noHand: true});
  const rider = simulation.rider(0);
  assert.ok(Math.abs(rider.depth + 0.005) < 1e-12);
  const depths = [];
  let results;
  for (let step = 0; step < 1500; ++step) {
    // From above the gallbladder's middle, up to 20 mm to both sides.
    rider.pointAt({origin: [0.02 * Math.sin(step / 200), 0, 0.3], direction: [0, 0, -1]});
    if (step === 400) rider.press(0.010);
    rider.move(0.004);
    for (let tick = 0; tick < 4; ++tick) results = simulation.tick([rider.advance(0)], results);
    if (step < 400) assert.equal(results[0].phase, 0, 'a touch before the press');
    if (step > 550) depths.push(1e3 * results[0].depth);
  }
  assert.ok(Math.min(...depths) > 4.7 && Math.max(...depths) < 5.3, `${Math.min(...depths)} to ${Math.max(...depths)} mm`);
  rider.pointAt(null);
  rider.park(true);
  for (let step = 0; step < 400; ++step) {
    rider.move(0.004);
    for (let tick = 0; tick < 4; ++tick) results = simulation.tick([rider.advance(0)], results);
  }
  assert.ok(rider.parked && results[0].distance > 0.02, `${results[0].distance} m`);
  rider.close();
  assert.match(errorOf(() => rider.move(0.004)).message, /closed/);
  simulation.close();
});

test('the built-in scenes open, and say what they are about', () => {
  assert.deepEqual(palpate.scenes.map(({name}) => name).slice(0, 3), ['press', 'pull', 'find-the-lump']);
  assert.ok(palpate.tissueNames.includes('heart-muscle'));
  const files = {'held-tool.csv': readFileSync(path.join(root, 'examples/held-tool.csv'))};
  const about = Object.fromEntries(palpate.scenes.map(({name, toml}) => {
    const simulation = palpate.open({scene: toml, files, noHand: true});
    const {scene, info} = simulation;
    simulation.close();
    return [name, {...scene, hands: info.hands}];
  }));
  assert.deepEqual([about.pull.task, about.pull.organ, about.pull.jaws], ['pull', 'heart', true]);
  assert.deepEqual([about['find-the-lump'].lumps, about['find-the-lump'].tolerance], [3, 0.01]);
  assert.equal(about.bimanual.hands, 2);
});

test('organ, tissue and seed replace those of a scene', () => {
  const [press] = palpate.scenes;
  const simulation = palpate.open({scene: press.toml, organ: 'kidney', tissue: 'heart', seed: 12, noHand: true});
  assert.deepEqual([simulation.scene.organ, simulation.scene.tissue, simulation.info.seed], ['kidney', 'heart', 12n]);
  simulation.close();
  assert.match(errorOf(() => palpate.open({scene: press.toml, seed: '-1', noHand: true})).message, /seed = -1: must be a whole number/);
  assert.match(errorOf(() => palpate.open({scene: press.toml, organ: 'kidnee', noHand: true})).message, /did you mean kidney/);
});

test('the force law of the gallbladder and its inverse agree', () => {
  const law = palpate.law('gallbladder', 'press');
  const {force, stiffness} = law.forceAt(0.004);
  assert.ok(force > 0 && stiffness > 0);
  assert.ok(Math.abs(law.depthUnder(force).depth - 0.004) < 1e-9);
  assert.equal(errorOf(() => law.forceAt(-1)).kind, 'input');
  law.close();
});

test('the touch noise is bounded at six standard deviations', () => {
  const samples = Array.from({length: 2000}, (_, tick) => palpate.noiseSample({gain: 1e-4, threshold: 0.01, tick}));
  const deviation = Math.sqrt(samples.reduce((sum, x) => sum + x * x, 0) / samples.length);
  assert.ok(Math.abs(deviation - 0.01) < 0.001, `${deviation} N`);  // gain / threshold
  assert.ok(samples.every((x) => Math.abs(x) <= 0.06));
});

test('tissue and noise change from the next tick on', () => {
  const simulation = palpate.open({noHand: true});
  const before = simulation.tissueValue('contact.friction');
  simulation.setTissueValue('contact.friction', before + 0.1);
  play(simulation, 1);
  assert.ok(Math.abs(simulation.tissueValue('contact.friction') - before - 0.1) < 1e-12);
  assert.match(errorOf(() => simulation.setTissueValue('contact.frictoin', 1)).message, /friction/);
  assert.ok(palpate.tissueFields.includes('contact.friction'));
  simulation.setNoise({enabled: false, gain: 0, threshold: 0.01});
  assert.deepEqual(simulation.noise(), {enabled: false, gain: 0, threshold: 0.01});
  const results = play(simulation, 2500);
  assert.ok(results.slice(1000).every((result) => result.noiseForce === 0));
  simulation.close();
});
