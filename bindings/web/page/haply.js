// A Haply Inverse3 behind Haply's Inverse Service: JSON over a WebSocket, one state message a command
// (docs/devices.md). As src/run/devices/haply.cc and haply_messages.cc do it.

const OPENING_LIMIT = 3000;  // ms, for the connection and then for the first message
const REPLY_LIMIT = 1000;    // ms, longest wait for a reply
const RETRY = 1000;          // ms, from the end of a connection to the next attempt
const LARGEST_MESSAGE = 1 << 20;  // characters
const MOST_DEVICES = 64, LONGEST_ID = 64;
const QUATERNION_SLACK = 0.05;    // largest deviation of a quaternion's norm from 1
const GRIPS = ['wireless_verse_grip', 'verse_grip'];
const FAULT_DEVICE = 2, FAULT_FORCE_OFF = 5;  // PALPATE_FAULT_... of palpate.h
const HOW_TO_START = 'Start Haply\u2019s Inverse Service on this computer, or correct its address.';

/** A message of the service is invalid, or the connection failed. */
export class HaplyError extends Error {}

function refuse(field, value, want) {
  const found = value === undefined || value === null ? 'missing' : `${JSON.stringify(value)}`.slice(0, 40);
  throw new HaplyError(`message: ${field}: ${found}, must be ${want}`);
}

function parsed(text) {
  if (typeof text !== 'string' || text.length > LARGEST_MESSAGE) throw new HaplyError(`message: must be text of at most ${LARGEST_MESSAGE} characters`);
  let message;
  try { message = JSON.parse(text); } catch { throw new HaplyError('message: is no JSON'); }
  if (message === null || typeof message !== 'object' || Array.isArray(message)) refuse('it', message, 'a JSON object');
  return message;
}

function devices(message, kind) {
  const list = message[kind] ?? [];
  if (!Array.isArray(list) || list.length > MOST_DEVICES) refuse(kind, list, `an array of at most ${MOST_DEVICES} devices`);
  for (const device of list) {
    const id = device?.device_id;
    if (typeof id !== 'string' || !/^[!-~]+$/.test(id) || id.length > LONGEST_ID) refuse(`${kind}.device_id`, id, `1 to ${LONGEST_ID} printable characters`);
  }
  return list;
}

function numbers(object, keys, field) {
  return keys.map(key => {
    const value = object?.[key];
    if (!Number.isFinite(value)) refuse(`${field}.${key}`, value, 'a finite number');
    return value;
  });
}

/** Which devices the first message lists, and the key of a force command's vector ("vector" from version 3.5). */
export function inventoryOf(text) {
  const message = parsed(text), arms = devices(message, 'inverse3');
  const vector = message.session_id != null || arms.some(arm => arm.state?.control_mode != null);
  return {arms: arms.map(arm => arm.device_id), field: vector ? 'vector' : 'values',
    grips: GRIPS.flatMap(kind => devices(message, kind).map(grip => grip.device_id))};
}

/** The sample of an arm and its grip ('': none is held) in a state message; `off`: why the arm's force is off. */
export function sampleOf(text, armId, gripId) {
  const message = parsed(text);
  const arm = devices(message, 'inverse3').find(device => device.device_id === armId);
  if (!arm) refuse(`inverse3 "${armId}"`, undefined, 'in every message');
  const sample = {position: numbers(arm.state?.cursor_position, ['x', 'y', 'z'], 'state.cursor_position'),
    velocity: numbers(arm.state?.cursor_velocity, ['x', 'y', 'z'], 'state.cursor_velocity'),
    orientation: [1, 0, 0, 0], gripper: 1, buttons: 0, fault: 0};
  if (gripId) {
    const grip = GRIPS.flatMap(kind => devices(message, kind)).find(device => device.device_id === gripId);
    if (!grip) refuse(`verse grip "${gripId}"`, undefined, 'in every message');
    const q = numbers(grip.state?.orientation, ['w', 'x', 'y', 'z'], 'state.orientation'), length = Math.hypot(...q);
    if (Math.abs(length - 1) > QUATERNION_SLACK) refuse('state.orientation', q, 'a unit quaternion');
    sample.orientation = q.map(part => part / length);
    const {a, b, c} = grip.state.buttons ?? {};
    sample.buttons = (grip.state.button === true || a === true ? 1 : 0) | (b === true ? 2 : 0) | (c === true ? 4 : 0);
    sample.gripper = sample.buttons === 0 ? 1 : 0;
  }
  const {power_supply: power = true, ready = true} = arm.status ?? {};
  const off = !power ? 'it has no power supply' : !ready ? 'it is not ready' : '';
  if (off) sample.fault = FAULT_FORCE_OFF;
  return {sample, off};
}

