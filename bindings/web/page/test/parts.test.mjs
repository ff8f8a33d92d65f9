// Parts of the page that need no browser.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {checkedAddress, forceCommand, HaplyError, inventoryOf, sampleOf} from '../haply.js';
import {History, roundEnd, roundStep} from '../plots.js';
import {scoreOf, surfacePoint} from '../search.js';
import {rotatedBack} from '../vectors.js';

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
