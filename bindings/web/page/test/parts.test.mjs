// Parts of the page that need no browser.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {checkedAddress, forceCommand, HaplyError, inventoryOf, sampleOf} from '../haply.js';
import {linkTo, requestOf, requestOfFiles} from '../load.js';
import {History, roundEnd, roundStep} from '../plots.js';
import {Playback, readRecording} from '../recording.js';
import {hasOwnTissue, optionsOf, organIn} from '../scenes.js';
import {scoreOf, surfacePoint} from '../search.js';
import {TissueHistory} from '../tissue_history.js';
import {placeOf, rotatedBack} from '../vectors.js';

const arm = (more = {}) => ({device_id: '04BA', status: {power_supply: true, ready: true},
  state: {cursor_position: {x: 0.01, y: 0.02, z: 0.03}, cursor_velocity: {x: 1, y: 2, z: 3}}, ...more});
const grip = {device_id: '77', state: {orientation: {w: 0, x: 1, y: 0, z: 0}, buttons: {a: false, b: true, c: false}}};
const message = (...arms) => JSON.stringify({inverse3: arms, wireless_verse_grip: [grip]});

test('a state message gives the sample of arm and grip', () => {
  const {sample, off} = sampleOf(message(arm()), '04BA', '77');
  assert.deepEqual(sample, {position: [0.01, 0.02, 0.03], velocity: [1, 2, 3], orientation: [0, 1, 0, 0], gripper: 0,
    buttons: 2, fault: 0});
  assert.equal(off, '');
});

test('an arm without power has the fault that its force is off', () => {
  const {sample, off} = sampleOf(message(arm({status: {power_supply: false}})), '04BA', '');
  assert.equal(sample.fault, 5);
  assert.equal(off, 'it has no power supply');
});

test('a damaged message is refused with its field', () => {
  const refused = (text, words) => assert.throws(() => sampleOf(text, '04BA', ''), error => error instanceof HaplyError && words.test(error.message));
  refused('{', /no JSON/);
  refused('[]', /must be a JSON object/);
  refused(message(), /inverse3 "04BA": missing/);
  refused(message(arm({state: {cursor_position: {x: 'a', y: 0, z: 0}}})), /cursor_position.x: "a", must be a finite number/);
  refused(JSON.stringify({inverse3: Array(65).fill(arm())}), /at most 64/);
  refused('x'.repeat((1 << 20) + 1), /at most 1048576 characters/);
});

test('the force goes under the key of the service\u2019s version, and only when finite', () => {
  assert.equal(inventoryOf(message(arm())).field, 'values');
  assert.equal(inventoryOf(JSON.stringify({session_id: 1, inverse3: [arm()]})).field, 'vector');
  assert.deepEqual(JSON.parse(forceCommand('04BA', [1, 2, 3], 'vector')),
    {inverse3: [{device_id: '04BA', commands: {set_cursor_force: {vector: {x: 1, y: 2, z: 3}}}}]});
  assert.deepEqual(JSON.parse(forceCommand('04BA', [1, NaN, 3], 'values')).inverse3[0].commands.set_cursor_force.values,
    {x: 0, y: 0, z: 0});
});

test('only a service on this computer is an address', () => {
  assert.equal(checkedAddress('ws://localhost:10001/'), 'ws://localhost:10001');
  for (const wrong of ['', 'localhost:10001', 'http://localhost:10001', 'ws://localhost', 'ws://example.org:10001']) {
    assert.throws(() => checkedAddress(wrong), /must be ws:\/\/localhost:PORT/);
  }
});

test('a search counts found, missed, wrong and repeated marks', () => {
  const lumps = [[0, 0, 0], [0.05, 0, 0], [0, 0.05, 0]];
  const marks = [[0.003, 0.004, 0], [0.05, 0.02, 0], [0.001, 0, 0], [0.05, 0, 0.001]];
  const score = scoreOf(lumps, marks, 0.01);
  assert.deepEqual([score.found, score.missed, score.wrong, score.repeated], [2, 1, 1, 1]);
  assert.deepEqual(score.kinds, ['found', 'false', 'found', 'found']);
  assert.ok(Math.abs(score.error - 0.003) < 1e-12);  // first marks: 5 mm and 1 mm
  assert.equal(scoreOf(lumps, [], 0.01).error, null);
});

test('the point above a lump is the nearest vertex', () => {
  assert.deepEqual(surfacePoint(new Float64Array([0, 0, 1, 0, 1, 0, 1, 0, 0]), [0.1, 0.8, 0]), [0, 1, 0]);
});

