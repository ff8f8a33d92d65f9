// Palpate in JavaScript; palpate.d.ts documents it. Structs of palpate.h are read by the layout that the
// module states (palpate_web_layout).
import createCore from './palpate_core.js';

const KINDS = ['', 'use', 'input', 'other'];
const QUALITIES = ['full', 'balanced', 'fast'];
const MARKS = ['found', 'false', 'lump'];
const MARK_COLOURS = ['text', 'force', 'x', 'y', 'z', 'plate', 'steel', ...Array.from({length: 8}, (_, i) => `layer${i + 1}`)];
const STATUS = Object.freeze({
  STARTED_INSIDE: 1, CONTACTS_FULL: 2, GRIP_RELEASED: 4, JUMP: 8, EXTRAPOLATED: 16, AT_HUB: 32, FORCE_CLAMPED: 0x100,
  FORCE_SLEWED: 0x200, TORQUE_CLAMPED: 0x400, TORQUE_SLEWED: 0x800, ENERGY_DAMPED: 0x1000, DUTY_HIGH: 0x2000, DUTY_LIMITED: 0x4000,
});

export class PalpateError extends Error {
  constructor(kind, message) {
    super(message);
    this.name = 'PalpateError';
    this.kind = kind;
  }
}

const refuse = (message) => { throw new PalpateError('use', message); };

async function readModule(url) {
  if (url.protocol === 'file:') {
    const {readFile} = await import('node:fs/promises');
    return WebAssembly.compile(await readFile(url));
  }
  const response = await fetch(url);
  if (!response.ok) throw new Error(`${url}: cannot be read: HTTP status ${response.status}`);
  return WebAssembly.compile(await response.arrayBuffer());
}

export async function loadPalpate({wasmUrl = 'palpate.wasm'} = {}) {
  const module = await readModule(new URL(wasmUrl, import.meta.url));
  const core = await createCore({
    instantiateWasm(imports, done) {
      WebAssembly.instantiate(module, imports).then((instance) => done(instance, module));
      return {};
    },
  });
  return new Palpate(core);
}

/** Memory of the module: structs, texts, numbers. */
class Memory {
  constructor(core) {
    this.core = core;
    this.layout = {};
    const camel = (name) => name.replace(/_(.)/g, (_, letter) => letter.toUpperCase());
    const stated = JSON.parse(core.UTF8ToString(core._palpate_web_layout()));
    for (const [name, {size, fields}] of Object.entries(stated)) {
      this.layout[name] = {
        size, fields: fields.map(([key, type, offset, count]) => ({name: camel(key), type, offset, count})),
      };
    }
  }

  /** @throws PalpateError for a status that is not PALPATE_OK */
  check(status) {
    if (status !== 0) throw new PalpateError(KINDS[status], this.core.UTF8ToString(this.core._palpate_last_error()));
  }

  allocate(bytes) {
    const at = this.core._malloc(Math.max(8, bytes));
    if (at === 0) throw new PalpateError('other', `no memory for ${bytes} bytes`);
    this.core.HEAPU8.fill(0, at, at + bytes);
    return at;
  }

  /** Runs `use` with memory that is freed afterwards. */
  borrow(bytes, use) {
    const at = this.allocate(bytes);
    try {
      return use(at);
    } finally {
      this.core._free(at);
    }
  }

  text(value, use) {
    const bytes = new TextEncoder().encode(String(value));
    return this.borrow(bytes.length + 1, (at) => {
      this.core.HEAPU8.set(bytes, at);
      return use(at);
    });
  }

  /** Zeroed structs, each with its struct_size. */
  structs(name, count = 1) {
    const {size} = this.layout[name];
    const at = this.allocate(size * count);
    for (let i = 0; i < count; ++i) this.core.HEAPU32[(at + i * size) >> 2] = size;
    return at;
  }

  borrowStruct(name, use) {
    const at = this.structs(name);
    try {
      return use(at);
    } finally {
      this.core._free(at);
    }
  }

  value(type, at) {
    const {HEAPF64, HEAPU32, HEAP32} = this.core;
    switch (type) {
      case 'f64': return HEAPF64[at >> 3];
      case 'i32': return HEAP32[at >> 2];
      case 'u64': return HEAPU32[at >> 2] + HEAPU32[(at >> 2) + 1] * 2 ** 32;
      case 'text': return this.core.UTF8ToString(HEAPU32[at >> 2]);
      default: return HEAPU32[at >> 2];
    }
  }

