// The program's own picture on the page of `palpate serve` (examples/live/index.html), drawn from the live interface.
import {loadPalpate} from './palpate/palpate.js';
import {listen} from './pointer.js';
import {add, norm, placeOf, scaled} from './vectors.js';

const ROOM = 1.15;  // factor of the distance, for tissue that a pull lifts
const PERIOD = 40;  // ms between messages of a mouse or gamepad; a server reads 100 messages a second
const DEAD_ZONE = 0.15;  // of a stick's range
const BUTTONS = 4;  // of a gamepad: A, B, X, Y

const numbersOf = object => Object.entries(object).filter(([, value]) => typeof value === 'number');
const lineOf = ([key, value]) => `${key} = ${typeof value === 'string' ? JSON.stringify(value) : value}`;

/** A mesh of the live interface as an OBJ file. */
function objOf(meshes) {
  const lines = [];
  let before = 1;
  for (const {vertices_mm: v, triangles: t} of meshes) {
    for (let i = 0; i < v.length; i += 3) lines.push(`v ${v[i]} ${v[i + 1]} ${v[i + 2]}`);
    for (let i = 0; i < t.length; i += 3) lines.push(`f ${t[i] + before} ${t[i + 1] + before} ${t[i + 2] + before}`);
    before += v.length / 3;
  }
  return lines.join('\n') + '\n';
}

/** The tissue file of a tissue: its name gives the look, its reach the shape of a dent. */
function tissueFile(tissue) {
  return ['[tissue]', ...[['name', tissue.name], ['law', tissue.law], ...numbersOf(tissue)].map(lineOf),
    '[tissue.reach]', ...numbersOf(tissue.reach).map(lineOf), '[tissue.contact]', ...numbersOf(tissue.contact).map(lineOf),
  ].join('\n') + '\n';
}

export class LivePicture {
  #palpate; #sim = null; #view = null; #canvas = null; #place; #say; #failed;
  #scene = null; #tissue = null; #organ = null; #tools = []; #opened = '';
  #asked = false; #news = false;  // of the state, the view or the size
  #axis = null;  // of the gamepad's tool, towards its tip
  #contact = null; #aimed = false; #parked = false; #mouse = {};  // what the mouse did since its last message

  /** @param place element that gets the canvas @param say sends a command @param failed is told why there is no picture */
  static async create(place, say, failed) {
    return new LivePicture(await loadPalpate(), place, say, failed);
  }