test('a point goes into the frame of a turned organ', () => {
  const quarter = [Math.SQRT1_2, 0, 0, Math.SQRT1_2];  // about z: x of the organ is y of the world
  const [x, y, z] = rotatedBack(quarter, [0, 1, 0]);
  assert.ok(Math.abs(x - 1) < 1e-12 && Math.abs(y) < 1e-12 && z === 0);
});

test('axes end and step at round numbers', () => {
  assert.deepEqual([0.03, 1.1, 2.4, 7].map(roundStep), [0.05, 2, 2.5, 10]);
  assert.deepEqual([0.66, 1.2, 9].map(roundEnd).map(v => Number(v.toFixed(9))), [0.8, 1.5, 10]);
});

test('the history keeps the newest ticks and finds a time', () => {
  const history = new History(), rows = [];
  for (let i = 0; i < 20000; i++) rows.push(i / 1000, 0, 0, i, 0, 0);
  history.add(new Float64Array(rows));
  const first = history.from(0);
  assert.equal(history.count - first, 16384);
  assert.equal(history.from(19), 19000);
  let last = 0;
  history.each(history.from(19), slot => { last = history.columns.force[slot]; });
  assert.equal(last, 19999);
});

const HEAD = 'tick,time_s,hand,distance_m,device_x_m,device_y_m,device_z_m,device_qw,device_qx,device_qy,device_qz,device_vx_m_per_s,' +
  'device_vy_m_per_s,device_vz_m_per_s,device_gripper,device_buttons,device_valid';
const line = (tick, {hand = 0, x = 0.1, valid = 1} = {}) => `${tick},${tick / 500},${hand},0.02,${x},0,0,1,0,0,0,0,0,0,0.5,1,${valid}`;

test('a recording gives its samples, and the one before where the device gave none', () => {
  const read = readRecording(['# a note', HEAD, line(4), line(5, {x: 0.2}), line(6, {x: 9, valid: 0}), ''].join('\n'));
  assert.deepEqual([read.hands, read.ticks, Math.round(read.rate)], [1, 3, 500]);
  const playback = new Playback(read);
  assert.deepEqual(playback.sample(0, 1), {position: [0.2, 0, 0], orientation: [1, 0, 0, 0], velocity: [0, 0, 0], gripper: 0.5, buttons: 1});
  assert.deepEqual(playback.sample(0, 2).position, [0.2, 0, 0]);
  assert.equal(playback.distance(0, 0), 0.02);
  const late = new Playback(readRecording([HEAD, line(0, {x: 9, valid: 0}), line(1, {x: 0.3}), ''].join('\n')));
  assert.deepEqual(late.sample(0, 0).position, [0.3, 0, 0]);  // before the first valid one: that
});

test('a CSV that is no recording is refused with its column or line', () => {
  const refused = (words, ...lines) => assert.throws(() => readRecording(lines.join('\n')), words);
  refused(/column tick: missing\. .*palpate export/, 'depth_mm,force_N', '1,2');
  refused(/column device_valid: missing/, HEAD.replace(',device_valid', ''), line(0), line(1));
  refused(/line 3: device_x_m = far: must be a number/, HEAD, line(0), line(1, {x: 'far'}));
  refused(/line 3: tick = 2: must be 1/, HEAD, line(0), line(2));
  refused(/3 rows of 2 hands/, HEAD, line(0), line(0, {hand: 1}), line(1));
  refused(/a row per hand, in order/, HEAD, line(0), line(0, {hand: 1}), line(1, {hand: 1}), line(1));
  refused(/hand 0: has no valid sample/, HEAD, line(0, {valid: 0}), line(1, {valid: 0}));
  refused(/time_s goes from 0 to 0 s: must rise/, HEAD, line(0), line(1).replace('1,0.002', '1,0'));
  refused(/1 ticks: must be at least 2/, HEAD, line(0));
});

const SCENES = [{name: 'press', toml: '[organ]\nmesh = "liver"\n[tool]\nmesh = "sphere:5"\n'}];

test('the address of the page names scene, organ, tissue and seed, and a link has them again', async () => {
  const page = 'http://127.0.0.1:9/page/';
  assert.equal(await requestOf('', SCENES, page), null);
  const request = await requestOf('?organ=kidney&tissue=heart&seed=3', SCENES, page);
  assert.deepEqual([request.builtin, request.organ, request.tissue, request.seed], ['press', 'kidney', 'heart', '3']);
  assert.equal(linkTo(`${page}?x=1#y`, request, 4), `${page}?scene=press&organ=kidney&tissue=heart&seed=4`);
  assert.equal(linkTo(page, {link: null}), null);
  await assert.rejects(requestOf('?scene=pres', SCENES, page), /scene = pres: must be press, or an address that ends in \.toml/);
  await assert.rejects(requestOf('?scene=a.html', SCENES, page), /scene = a\.html: must be a built-in scene, or an address/);
  await assert.rejects(requestOf('?scene=file:///etc/a.toml', SCENES, page), /must be an address that begins with http/);
});

