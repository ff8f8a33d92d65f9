// Palpate in JavaScript: haptic soft tissue in browsers and Node.
//
// Units are SI (m, N, N m, s). Quaternions are [w, x, y, z]. The world frame is right-handed with z up. A
// failing call throws PalpateError, whose message names the field, its value and the accepted values.
//
// Threads: one module instance (loadPalpate) belongs to one page, worker or Node thread. A page usually lets a
// worker tick and draws in the page: both load the module and open the same scene, and the worker posts
// Simulation.snapshot().

export type Vector = [number, number, number];
export type Quaternion = [number, number, number, number];

/** Why a call failed: 'use' (wrong call), 'input' (scene, file or number) or 'other' (no memory). */
export class PalpateError extends Error {
  readonly kind: 'use' | 'input' | 'other';
}

export interface LoadOptions {
  /** Address of palpate.wasm, absolute or relative to palpate.js; default: beside palpate.js. */
  wasmUrl?: string | URL;
}

/** Loads the module. The only asynchronous call. @throws Error if palpate.wasm cannot be read. */
export function loadPalpate(options?: LoadOptions): Promise<Palpate>;

export interface OpenOptions {
  /** Scene as TOML text; default: the built-in press of the gallbladder (task 'pull': of the heart). */
  scene?: string;
  /** Replaces the scene's task. */
  task?: 'press' | 'pull' | 'palpate';
  /** Replaces the scene's organ: a built-in name, or a name in `files`. */
  organ?: string;
  /** Unit of an organ's file. */
  organUnit?: 'mm' | 'cm' | 'm' | 'in';
  /** Replaces the scene's tissue: a built-in name, or a name in `files`. */
  tissue?: string;
  /** Replaces the scene's device: a kind such as 'haply', in a scene of one hand. */
  device?: string;
  /** Replaces the scene's seed, of touch noise and hidden lumps. */
  seed?: number | bigint | string;
  /** Files that the scene names (meshes, tissues, paths), by their relative path. */
  files?: Record<string, Uint8Array | string>;
  /**
   * true: no hand holds the device, and the full force applies at once. false (default): the force starts by
   * a ramp after the hand was still outside the tissue.
   */
  noHand?: boolean;
  /** Keeps every tick for recordingCsv(). */
  record?: boolean;
  /** Longest edge of surface() [m], 1e-4 to 1; default: the edges of the organ's mesh. */
  surfaceEdge?: number;
  /** Receives the progress of open(), 0 to 1, with a description. */
  progress?: (share: number, what: string) => void;
}

/** One sample of a hand's device, in the device frame. */
export interface Sample {
  /** m */
  position: Vector;
  /** Default: [1, 0, 0, 0]. */
  orientation?: Quaternion;
  /** m/s; default: 0. */
  velocity?: Vector;
  /** 0 closed .. 1 open; default: 0. */
  gripper?: number;
  /** s since the device took the sample; over 0.005 is a fault. Default: 0. */
  age?: number;
  /** One bit per button. */
  buttons?: number;
  /** A Fault of the device; such a sample needs no pose. Default: 0. */
  fault?: number;
}

/** Result of one hand at one tick. */
export interface Result {
  tick: number;
  /** s, tick / rate */
  time: number;
  /** N, for the device, in the device frame; write it unchanged. */
  deviceForce: Vector;
  /** N m, about the handle's origin */
  deviceTorque: Vector;
  /** N */
  gripperForce: number;
  /** N, in the world frame */
  force: Vector;
  /** N m */
  torque: Vector;
  /** N, norm before the limits */
  tissueForce: number;
  /** N, touch noise, signed along the normal */
  noiseForce: number;
  /** N */
  friction: number;
  /** m, tool to organ, negative inside */
  distance: number;
  /** m, penetration depth of the contact with the largest force */
  depth: number;
  /** m, on the rest surface; without contact the nearest point */
  contact: Vector;
  normal: Vector;
  /** m, of the handle, in the world frame */
  toolPosition: Vector;
  toolOrientation: Quaternion;
  /** 0 closed .. 1 open */
  gripper: number;
  /** J, work on the tissue force that was not returned; outside the tissue a surplus is reset to 0 */
  energy: number;
  /** Gain of force and noise (force ramp), 0 .. 1 */
  engagement: number;
  /** 0 approach, 1 press, 2 pull */
  phase: number;
  /** Layer of the layered law; 0 without contact */
  cutoffLayer: number;
  /** 1: past the last layer, the force stays constant */
  saturated: number;
  /** Bits of Palpate.status. */
  status: number;
  /** Latched Fault; palpate.describeFault() explains it. */
  fault: number;
}