/** The message that commands a force [N] in the arm's base frame; zero when it is not finite. */
export function forceCommand(arm, force, field) {
  const [x, y, z] = force.every(Number.isFinite) ? force : [0, 0, 0];
  return JSON.stringify({inverse3: [{device_id: arm, commands: {set_cursor_force: {[field]: {x, y, z}}}}]});
}

/** Address of a service on this computer, or an error that says the form. */
export function checkedAddress(text) {
  let url = null;
  try { url = new URL(text); } catch { /* reported below */ }
  const local = url && ['localhost', '127.0.0.1', '[::1]'].includes(url.hostname);
  if (!url || url.protocol !== 'ws:' || !url.port || !local) {
    throw new HaplyError(`address "${text}": must be ws://localhost:PORT, as ws://localhost:10001`);
  }
  return url.origin === 'null' ? `ws://${url.host}` : url.origin;
}

/**
 * One arm of a service. Every state message calls onSample; the caller then sends the next force. It reconnects to the
 * same arm until close(). A failure calls onTrouble with its cause, and sample() reports a fault.
 */
export class HaplyLink {
  constructor(address, {onReady, onSample, onTrouble}) {
    this.address = checkedAddress(address);
    Object.assign(this, {onReady, onSample, onTrouble, arm: '', grip: '', trouble: '', newest: null, received: 0});
    this.#open();
  }

  get connected() { return this.greeted === true; }
  /** Whether a reply to the last command is missing. */
  get awaits() { return this.awaited > 0; }

  /** The newest sample, with its age. */
  sample() {
    const age = (performance.now() - this.received) / 1000;
    if (!this.newest || !this.greeted || this.invalid) {
      return {...(this.newest ?? {position: [0, 0, 0]}), age, fault: FAULT_DEVICE};
    }
    return {...this.newest, age};
  }

  /** Sends a force [N] in the device's frame. */
  send(force) {
    if (!this.greeted || this.socket.readyState !== WebSocket.OPEN) return;
    this.socket.send(forceCommand(this.arm, force, this.field));
    this.awaited++;
    this.#limit(REPLY_LIMIT, `the service gave no reply for ${REPLY_LIMIT} ms`);
  }

  /** Sends zero force and ends the connection for good. */
  close() {
    this.closed = true;
    clearTimeout(this.timer);
    this.send([0, 0, 0]);
    clearTimeout(this.timer);
    this.greeted = false;
    this.socket?.close();
  }

  #open() {
    this.greeted = false;
    this.awaited = 0;
    const socket = this.socket = new WebSocket(this.address);
    const mine = handler => event => { if (!this.closed && socket === this.socket) handler(event); };
    socket.onopen = mine(() => this.#limit(OPENING_LIMIT, `the service sent nothing within ${OPENING_LIMIT} ms`));
    socket.onmessage = mine(event => this.#hear(event.data));
    socket.onclose = mine(() => this.#fail(this.greeted ? 'the service closed the connection'
      : `no service answers. ${HOW_TO_START}`));
    this.#limit(OPENING_LIMIT, `no connection within ${OPENING_LIMIT} ms. ${HOW_TO_START}`);
  }

  #hear(text) {
    clearTimeout(this.timer);
    try {
      const greets = !this.greeted;
      if (greets) this.#greet(text);
      else this.awaited = Math.max(0, this.awaited - 1);
      const {sample, off} = sampleOf(text, this.arm, this.grip);
      [this.newest, this.received, this.invalid] = [sample, performance.now(), false];
      this.trouble = off && `Inverse3 ${this.arm}: ${off}`;
      if (greets) this.onReady(this);
    } catch (error) {
      if (!(error instanceof HaplyError)) throw error;
      if (!this.greeted) return this.#fail(error.message);
      this.invalid = true;
      this.trouble = `${this.address}: ${error.message}`;
    }
    this.onSample(this);
  }

  #greet(text) {
    const {arms, grips, field} = inventoryOf(text);
    if (!this.arm) {
      if (!arms.length) throw new HaplyError('the service has no Inverse3');
      [this.arm, this.grip] = [arms[0], grips[0] ?? ''];
    } else if (!arms.includes(this.arm)) {
      throw new HaplyError(`the service has no Inverse3 ${this.arm}`);
    }
    this.field = field;
    this.greeted = true;
  }

  #limit(ms, words) {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.#fail(words), ms);
  }

  #fail(words) {
    clearTimeout(this.timer);
    this.greeted = false;
    const socket = this.socket;
    this.socket = null;  // its later events do not count
    socket.close();
    this.trouble = `${this.address}: ${words}`;
    this.onTrouble(this);
    this.timer = setTimeout(() => { if (!this.closed) this.#open(); }, RETRY);
  }
}
