// A recording as CSV, of this page or of `palpate export`: the motion of its devices.

const COLUMNS = ['device_x_m', 'device_y_m', 'device_z_m', 'device_qw', 'device_qx', 'device_qy', 'device_qz',
  'device_vx_m_per_s', 'device_vy_m_per_s', 'device_vz_m_per_s', 'device_gripper', 'device_buttons', 'device_valid', 'distance_m'];
const [VALID, DISTANCE] = [COLUMNS.indexOf('device_valid'), COLUMNS.indexOf('distance_m')];
const LEAST_TICKS = 2;

export class RecordingError extends Error {}

/** Reads a CSV. @return {hands, ticks, rate [Hz], rows: numbers of COLUMNS per tick and hand} @throws RecordingError */
export function readRecording(text) {
  const lines = text.split('\n');
  let at = 0;
  while (at < lines.length && lines[at].startsWith('#')) at++;
  const names = (lines[at] ?? '').trim().split(',');
  const places = ['tick', 'time_s', 'hand', ...COLUMNS].map(name => {
    const place = names.indexOf(name);
    if (place < 0) throw new RecordingError(`column ${name}: missing. The page plays its own recordings, and the CSV of palpate export RECORDING.h5 --csv FILE.csv`);
    return place;
  });
  const rows = [], order = [];
  let ticks = 0, first = 0, last = 0, end = 0;
  for (let number = at + 1; number < lines.length; number++) {
    if (lines[number].trim() === '') continue;
    const cells = lines[number].split(',');
    const values = places.map(place => Number(cells[place]));
    const wrong = values.findIndex(value => !Number.isFinite(value));
    if (wrong >= 0 && values[3 + VALID] !== 0) {
      throw new RecordingError(`line ${number + 1}: ${['tick', 'time_s', 'hand', ...COLUMNS][wrong]} = ${cells[places[wrong]]}: must be a number`);
    }
    const [tick, time, hand] = values;
    if (hand === 0) {
      if (ticks === 0) first = time;
      if (ticks > 0 && tick !== last + 1) throw new RecordingError(`line ${number + 1}: tick = ${tick}: must be ${last + 1}`);
      [last, ticks, end] = [tick, ticks + 1, time];
    }
    order.push(hand);
    rows.push(values.slice(3));
  }
  if (ticks < LEAST_TICKS) throw new RecordingError(`${ticks} ticks: must be at least ${LEAST_TICKS}`);
  const hands = rows.length / ticks;
  if (order.some((hand, i) => hand !== i % hands)) throw new RecordingError(`${rows.length} rows of ${new Set(order).size} hands: every tick must have a row per hand, in order`);
  const rate = (ticks - 1) / (end - first);
  if (!(rate > 0 && Number.isFinite(rate))) throw new RecordingError(`time_s goes from ${first} to ${end} s: must rise`);
  fillGaps(rows, hands);
  const width = COLUMNS.length, all = new Float64Array(width * rows.length);
  rows.forEach((row, i) => all.set(row, width * i));
  return {hands, ticks, rate, rows: all};
}

/** Gives ticks without a valid sample that of the tick before, or of the first valid one. */
function fillGaps(rows, hands) {
  for (let hand = 0; hand < hands; hand++) {
    let held = rows.find((row, i) => i % hands === hand && row[VALID] !== 0);
    if (!held) throw new RecordingError(`hand ${hand}: has no valid sample (device_valid is 0 in all rows)`);
    for (let i = hand; i < rows.length; i += hands) {
      if (rows[i][VALID] === 0) rows[i].splice(0, VALID, ...held.slice(0, VALID)); else held = rows[i];
    }
  }
}

/** Samples of a recording, for Simulation.tick(). */
export class Playback {
  constructor({hands, ticks, rate, rows}) { Object.assign(this, {hands, ticks, rate, rows}); }

  #row(hand, tick) {
    const width = COLUMNS.length, at = width * (tick * this.hands + hand);
    return this.rows.subarray(at, at + width);
  }

  /** The sample of a tick. */
  sample(hand, tick) {
    const numbers = Array.from(this.#row(hand, tick));
    return {position: numbers.slice(0, 3), orientation: numbers.slice(3, 7), velocity: numbers.slice(7, 10), gripper: numbers[10],
      buttons: numbers[11]};
  }

  /** m, tool to organ, as recorded */
  distance(hand, tick) { return this.#row(hand, tick)[DISTANCE]; }
}