test('a file that is too large is not read', async () => {
  const {fetch} = globalThis;
  const answer = body => { globalThis.fetch = async () => new Response(body); };
  try {
    answer(new ReadableStream({pull: controller => controller.enqueue(new Uint8Array(1 << 18))}));  // without end
    await assert.rejects(requestOf('?scene=large.toml', SCENES, 'http://127.0.0.1:9/'), /large\.toml: is larger than 1 MiB/);
    answer('[organ]\nmesh = "https://example.org/x.stl"\n');
    const request = await requestOf('?scene=small.toml', SCENES, 'http://127.0.0.1:9/');
    assert.deepEqual(request.files, {}, 'a scene names files beside itself only');
  } finally {
    globalThis.fetch = fetch;
  }
});

test('dropped files are a scene with its files, a tissue or an organ of the open scene, or a recording', async () => {
  const file = (name, content) => new File([content], name);
  const open = {builtin: 'press', files: {}, link: {scene: 'press'}};
  const scene = await requestOfFiles([file('a.stl', 'x'), file('a.toml', '[scene]\nname = "a"\n')], open, null);
  assert.deepEqual([scene.request.text, Object.keys(scene.request.files)], ['[scene]\nname = "a"\n', ['a.stl']]);
  const tissue = await requestOfFiles([file('t.toml', '[tissue]\nname = "t"\n')], open, null);
  assert.deepEqual([tissue.request.builtin, tissue.request.tissue, hasOwnTissue(tissue.request)], ['press', 't.toml', true]);
  const mesh = await requestOfFiles([file('m.stl', 'x')], open, async () => 'cm');
  assert.deepEqual([mesh.request.organ, mesh.request.organUnit, mesh.request.link], ['m.stl', 'cm', null]);
  assert.deepEqual(await requestOfFiles([file('m.stl', 'x')], open, async () => ''), {});
  assert.deepEqual(await requestOfFiles([file('r.csv', 'tick')], open, null), {recording: 'tick'});
  await assert.rejects(requestOfFiles([file('r.h5', '')], open, null), /does not read HDF5.*palpate export/);
  await assert.rejects(requestOfFiles([file('r.exe', '')], open, null), /^LoadError|r\.exe: this page opens/);
});

test('an Inverse3 without a grip turns the instrument round', () => {
  const request = {builtin: 'press', files: {}};
  assert.equal(organIn(SCENES[0].toml), 'liver');
  assert.match(optionsOf(SCENES, request, {grip: ''}).scene, /\[tool\]\nmount = \{ rotation_deg = \[180, 0, 0\] \}\nmesh/);
  assert.equal(optionsOf(SCENES, request, {grip: '77'}).scene, SCENES[0].toml);
  assert.equal(optionsOf(SCENES, request, null).device, undefined);
});

test('motions of one slider are one change, which is undone at once', () => {
  const history = new TissueHistory();
  history.begin('liver');
  const state = (k1, name = 'liver') => ({name, values: {k1}});
  history.change(state(30), 'k1', 0);
  history.change(state(31), 'k1', 500);
  history.change(state(40), 'k1', 5000);
  assert.deepEqual(history.undo(), state(31));
  assert.deepEqual(history.undo(), {name: 'liver', values: {}});
  assert.equal(history.undo(), null);
  assert.deepEqual(history.redo(), state(31));
  history.change(state(50), 'beta', 9000);
  assert.deepEqual([history.canRedo, history.redo()], [false, null]);
});

test('the middle of the picture is where the camera looks, and a point above it is higher', () => {
  const camera = {eye: [0, -1, 0], target: [0, 0, 0], up: [0, 0, 1], verticalViewDeg: 90};
  const {x, y} = placeOf(camera, 2, [0, 0, 0]);
  assert.ok(Math.abs(x - 0.5) < 1e-12 && Math.abs(y - 0.5) < 1e-12);
  const corner = placeOf(camera, 2, [2, 0, 1]);  // 45 degrees up; twice as far to the right
  assert.ok(Math.abs(corner.x - 1) < 1e-12 && Math.abs(corner.y) < 1e-12);
  assert.equal(placeOf(camera, 2, [0, -2, 0]), null);
});