  /** Reads a struct. */
  read(name, at) {
    const {HEAPF64} = this.core;
    const object = {};
    for (const field of this.layout[name].fields) {
      const first = at + field.offset;
      if (field.count === 1) {
        object[field.name] = field.type === 'f64' ? HEAPF64[first >> 3] : this.value(field.type, first);
        continue;
      }
      const array = object[field.name] = new Array(field.count);
      if (field.type === 'f64') {
        for (let i = 0; i < field.count; ++i) array[i] = HEAPF64[(first >> 3) + i];
      } else {
        for (let i = 0; i < field.count; ++i) array[i] = this.value(field.type, first + 4 * i);
      }
    }
    return object;
  }

  offset(name, field) {
    return this.layout[name].fields.find((one) => one.name === field).offset;
  }

  numbers(at, count) {
    return Array.from(this.core.HEAPF64.subarray(at >> 3, (at >> 3) + count));
  }

  setNumbers(at, values) {
    this.core.HEAPF64.set(values, at >> 3);
  }
}

/** Three or four finite numbers. @throws PalpateError that names the argument */
function vector(value, name, count = 3) {
  let numbers = value?.length === count;
  for (let i = 0; numbers && i < count; ++i) numbers = typeof value[i] === 'number';
  if (!numbers) refuse(`${name}: must be an array of ${count} numbers`);
  return value;
}

function copy(array, numbers, first) {
  for (let i = 0; i < array.length; ++i) array[i] = numbers[first + i];
  return first + array.length;
}

/** Result of a tick. Setting its fields by name is several times faster than Memory.read(). */
class Result {
  tick = 0;
  time = 0;
  deviceForce = [0, 0, 0];
  deviceTorque = [0, 0, 0];
  gripperForce = 0;
  force = [0, 0, 0];
  torque = [0, 0, 0];
  tissueForce = 0;
  noiseForce = 0;
  friction = 0;
  distance = 0;
  depth = 0;
  contact = [0, 0, 0];
  normal = [0, 0, 0];
  toolPosition = [0, 0, 0];
  toolOrientation = [0, 0, 0, 0];
  gripper = 0;
  energy = 0;
  engagement = 0;
  phase = 0;
  cutoffLayer = 0;
  saturated = 0;
  status = 0;
  fault = 0;

  /** Reads the fields, which follow each other as palpate.h has them, from `at` on. */
  read({HEAPF64, HEAPU32}, at) {
    let from = at >> 3;
    this.tick = HEAPU32[from * 2] + HEAPU32[from * 2 + 1] * 2 ** 32;
    this.time = HEAPF64[++from];
    from = copy(this.deviceForce, HEAPF64, ++from);
    from = copy(this.deviceTorque, HEAPF64, from);
    this.gripperForce = HEAPF64[from++];
    from = copy(this.force, HEAPF64, from);
    from = copy(this.torque, HEAPF64, from);
    this.tissueForce = HEAPF64[from++];
    this.noiseForce = HEAPF64[from++];
    this.friction = HEAPF64[from++];
    this.distance = HEAPF64[from++];
    this.depth = HEAPF64[from++];
    from = copy(this.contact, HEAPF64, from);
    from = copy(this.normal, HEAPF64, from);
    from = copy(this.toolPosition, HEAPF64, from);
    from = copy(this.toolOrientation, HEAPF64, from);
    this.gripper = HEAPF64[from++];
    this.energy = HEAPF64[from++];
    this.engagement = HEAPF64[from++];
    let word = from * 2;
    this.phase = HEAPU32[word++];
    this.cutoffLayer = HEAPU32[word++];
    this.saturated = HEAPU32[word++];
    this.status = HEAPU32[word++];
    this.fault = HEAPU32[word];
    return this;
  }
}

class Palpate {
  #memory;
  #opened = 0;

  constructor(core) {
    this.#memory = new Memory(core);
    this.version = core.UTF8ToString(core._palpate_version());
    this.status = STATUS;
    const fields = [];
    for (let at; (at = core._palpate_tissue_field(fields.length)) !== 0;) fields.push(core.UTF8ToString(at));
    this.tissueFields = Object.freeze(fields);
    this.tissueNames = Object.freeze(JSON.parse(core.UTF8ToString(core._palpate_web_tissues())));
    this.scenes = Object.freeze(JSON.parse(core.UTF8ToString(core._palpate_web_scenes())));
  }