export interface Info {
  /** 1 .. 4 */
  hands: number;
  /** One bit per hand that a hand holds. */
  held: number;
  /** Hz, ticks per second */
  rate: number;
  /** N */
  maxForce: number;
  /** N m */
  maxTorque: number;
  /** Of the touch noise. */
  seed: bigint;
  /** Number of ticks of scriptedSample(). */
  scriptedTicks: number;
  /** Of surface(). */
  vertices: number;
  triangles: number;
}

/** What a simulation's scene is about. */
export interface SceneDescription {
  task: 'press' | 'pull' | 'palpate';
  /** Built-in names, or names of files. */
  organ: string;
  tissue: string;
  /** One per hand. */
  tools: string[];
  /** A tool has jaws. */
  jaws: boolean;
  /** Number of hidden inclusions. */
  lumps: number;
  /** m: a mark within it finds a lump. */
  tolerance: number;
}

/** A scene that comes with the module, as in `palpate list scenes`. */
export interface BuiltinScene {
  name: string;
  title: string;
  /** What the user does in it. */
  line: string;
  /** For OpenOptions.scene. */
  toml: string;
}

/** A sphere in the organ of another stiffness. */
export interface Inclusion {
  name: string;
  /** m, of the centre, in the organ frame */
  position: Vector;
  /** m */
  radius: number;
  /** Young's modulus divided by that of the tissue, 0.1 to 100 */
  stiffnessRatio: number;
  /** false: hidden, for a search; do not draw it. */
  visible: boolean;
}

/** Touch noise: its standard deviation is gain / (distance + threshold). */
export interface Noise {
  enabled: boolean;
  /** N m, >= 0 */
  gain: number;
  /** m, > 0 */
  threshold: number;
}

/** Poses at the tick of a surface, in the world frame. */
export interface Picture {
  tick: number;
  organPosition: Vector;
  organOrientation: Quaternion;
  toolPosition: Vector[];
  toolOrientation: Quaternion[];
  gripper: number[];
}

export interface Surface {
  /** m, x y z in turn, in the organ frame */
  positions: Float64Array;
  /** Three vertex indices each, counter-clockwise from outside; the same array at every call. */
  triangles: Int32Array;
  picture: Picture;
}

/** One organ and one instrument per hand. */
export interface Simulation {
  readonly info: Info;
  readonly name: string;
  readonly scene: Readonly<SceneDescription>;
  /** Repairs of the mesh and warnings about the scene, one line each. */
  readonly remarks: string[];

  /**
   * Computes the next tick from one sample per hand. The program must call it info.rate times a second. Equal
   * samples give equal results bit for bit, in every browser and in the native library.
   * @param results results of an earlier tick, to be filled again without new objects
   */
  tick(samples: Sample[], results?: Result[]): Result[];
  /** Sample of a scripted motion at a tick, without a device: onto the organ, into it or a pull, and back. */
  scriptedSample(hand: number, tick: number): Sample;
  /** A hand that follows a pointer: see Follower. It starts where the scripted motion starts. */
  follower(hand: number): Follower;
  /** A tool that rides on the organ under a pointer: see Rider. It starts where the scripted motion starts. */
  rider(hand: number): Rider;
  /** Clears the latched faults of some hands at the next tick. @param handBits bit 0 is the first hand */
  resetFault(handBits: number): void;
  /** Back to the state before tick 0; inclusions, tissue and noise as the scene states. Not while recording. */
  restart(): void;

  /** Replaces the tissue by a built-in one from the next tick on: 'gallbladder', 'heart', 'liver', ... */
  setTissue(name: string): void;
  /** Changes one number of the tissue, in the unit of its name. @param field one of Palpate.tissueFields */
  setTissueValue(field: string, value: number): void;
  tissueValue(field: string): number;
  /** Sets the touch noise from the next tick on, with a crossfade of 50 ms. */
  setNoise(noise: Noise): void;
  noise(): Noise;

  inclusions(): Inclusion[];
  /** Moves an inclusion or sets its stiffness ratio from the next tick on. */
  setInclusion(index: number, change: {position?: Vector; stiffnessRatio?: number}): void;

  /** The deformed surface at the newest tick, for programs that draw it themselves. */
  surface(): Surface;
  /**
   * The state after the newest tick for View.draw() of another instance of the same module. Plain bytes:
   * postMessage() may transfer its buffer.
   */
  snapshot(): Uint8Array;
  /** All ticks so far as CSV: the columns of `palpate export`. Needs `record`. */
  recordingCsv(): string;
  /** Frees everything. Views of the simulation must be closed before. */
  close(): void;
}