  constructor(palpate, place, say, failed) {
    [this.#palpate, this.#place, this.#say, this.#failed] = [palpate, place, say, failed];
    listen(place, place, {
      view: () => this.#view, looks: () => !this.steers, take: () => this.steers, takeByLever: () => this.#aim(),
      nearest: () => this.#contact, send: (what, fields) => this.#move(what, fields), moved: () => { this.#news = true; }, touched() {},
      primary: down => this.#grip(down),
      commands: {f: () => { if (this.steers) Object.assign(this.#mouse, {park: this.#parked = !this.#parked}); }},
    });
    new ResizeObserver(() => { this.#news = true; }).observe(place);
    setInterval(() => { this.#flush(); this.#pad(); }, PERIOD);
    requestAnimationFrame(() => this.#animate());
  }

  get active() { return this.#view !== null; }

  /** First hand with this device, -1: none. */
  #handOf(kind) { return this.active ? this.#scene.hands.findIndex(({device}) => device === kind) : -1; }
  get #hand() { return this.#handOf('mouse'); }
  get steers() { return this.#hand >= 0; }

  /** Presses deeper [m], as the wheel does. */
  press(deeper) { if (this.#aim()) this.#move('press', {deeper}); }

  /** Points at the place nearest to the tool where the pointer was nowhere yet. @return whether the mouse is the device */
  #aim() {
    const at = this.steers && !this.#aimed && this.#contact &&
      placeOf(this.#view.camera, this.#place.clientWidth / this.#place.clientHeight, this.#contact);
    if (at) this.#move('point', {ray: this.#view.ray(at.x, at.y)});
    return this.steers;
  }

  #move(what, {ray, deeper}) {
    if (what === 'press') {
      this.#mouse.deeper_mm = (this.#mouse.deeper_mm ?? 0) + 1e3 * deeper;
    } else {
      this.#mouse.ray = ray && {origin_m: ray.origin, direction: ray.direction};
      this.#aimed = true;
    }
  }

  #grip(grip) {
    if (!this.steers) return;
    this.#mouse.grip = grip;
    this.#flush();  // a click is shorter than the period
  }

  /** Sends the state of the first gamepad that the browser shows, which it does once a button of it was pressed. */
  #pad() {
    const hand = this.#handOf('gamepad'), pad = hand < 0 ? null : navigator.getGamepads().find(one => one?.mapping === 'standard');
    if (!pad || !this.#axis) return;
    const beyond = value => Math.sign(value) * Math.max(0, Math.abs(value) - DEAD_ZONE) / (1 - DEAD_ZONE);
    const along = (right, up) => { const way = this.#view.steer(hand, right, up); return scaled(1 / norm(way), way); };
    const [x, y, , z] = pad.axes.map(beyond);
    this.#say('gamepad', {
      hand, way: add(add(scaled(x, along(1, 0)), scaled(-y, along(0, 1))), scaled(z, this.#axis)),
      press: pad.buttons[7].value, close: pad.buttons[6].value,
      buttons: pad.buttons.slice(0, BUTTONS).reduce((bits, {pressed}, bit) => bits | pressed << bit, 0),
    });
  }

  #flush() {
    if (this.steers && Object.keys(this.#mouse).length) this.#say('mouse', {hand: this.#hand, ...this.#mouse});
    this.#mouse = {};
  }

  /** Takes a message of the server. */
  hear(message) {
    if (message.left_out !== undefined) {
      this.#news = true;
      const {hands} = message.state, [w, x, y, z] = hands[Math.max(0, this.#handOf('gamepad'))].tool_wxyz;
      this.#contact = hands[Math.max(0, this.#hand)].contact_m;
      this.#axis = [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)];
      return;
    }
    if (message.answer === 'scene' && message.scene) {
      [this.#scene, this.#tissue, this.#organ, this.#tools] = [message.scene, message.tissue, null, []];
      [this.#aimed, this.#parked] = [false, false];
      this.#scene.hands.forEach((_, hand) => this.#say('tool', {hand}));
    } else if (message.event === 'tissue') {
      this.#tissue = message.tissue;
    } else if (message.event === 'inclusion') {
      const all = this.#scene?.inclusions ?? [], at = all.findIndex(({number}) => number === message.inclusion.number);
      if (at >= 0) all[at] = message.inclusion;
      this.#showInclusions();
      return;
    } else if (message.tool) {
      this.#tools[message.tool.hand] = message.tool;
    } else if (message.surface?.triangles) {
      this.#organ = message.surface;
    } else if (message.answer === 'picture') {
      this.#asked = false;
      if (message.picture) this.#draw(message.picture);
      return;
    } else if (message.error && ['tool', 'surface'].includes(message.answer)) {
      this.#close();
      this.#failed(message.error.words);
      return;
    } else {
      return;
    }
    if (this.#organ && this.#scene.hands.every((_, hand) => this.#tools[hand])) this.#open();
  }

  #open() {
    const files = {'organ.obj': objOf([this.#organ]), 'tissue.toml': tissueFile(this.#tissue)};
    const lines = ['[scene]', `task = "${this.#scene.task}"`, '[organ]', 'mesh = "organ.obj"', 'unit = "mm"', 'tissue = "tissue.toml"'];
    this.#tools.forEach(({parts}, hand) => {
      lines.push('[[device]]', 'kind = "scripted"', '[[tool]]', 'unit = "mm"');
      const shaft = parts.filter(part => !part.axis);
      if (shaft.length) {
        files[`tool${hand}.obj`] = objOf(shaft);
        lines.push(`mesh = "tool${hand}.obj"`);
      }
      parts.filter(part => part.axis).forEach((part, jaw) => {
        files[`jaw${hand}-${jaw}.obj`] = objOf([part]);
        lines.push('[[tool.jaw]]', `mesh = "jaw${hand}-${jaw}.obj"`, `pivot_mm = [${part.pivot_mm}]`, `axis = [${part.axis}]`,
          `open_deg = ${part.open_deg}`);
      });
    });
    const scene = lines.join('\n') + '\n';
    const all = JSON.stringify([scene, {...files, 'tissue.toml': [this.#tissue.name, this.#tissue.reach]}]);
    if (all === this.#opened) return;  // the stiffness does not change the picture
    this.#close();
    try {
      this.#sim = this.#palpate.open({scene, files, noHand: true});
      this.#sim.tick(this.#tools.map((_, hand) => this.#sim.scriptedSample(hand, 0)));  // beside the organ until the first state
      this.#canvas = document.createElement('canvas');
      this.#place.replaceChildren(this.#canvas);
      this.#place.hidden = false;
      this.#resize();
      this.#view = this.#palpate.view(this.#canvas, this.#sim);
      this.#opened = all;
      this.#showInclusions();
      this.#view.zoom(ROOM);
      this.#view.draw();
    } catch (error) {
      this.#close();
      this.#failed(error.message);
    }
  }

  #close() {
    this.#view?.close();
    this.#sim?.close();
    [this.#view, this.#sim, this.#opened] = [null, null, ''];
    this.#place.hidden = true;
  }

  #showInclusions() {
    this.#view?.showInclusions(this.#scene.inclusions.map(({position_mm, radius_mm, stiffness_ratio}) =>
      ({position: position_mm.map(mm => 1e-3 * mm), radius: 1e-3 * radius_mm, stiffnessRatio: stiffness_ratio})));
  }

  #resize() {
    const ratio = devicePixelRatio || 1;
    const [w, h] = [this.#place.clientWidth, this.#place.clientHeight].map(side => Math.max(1, Math.round(side * ratio)));
    if (this.#canvas.width !== w || this.#canvas.height !== h) [this.#canvas.width, this.#canvas.height] = [w, h];
  }

  /** Asks for one picture per frame of the stream at most. */
  #animate() {
    requestAnimationFrame(() => this.#animate());
    if (!this.#view || this.#asked || !this.#news) return;
    [this.#asked, this.#news] = [true, false];
    this.#say('picture');
  }

  #draw({organ_m, organ_wxyz, hands}) {
    if (!this.#view || hands.length !== this.#scene.hands.length) return;
    this.#resize();
    this.#view.drawState({
      organ: {position: organ_m, orientation: organ_wxyz},
      hands: hands.map(({tool_m, tool_wxyz, gripper, contacts}) => ({
        position: tool_m, orientation: tool_wxyz, gripper,
        contacts: contacts.map(({point_m, direction, depth_m, tip_radius_m, half_width_m, pull}) =>
          ({point: point_m, direction, depth: depth_m, tipRadius: tip_radius_m, halfWidth: half_width_m, pull})),
      })),
    });
  }
}