  open(options = {}) {
    return new Simulation(this.#memory, options, `/simulation-${++this.#opened}`);
  }

  law(tissue, direction, rate = 1000) {
    return new Law(this.#memory, tissue, direction, rate);
  }

  noiseSample({gain, threshold, distance = 0, seed = 1, hand = 0, tick = 0}) {
    const {core} = this.#memory;
    return this.#memory.borrow(8, (force) => {
      this.#memory.check(core._palpate_noise_sample(
          gain, threshold, BigInt(seed), hand, BigInt(tick), distance, force));
      return core.HEAPF64[force >> 3];
    });
  }

  describeFault(fault) {
    const {core} = this.#memory;
    return core.UTF8ToString(core._palpate_fault_words(fault));
  }

  view(canvas, simulation) {
    return new View(this.#memory, canvas, simulation);
  }

  memoryInUse() {
    return this.#memory.core._palpate_web_memory_in_use();
  }
}

class Law {
  #memory;
  #law;

  constructor(memory, tissue, direction, rate) {
    this.#memory = memory;
    const {core} = memory;
    this.#law = memory.text(tissue, (name) => memory.text(direction, (word) => memory.borrow(4, (out) => {
      memory.check(core._palpate_law_open(name, word, rate, out));
      return core.HEAPU32[out >> 2];
    })));
  }

  #answer(call, value) {
    if (this.#law === 0) refuse('the law is closed');
    return this.#memory.borrowStruct('response', (at) => {
      this.#memory.check(call(this.#law, value, at));
      const response = this.#memory.read('response', at);
      response.saturated = response.saturated !== 0;
      return response;
    });
  }

  forceAt(depth) { return this.#answer(this.#memory.core._palpate_law_force_at, depth); }
  depthUnder(force) { return this.#answer(this.#memory.core._palpate_law_depth_under, force); }

  close() {
    this.#memory.core._palpate_law_close(this.#law);
    this.#law = 0;
  }
}

/** Writes the files of a scene to the module's own file system. */
function writeFiles(core, folder, files) {
  core.FS.mkdir(folder);
  for (const [name, contents] of Object.entries(files)) {
    const parts = name.split('/');
    if (parts.some((part) => part === '' || part === '.' || part === '..')) {
      refuse(`files: "${name}": must be a relative path without . and ..`);
    }
    core.FS.mkdirTree(`${folder}/${parts.slice(0, -1).join('/')}`);
    core.FS.writeFile(`${folder}/${name}`, contents);
  }
}

function removeTree(core, path) {
  if (!core.FS.analyzePath(path).exists) return;
  if (!core.FS.isDir(core.FS.stat(path).mode)) return core.FS.unlink(path);
  for (const name of core.FS.readdir(path)) {
    if (name !== '.' && name !== '..') removeTree(core, `${path}/${name}`);
  }
  core.FS.rmdir(path);
}

const openHandles = new WeakMap();  // of simulations, for views

class Simulation {
  #memory;
  #handle = 0;
  #folder;
  #samples = 0;
  #results = 0;
  #followers = [];
  #triangles = null;
  #recording;

  constructor(memory, options, folder) {
    this.#memory = memory;
    this.#folder = folder;
    this.#recording = options.record === true;
    try {
      writeFiles(memory.core, folder, options.files ?? {});
      this.#handle = this.#open(options);
    } catch (error) {
      removeTree(memory.core, folder);
      throw error;
    }
    openHandles.set(this, {memory, handle: this.#handle});
    this.info = this.#readInfo();
    this.name = memory.core.UTF8ToString(memory.core._palpate_name(this.#handle));
    this.remarks = [];
    for (let i = 0; i < this.info.remarks; ++i) {
      this.remarks.push(memory.core.UTF8ToString(memory.core._palpate_remark(this.#handle, i)));
    }
    delete this.info.remarks;
    this.scene = Object.freeze(JSON.parse(memory.core.UTF8ToString(memory.core._palpate_web_describe(this.#handle))));
    this.#samples = memory.structs('sample', this.info.hands);
    this.#results = memory.structs('result', this.info.hands);
  }

  #open(options) {
    const memory = this.#memory;
    const {core} = memory;
    const texts = [];
    const keep = (value) => {
      const bytes = new TextEncoder().encode(String(value));
      const at = memory.allocate(bytes.length + 1);
      core.HEAPU8.set(bytes, at);
      texts.push(at);
      return at;
    };
    let failure = null;
    const progress = options.progress && core.addFunction((share, what) => {
      try {
        options.progress(share, core.UTF8ToString(what));
      } catch (error) {
        failure ??= error;
      }
    }, 'vdii');
    const at = memory.structs('options');
    const out = memory.allocate(4);
    try {
      const set = (field, value) => { core.HEAPU32[(at + memory.offset('options', field)) >> 2] = value; };
      if (options.scene !== undefined) {
        set('sceneText', keep(options.scene));
        set('sceneFolder', keep(this.#folder));
      }
      if (options.task !== undefined) set('task', keep(options.task));
      if (this.#recording) set('recordFile', keep(`${this.#folder}/recording.csv`));
      set('recordWaits', 1);
      set('noHand', options.noHand ? 1 : 0);
      set('noCache', 1);
      if (progress) set('progress', progress);
      memory.setNumbers(at + memory.offset('options', 'surfaceEdge'), [options.surfaceEdge ?? 0]);
      const given = ['organ', 'organUnit', 'tissue', 'device', 'seed'].map((flag) => {
        const value = options[flag];
        if (value === undefined) return 0;
        return keep(options.files && Object.hasOwn(options.files, value) ? `${this.#folder}/${value}` : value);
      });
      const status = core._palpate_web_open(at, ...given, out);
      const handle = core.HEAPU32[out >> 2];
      if (failure !== null) {
        core._palpate_close(handle);
        throw failure;
      }
      memory.check(status);
      return handle;
    } finally {
      if (progress) core.removeFunction(progress);
      for (const one of [at, out, ...texts]) core._free(one);
    }
  }

  #readInfo() {
    return this.#memory.borrowStruct('info', (at) => {
      this.#memory.check(this.#memory.core._palpate_get_info(this.#handle, at));
      const info = this.#memory.read('info', at);
      const seed = (at + this.#memory.offset('info', 'seed')) >> 2;
      const {HEAPU32} = this.#memory.core;
      info.seed = (BigInt(HEAPU32[seed + 1]) << 32n) | BigInt(HEAPU32[seed]);
      return info;
    });
  }

  get #opened() {
    if (this.#handle === 0) refuse('the simulation is closed');
    return this.#handle;
  }

  #writeSample(hand, sample) {
    const {core, layout} = this.#memory;
    const at = this.#samples + hand * layout.sample.size;
    const {HEAPF64, HEAPU32} = core;
    const faulty = (sample.fault ?? 0) !== 0;
    const position = faulty && sample.position === undefined ? [0, 0, 0] : vector(sample.position, 'sample.position');
    const orientation = sample.orientation ?? [1, 0, 0, 0];
    const velocity = sample.velocity ?? [0, 0, 0];
    if (orientation.length !== 4) refuse('sample.orientation: must be an array of 4 numbers');
    if (velocity.length !== 3) refuse('sample.velocity: must be an array of 3 numbers');
    // The fields follow each other, as palpate.h has them: position, orientation, velocity, gripper, age.
    let to = (at + layout.sample.fields[0].offset) >> 3;
    for (let i = 0; i < 3; ++i) HEAPF64[to++] = position[i];
    for (let i = 0; i < 4; ++i) HEAPF64[to++] = orientation[i];
    for (let i = 0; i < 3; ++i) HEAPF64[to++] = velocity[i];
    HEAPF64[to++] = sample.gripper ?? 0;
    HEAPF64[to++] = sample.age ?? 0;
    HEAPU32[to * 2] = sample.buttons ?? 0;
    HEAPU32[to * 2 + 1] = sample.fault ?? 0;
  }

  tick(samples, results = []) {
    const handle = this.#opened;
    const {hands} = this.info;
    if (samples?.length !== hands) refuse(`samples: ${samples?.length}, must be ${hands}: one per hand`);
    for (let hand = 0; hand < hands; ++hand) this.#writeSample(hand, samples[hand]);
    this.#memory.check(this.#memory.core._palpate_tick(handle, this.#samples, this.#results, hands));
    const {size, fields} = this.#memory.layout.result;
    for (let hand = 0; hand < hands; ++hand) {
      const result = results[hand] instanceof Result ? results[hand] : new Result();
      results[hand] = result.read(this.#memory.core, this.#results + hand * size + fields[0].offset);
    }
    return results;
  }

  scriptedSample(hand, tick) {
    const handle = this.#opened;
    if (!(Number.isSafeInteger(tick) && tick >= 0)) refuse(`tick = ${tick}: must be a whole number >= 0`);
    return this.#memory.borrowStruct('sample', (at) => {
      this.#memory.check(this.#memory.core._palpate_scripted_sample(handle, hand, BigInt(tick), at));
      return this.#memory.read('sample', at);
    });
  }

  follower(hand) {
    const follower = new Follower(this.#memory, this.#opened, hand);
    this.#followers.push(follower);
    return follower;
  }

  rider(hand) {
    const rider = new Rider(this.#memory, this.#opened, hand);
    this.#followers.push(rider);
    return rider;
  }

  resetFault(handBits) { this.#memory.check(this.#memory.core._palpate_reset_fault(this.#opened, handBits)); }
  restart() { this.#memory.check(this.#memory.core._palpate_restart(this.#opened)); }

  setTissue(name) {
    const handle = this.#opened;
    this.#memory.text(name, (at) => this.#memory.check(this.#memory.core._palpate_set_tissue(handle, at)));
  }

  setTissueValue(field, value) {
    const handle = this.#opened;
    this.#memory.text(field, (at) => this.#memory.check(
        this.#memory.core._palpate_set_tissue_value(handle, at, value)));
  }

  tissueValue(field) {
    const handle = this.#opened;
    return this.#memory.text(field, (name) => this.#memory.borrow(8, (at) => {
      this.#memory.check(this.#memory.core._palpate_get_tissue_value(handle, name, at));
      return this.#memory.core.HEAPF64[at >> 3];
    }));
  }

  setNoise({enabled, gain, threshold}) {
    this.#memory.check(this.#memory.core._palpate_set_noise(this.#opened, enabled ? 1 : 0, gain, threshold));
  }

  noise() {
    const handle = this.#opened;
    return this.#memory.borrow(24, (at) => {
      this.#memory.check(this.#memory.core._palpate_get_noise(handle, at, at + 8, at + 16));
      const [gain, threshold] = this.#memory.numbers(at + 8, 2);
      return {enabled: this.#memory.core.HEAP32[at >> 2] !== 0, gain, threshold};
    });
  }

  inclusions() {
    const handle = this.#opened;
    const count = this.#memory.core._palpate_inclusion_count(handle);
    return Array.from({length: count}, (_, index) => this.#memory.borrowStruct('inclusion', (at) => {
      this.#memory.check(this.#memory.core._palpate_get_inclusion(handle, index, at));
      const inclusion = this.#memory.read('inclusion', at);
      inclusion.visible = inclusion.visible !== 0;
      return inclusion;
    }));
  }

  setInclusion(index, change) {
    const handle = this.#opened;
    const memory = this.#memory;
    memory.borrowStruct('inclusion', (at) => {
      memory.check(memory.core._palpate_get_inclusion(handle, index, at));
      const set = (field, values) => memory.setNumbers(at + memory.offset('inclusion', field), values);
      if (change.position !== undefined) set('position', vector(change.position, 'position'));
      if (change.stiffnessRatio !== undefined) set('stiffnessRatio', [change.stiffnessRatio]);
      memory.check(memory.core._palpate_set_inclusion(handle, index, at));
    });
  }

  surface() {
    const handle = this.#opened;
    const memory = this.#memory;
    const {core} = memory;
    const {vertices, triangles, hands} = this.info;
    this.#triangles ??= memory.borrow(12 * triangles, (at) => {
      memory.check(core._palpate_surface_triangles(handle, at, triangles));
      return core.HEAP32.slice(at >> 2, (at >> 2) + 3 * triangles);
    });
    const picture = memory.borrowStruct('picture', (at) => {
      memory.check(core._palpate_surface_update(handle, at));
      return memory.read('picture', at);
    });
    const perHand = (all, size) =>
        Array.from({length: hands}, (_, hand) => all.slice(hand * size, (hand + 1) * size));
    picture.toolPosition = perHand(picture.toolPosition, 3);
    picture.toolOrientation = perHand(picture.toolOrientation, 4);
    picture.gripper.length = hands;
    const positions = memory.borrow(24 * vertices, (at) => {
      memory.check(core._palpate_surface_vertices(handle, at, vertices));
      return core.HEAPF64.slice(at >> 3, (at >> 3) + 3 * vertices);
    });
    return {positions, triangles: this.#triangles, picture};
  }

  snapshot() {
    const handle = this.#opened;
    const size = this.#memory.core._palpate_web_snapshot_size();
    return this.#memory.borrow(size, (at) => {
      this.#memory.check(this.#memory.core._palpate_web_snapshot(handle, at, size));
      return this.#memory.core.HEAPU8.slice(at, at + size);
    });
  }

  recordingCsv() {
    this.#opened;
    if (!this.#recording) refuse('the simulation was opened without record');
    this.#memory.check(this.#memory.core._palpate_web_flush_recording(this.#handle));
    return this.#memory.core.FS.readFile(`${this.#folder}/recording.csv`, {encoding: 'utf8'});
  }

  close() {
    if (this.#handle === 0) return;
    const handle = this.#handle;
    this.#handle = 0;
    openHandles.delete(this);
    for (const follower of this.#followers) follower.free();
    this.#memory.core._free(this.#samples);
    this.#memory.core._free(this.#results);
    const status = this.#memory.core._palpate_close(handle);
    removeTree(this.#memory.core, this.#folder);
    this.#memory.check(status);
  }
}

class Follower {
  #memory;
  #handle;
  #target;
  #sample;

  constructor(memory, simulation, hand) {
    this.#memory = memory;
    const {core} = memory;
    this.#handle = memory.borrow(4, (out) => {
      memory.check(core._palpate_web_follower_open(simulation, hand, out));
      return core.HEAPU32[out >> 2];
    });
    this.#target = memory.allocate(24);
    this.#sample = memory.structs('sample');
    memory.borrow(56, (at) => {
      core._palpate_web_follower_start(this.#handle, at);
      const start = memory.numbers(at, 7);
      this.start = start.slice(0, 3);
      this.axis = start.slice(3, 6);
      this.gripper = start[6];
    });
  }

  advance(target, gripper) {
    if (this.#handle === 0) refuse('the simulation of the follower is closed');
    this.#memory.setNumbers(this.#target, vector(target, 'target'));
    this.#memory.check(this.#memory.core._palpate_web_follower_advance(
        this.#handle, this.#target, gripper, this.#sample));
    return this.#memory.read('sample', this.#sample);
  }

  withinReach(target) {
    if (this.#handle === 0) refuse('the simulation of the follower is closed');
    this.#memory.setNumbers(this.#target, vector(target, 'target'));
    this.#memory.core._palpate_web_follower_reach(this.#handle, this.#target);
    return this.#memory.numbers(this.#target, 3);
  }

  /** For Simulation.close(). */
  free() {
    const {core} = this.#memory;
    core._palpate_web_follower_close(this.#handle);
    core._free(this.#target);
    core._free(this.#sample);
    this.#handle = 0;
  }
}

class Rider {
  #memory;
  #handle;
  #ray;
  #sample;

  constructor(memory, simulation, hand) {
    this.#memory = memory;
    const {core} = memory;
    this.#handle = memory.borrow(4, (out) => {
      memory.check(core._palpate_web_rider_open(simulation, hand, out));
      return core.HEAPU32[out >> 2];
    });
    this.#ray = memory.allocate(48);
    this.#sample = memory.structs('sample');
    this.parked = false;
  }

  get #rider() {
    if (this.#handle === 0) refuse('the rider, or its simulation, is closed');
    return this.#handle;
  }

  pointAt(ray) {
    const rider = this.#rider;
    if (ray !== null) this.#memory.setNumbers(this.#ray, [...vector(ray.origin, 'ray.origin'), ...vector(ray.direction, 'ray.direction')]);
    this.#memory.core._palpate_web_rider_point_at(rider, ray === null ? 0 : this.#ray);
  }

  press(deeper) { this.#memory.core._palpate_web_rider_press(this.#rider, deeper); }
  park(parked) {
    this.#memory.core._palpate_web_rider_park(this.#rider, parked ? 1 : 0);
    this.parked = Boolean(parked);
  }
  get depth() { return this.#memory.core._palpate_web_rider_depth(this.#rider); }
  move(seconds, {dragging = false, pace = 1} = {}) {
    this.#memory.core._palpate_web_rider_move(this.#rider, seconds, dragging ? 1 : 0, pace);
  }

  advance(gripper) {
    this.#memory.check(this.#memory.core._palpate_web_rider_advance(this.#rider, gripper, this.#sample));
    return this.#memory.read('sample', this.#sample);
  }

  close() { this.free(); }

  /** For Simulation.close(). */
  free() {
    if (this.#handle === 0) return;
    const {core} = this.#memory;
    core._palpate_web_rider_close(this.#handle);
    core._free(this.#ray);
    core._free(this.#sample);
    this.#handle = 0;
  }
}

class View {
  #memory;
  #canvas;
  #context;
  #handle;
  #numbers;  // 10 numbers, for calls
  #snapshot = 0;

  constructor(memory, canvas, simulation) {
    this.#memory = memory;
    const {core} = memory;
    const opened = openHandles.get(simulation);
    if (opened?.memory !== memory) refuse('simulation: must be open, and opened by the same module');
    const context = canvas.getContext(
        'webgl2', {alpha: false, antialias: false, depth: false, powerPreference: 'high-performance'});
    if (!context?.getExtension('EXT_color_buffer_float')) {
      throw new PalpateError('other', 'no picture can be drawn: needs WebGL2 with EXT_color_buffer_float');
    }
    this.#canvas = canvas;
    this.#context = core.GL.registerContext(context, {majorVersion: 2, minorVersion: 0});
    core.GL.makeContextCurrent(this.#context);
    this.#handle = memory.borrow(4, (out) => {
      memory.check(core._palpate_web_view_open(opened.handle, canvas.width, canvas.height, out));
      return core.HEAPU32[out >> 2];
    });
    this.#numbers = memory.allocate(80);
    this.driver = core.UTF8ToString(core._palpate_web_view_driver(this.#handle));
  }

  /** Makes the canvas's context current. */
  get #view() {
    if (this.#handle === 0) refuse('the view is closed');
    this.#memory.core.GL.makeContextCurrent(this.#context);
    return this.#handle;
  }

  draw(snapshot) {
    const view = this.#view;
    const {core} = this.#memory;
    const {width, height} = this.#canvas;
    if (snapshot === undefined) {
      this.#memory.check(core._palpate_web_view_draw(view, 0, 0, width, height));
      return;
    }
    if (this.#snapshot === 0) this.#snapshot = this.#memory.allocate(core._palpate_web_snapshot_size());
    core.HEAPU8.set(snapshot.subarray(0, core._palpate_web_snapshot_size()), this.#snapshot);
    this.#memory.check(core._palpate_web_view_draw(view, this.#snapshot, snapshot.length, width, height));
  }

  drawState({organ, hands}) {
    const view = this.#view;
    const {core} = this.#memory;
    const {width, height} = this.#canvas;
    const pose = ({position, orientation}) =>
        [...vector(position, 'position'), ...vector(orientation, 'orientation', 4)];
    const numbers = [...pose(organ), ...hands.flatMap(({contacts, gripper, ...hand}) => [
      ...pose(hand), gripper, contacts.length, ...contacts.flatMap((contact) => [
        ...vector(contact.point, 'point'), ...vector(contact.direction, 'direction'), contact.depth, contact.tipRadius,
        contact.halfWidth, contact.pull ? 1 : 0,
      ])])];
    this.#memory.borrow(8 * numbers.length, (at) => {
      this.#memory.setNumbers(at, numbers);
      this.#memory.check(core._palpate_web_view_draw_state(view, at, numbers.length, width, height));
    });
  }

  get camera() {
    this.#memory.core._palpate_web_view_camera(this.#view, this.#numbers);
    const all = this.#memory.numbers(this.#numbers, 10);
    return {eye: all.slice(0, 3), target: all.slice(3, 6), up: all.slice(6, 9), verticalViewDeg: all[9]};
  }

  set camera({eye, target, up, verticalViewDeg}) {
    const view = this.#view;
    this.#memory.setNumbers(this.#numbers, [
      ...vector(eye, 'camera.eye'), ...vector(target, 'camera.target'), ...vector(up, 'camera.up'), verticalViewDeg,
    ]);
    this.#memory.check(this.#memory.core._palpate_web_view_set_camera(view, this.#numbers));
  }

  orbit(right, up) { this.#memory.core._palpate_web_view_orbit(this.#view, right, up); }
  pan(right, up) { this.#memory.core._palpate_web_view_pan(this.#view, right, up); }
  zoom(factor) { this.#memory.core._palpate_web_view_zoom(this.#view, factor); }
  frame(closeUp) { this.#memory.check(this.#memory.core._palpate_web_view_frame(this.#view, closeUp ? 1 : 0)); }

  keepInFrame() { return this.#memory.core._palpate_web_view_keep_in_frame(this.#view) !== 0; }

  marks({width, height, letters, force = true, scale = true, axes = true, section = true, inside = false}) {
    const which = (force ? 1 : 0) | (scale ? 2 : 0) | (axes ? 4 : 0) | (section ? 8 : 0) | (inside ? 16 : 0);
    const {core} = this.#memory;
    const {lines, triangles, words} = JSON.parse(core.UTF8ToString(
        core._palpate_web_view_marks(this.#view, width, height, letters, which)));
    return {
      lines: lines.map(([x1, y1, x2, y2, wide, colour]) => ({from: [x1, y1], to: [x2, y2], width: wide, colour: MARK_COLOURS[colour]})),
      triangles: triangles.map(([x1, y1, x2, y2, x3, y3, colour]) => ({corners: [[x1, y1], [x2, y2], [x3, y3]], colour: MARK_COLOURS[colour]})),
      words: words.map(([x, y, colour, text]) => ({at: [x, y], colour: MARK_COLOURS[colour], text})),
    };
  }

  steer(hand, right, up) {
    this.#memory.check(this.#memory.core._palpate_web_view_steer(this.#view, hand, right, up, this.#numbers));
    return this.#memory.numbers(this.#numbers, 3);
  }

  ray(x, y) {
    this.#memory.core._palpate_web_view_ray(this.#view, x, y, this.#numbers);
    const all = this.#memory.numbers(this.#numbers, 6);
    return {origin: all.slice(0, 3), direction: all.slice(3)};
  }

  pick(x, y) {
    if (this.#memory.core._palpate_web_view_pick(this.#view, x, y, this.#numbers) === 0) return null;
    const all = this.#memory.numbers(this.#numbers, 6);
    return {world: all.slice(0, 3), organ: all.slice(3)};
  }

  showDisplacement(range) {
    this.#memory.check(this.#memory.core._palpate_web_view_show_displacement(this.#view, range));
  }

  showDrape(shown) { this.#memory.check(this.#memory.core._palpate_web_view_show_drape(this.#view, shown ? 1 : 0)); }

  #show(call, rows) {
    const view = this.#view;
    const numbers = rows.flat();
    this.#memory.borrow(8 * numbers.length, (at) => {
      this.#memory.setNumbers(at, numbers);
      this.#memory.check(call(view, at, rows.length));
    });
  }

  showInclusions(inclusions) {
    this.#show(this.#memory.core._palpate_web_view_show_inclusions, inclusions.map(
        ({position, radius, stiffnessRatio}) => [...vector(position, 'position'), radius, stiffnessRatio]));
  }

  showMarks(marks) {
    this.#show(this.#memory.core._palpate_web_view_show_marks, marks.map(({position, kind}) => {
      if (!MARKS.includes(kind)) refuse(`mark.kind = ${kind}: must be ${MARKS.join(', ')}`);
      return [...vector(position, 'position'), MARKS.indexOf(kind)];
    }));
  }

  get quality() { return QUALITIES[this.#memory.core._palpate_web_view_quality(this.#view)]; }

  set quality(quality) {
    if (quality !== 'auto' && !QUALITIES.includes(quality)) {
      refuse(`quality = ${quality}: must be auto, ${QUALITIES.join(', ')}`);
    }
    this.#memory.check(this.#memory.core._palpate_web_view_set_quality(this.#view, QUALITIES.indexOf(quality)));
  }

  close() {
    if (this.#handle === 0) return;
    this.#memory.core._palpate_web_view_close(this.#view);
    this.#memory.core.GL.deleteContext(this.#context);
    this.#memory.core._free(this.#numbers);
    if (this.#snapshot !== 0) this.#memory.core._free(this.#snapshot);
    this.#handle = 0;
  }
}