/**
 * Turns the jumps of a mouse or finger into smooth hand motion: a critically damped filter (40 1/s), at most
 * 0.1 m/s and 0.15 m from the start, as with `palpate run --device mouse`.
 */
export interface Follower {
  /** m, position of the handle at the start, in the world frame */
  readonly start: Vector;
  /** Unit direction of the tool in the world frame: a positive motion along it presses. */
  readonly axis: Vector;
  /** Opening of the jaws at the start, 0 closed .. 1 open. */
  readonly gripper: number;
  /**
   * One tick towards a target. Call it once per tick. @param target m, of the handle, in the world frame
   * @return the sample for Simulation.tick()
   */
  advance(target: Vector, gripper: number): Sample;
  /** The point nearest to `target` that the hand can reach. */
  withinReach(target: Vector): Vector;
}

/** A line of sight in the world frame. */
export interface Ray {
  origin: Vector;
  /** Unit. */
  direction: Vector;
}

/**
 * Holds a tool under a pointer, as `palpate run --device mouse` does in its window: it rides on the organ's rest
 * surface at the first point on the line of sight, at a set height or depth along the surface's normal, and goes around
 * the organ without touching before a press. A Follower's filter smooths the hand.
 */
export interface Rider {
  /** The pointer's line of sight (View.ray); null: it is elsewhere, and the tool stays. */
  pointAt(ray: Ray | null): void;
  /** Changes the set depth [m]; positive presses. In a drag it moves the tool along the surface's normal. */
  press(deeper: number): void;
  /** Lifts the tool 30 mm off the organ, or brings it back under the pointer. */
  park(parked: boolean): void;
  readonly parked: boolean;
  /**
   * Set depth under the surface [m], -0.03 to 0.03, a needle's to its length; negative: height above it. It begins at
   * -0.005.
   */
  readonly depth: number;
  /**
   * Moves the target on; call it some times in each of a screen's pictures, or once. @param seconds since the last call,
   * at most 0.05 count @param how dragging: the jaws hold tissue, and the tool follows the pointer in a plane that faces
   * the viewer (default: false); pace: factor of the speed, 0 to 1 (default: 1)
   */
  move(seconds: number, how?: {dragging?: boolean; pace?: number}): void;
  /** One tick of the hand towards the target. @return the sample for Simulation.tick() */
  advance(gripper: number): Sample;
  /** Frees the rider before its simulation is closed. */
  close(): void;
}

/** Answer of a force law. */
export interface Response {
  /** m */
  depth: number;
  /** N */
  force: number;
  /** N/m */
  stiffness: number;
  cutoffLayer: number;
  saturated: boolean;
}

/** Force law of a tissue in one direction. */
export interface Law {
  /** @param depth m, >= 0 */
  forceAt(depth: number): Response;
  /** @param force N, >= 0 */
  depthUnder(force: number): Response;
  close(): void;
}

export interface Camera {
  /** m, world frame */
  eye: Vector;
  target: Vector;
  up: Vector;
  verticalViewDeg: number;
}

/** Shapes over a picture, from its upper left corner. Colours are names: the caller has the colours. */
export interface PictureMarks {
  lines: {from: [number, number]; to: [number, number]; width: number; colour: MarkColour}[];
  triangles: {corners: [number, number][]; colour: MarkColour}[];
  /** at: the upper left corner of the text */
  words: {at: [number, number]; colour: MarkColour; text: string}[];
}
export type MarkColour = 'text' | 'force' | 'x' | 'y' | 'z';

export interface Mark {
  /** m, organ frame */
  position: Vector;
  /** found: a dot in a ring; false: a cross; lump: a larger ring */
  kind: 'found' | 'false' | 'lump';
}

/** Poses and contacts that another program computed, such as `palpate serve` (`picture`). */
export interface PictureState {
  /** m, world frame */
  organ: {position: Vector; orientation: Quaternion};
  /** One per instrument of the scene. */
  hands: {
    position: Vector;
    orientation: Quaternion;
    /** 0 closed .. 1 open */
    gripper: number;
    /** Organ frame, m */
    contacts: {
      point: Vector;
      /** Unit, displacement of the surface */
      direction: Vector;
      depth: number;
      tipRadius: number;
      /** Of the tool there; 0: no bound */
      halfWidth: number;
      pull: boolean;
    }[];
  }[];
}

/** Draws a simulation to a canvas by WebGL2, as the program's window does. */
export interface View {
  /**
   * Draws one state. The size of the canvas in pixels (canvas.width, canvas.height) is the picture's.
   * @param snapshot Simulation.snapshot(); default: the newest tick of the view's own simulation
   */
  draw(snapshot?: Uint8Array): void;
  /** Draws organ and instruments of the scene in this state. */
  drawState(state: PictureState): void;
  /** The camera of the next picture. Initially it shows the whole organ and the tool tip. */
  camera: Camera;
  /** Turns the camera about its target [rad]. */
  orbit(right: number, up: number): void;
  /** Moves camera and target by fractions of the picture's height. */
  pan(right: number, up: number): void;
  /** Multiplies the distance to the target; below 1: nearer. */
  zoom(factor: number): void;
  /** Frames the contact of the last drawn state (closeUp), or takes the first view of the program's window. */
  frame(closeUp: boolean): void;
  /** Moves back a little if a tool or a contact of the last drawn state is outside the picture. @return whether it moved */
  keepInFrame(): boolean;
  /**
   * The marks that the program's window draws over its picture, for the last drawn state: force arrows, a scale bar (true at
   * the view's centre), the world's axes, and for a needle that goes into layers the section along it and its shaft inside. @param size of the picture and of its letters, in any unit; a small picture has none
   */
  marks(size: {
    width: number; height: number; letters: number; force?: boolean; scale?: boolean; axes?: boolean; section?: boolean; inside?: boolean;
  }): PictureMarks;
  /**
   * Motion of a pointer as motion of a tool: the displacement [m, world frame] across the tool's axis for a
   * motion by these fractions of the picture's height.
   */
  steer(hand: number, right: number, up: number): Vector;
  /** Line of sight through a pixel [CSS or device pixels over the canvas's size: 0 .. 1, y down]. */
  ray(x: number, y: number): {origin: Vector; direction: Vector};
  /** Point of the rest surface under a pixel as in ray(), for the pose of the last drawn state; or null. */
  pick(x: number, y: number): {world: Vector; organ: Vector} | null;
  /** Colours the organ by its displacement up to `range` [m]; 0: its own colours. */
  showDisplacement(range: number): void;
  /** Shows or hides the surgical drape under the organ, initially hidden. */
  showDrape(shown: boolean): void;
  /** Replaces the inclusions that are drawn inside the organ; initially the visible ones. [] hides all. */
  showInclusions(inclusions: Pick<Inclusion, 'position' | 'radius' | 'stiffnessRatio'>[]): void;
  /** Replaces the marks on the surface, at most 32. */
  showMarks(marks: Mark[]): void;
  /**
   * Quality of the next picture. 'auto' lowers and raises it between 'balanced' and 'fast' by the time that
   * pictures take (initially). Reading it gives the quality in use.
   */
  get quality(): 'full' | 'balanced' | 'fast';
  set quality(quality: 'auto' | 'full' | 'balanced' | 'fast');
  /** Name of the graphics driver. */
  readonly driver: string;
  /** Frees the view. The canvas keeps its WebGL2 context. */
  close(): void;
}

export interface Palpate {
  /** For example '0.2.0'. */
  readonly version: string;
  /** Names of the numbers of a tissue, as in tissue files: 'k1_N_per_m', 'contact.friction', ... */
  readonly tissueFields: readonly string[];
  /** Names of the built-in tissues. */
  readonly tissueNames: readonly string[];
  /** The built-in scenes, in the order of `palpate list scenes`. */
  readonly scenes: readonly Readonly<BuiltinScene>[];
  /** Bits of Result.status by their names in palpate.h: {STARTED_INSIDE: 1, ...}. */
  readonly status: Readonly<Record<string, number>>;
  open(options?: OpenOptions): Simulation;
  /**
   * Force law of a tissue. @param tissue name of a built-in tissue @param rate Hz, limits the number of
   * layers; default: 1000
   */
  law(tissue: string, direction: 'press' | 'pull', rate?: number): Law;
  /**
   * Sample of the touch noise in its steady state [N].
   * @param settings gain [N m], threshold [m], distance [m, default 0: in contact], seed (1), hand (0), tick (0)
   */
  noiseSample(settings: {
    gain: number; threshold: number; distance?: number; seed?: number | bigint; hand?: number; tick?: number;
  }): number;
  /** Description of a fault: 'the device could not be read, or refused a command'. */
  describeFault(fault: number): string;
  /**
   * Draws `simulation` to `canvas`, which must have no context of another kind yet.
   * @throws PalpateError without WebGL2 or its extension EXT_color_buffer_float
   */
  view(canvas: HTMLCanvasElement | OffscreenCanvas, simulation: Simulation): View;
  /** Bytes of the module's memory in use, for tests of leaks. */
  memoryInUse(): number;
}
