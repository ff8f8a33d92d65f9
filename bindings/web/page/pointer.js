// Mouse, fingers, wheel and keys on the picture: they move the tool's target or the view.
import {add, clamp, dot, norm, scaled, sub} from './vectors.js';

const NOTCH = 1e-3;          // m along the tool axis per notch of the wheel
const FINE = 0.2;            // factor while Shift is held
const MAX_DISTANCE = 0.15;   // m, of the target from the start, as the follower's
const WHEEL_NOTCH = 100;     // CSS pixels of a notch
const MOST_NOTCHES = 20;     // of one event; a slow page gets several turns of the wheel as one
const KEY_STEP = 0.015;      // fraction of the picture's height per key press
const KEY_TURN = 0.06, TURN = 0.008;  // rad per key press and per CSS pixel
const NEARER = 0.88;         // factor of the distance per notch

/** The tool's target, in the world frame. */
export class Steering {
  constructor() { this.take({start: [0, 0, 0], axis: [0, 0, -1], gripper: 0, epoch: 0}); }

  /** Begins at a follower's start: position [m], axis (towards the organ), opening of the jaws. */
  take({start, axis, gripper, epoch}) {
    Object.assign(this, {epoch, start, axis, target: start, rest: gripper, closed: false, gain: 1});
  }
  /** Moves the target [m]; beyond reach it waits at the edge, so that it turns round at once. */
  move(way) {
    const far = sub(add(this.target, way), this.start), length = norm(far);
    this.target = add(this.start, length > MAX_DISTANCE ? scaled(MAX_DISTANCE / length, far) : far);
  }
  /** Moves the target along the tool's axis [m]; a lift is never slowed. */
  press(way) { this.move(scaled(way > 0 ? this.gain * way : way, this.axis)); }
  /** Position of the target along the axis [m], from the start. */
  get depth() { return dot(sub(this.target, this.start), this.axis); }
  set depth(value) { this.move(scaled(value - this.depth, this.axis)); }
  get gripper() { return this.closed ? 0 : this.rest; }
  get input() { return {epoch: this.epoch, target: this.target, gripper: this.gripper, buttons: this.closed ? 1 : 0}; }
}

/**
 * Listens on the stage. @param page {view(): View or null, steering, take(): called before the pointer moves the tool,
 *   moved(): the view changed, commands: {KEY: function}}
 */
export function listen(stage, picture, page) {
  const fingers = new Map();
  let spread = 0;

  const steer = (right, up, fine) => {
    const view = page.view();
    if (!view || !page.take()) return;
    page.steering.move(scaled(page.steering.gain * (fine ? FINE : 1), view.steer(0, right, up)));
  };
  const press = (way, fine) => { if (page.take()) page.steering.press(way * (fine ? FINE : 1)); };
  const turn = (right, up) => { page.view()?.orbit(right, up); page.moved(); };
  const zoom = factor => { page.view()?.zoom(factor); page.moved(); };
  const distance = () => {
    const [a, b] = [...fingers.values()];
    return Math.hypot(a.x - b.x, a.y - b.y);
  };

  picture.addEventListener('contextmenu', event => event.preventDefault());
  picture.addEventListener('pointerdown', event => {
    stage.focus({preventScroll: true});
    picture.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, {x: event.clientX, y: event.clientY, button: event.button});
    if (fingers.size === 2) spread = distance();
    if (fingers.size === 1 && event.button === 0) page.take();
    picture.firstElementChild?.classList.add('held');
  });
  picture.addEventListener('pointermove', event => {
    const finger = fingers.get(event.pointerId);
    if (!finger) return;
    const [right, down] = [event.clientX - finger.x, event.clientY - finger.y], height = picture.clientHeight;
    [finger.x, finger.y] = [event.clientX, event.clientY];
    if (fingers.size === 2) {
      turn(0.5 * TURN * right, 0.5 * TURN * down);
      zoom(clamp(spread / Math.max(1, distance()), 0.5, 2));
      spread = distance();
    } else if (finger.button === 0) {
      steer(right / height, -down / height, event.shiftKey);
    } else if (finger.button === 1) {
      page.view()?.pan(right / height, -down / height);
      page.moved();
    } else {
      turn(TURN * right, TURN * down);
    }
  });
  for (const end of ['pointerup', 'pointercancel']) {
    picture.addEventListener(end, event => {
      fingers.delete(event.pointerId);
      if (!fingers.size) picture.firstElementChild?.classList.remove('held');
    });
  }
  picture.addEventListener('wheel', event => {
    event.preventDefault();
    const notches = -clamp(event.deltaY / (event.deltaMode === 0 ? WHEEL_NOTCH : 3), -MOST_NOTCHES, MOST_NOTCHES);
    if (event.ctrlKey) zoom(NEARER ** notches); else press(notches * NOTCH, event.shiftKey);
  }, {passive: false});

  const arrows = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1]};
  stage.addEventListener('keydown', event => {
    if (event.target !== stage) return;
    const arrow = arrows[event.key];
    if (arrow && event.altKey) turn(-KEY_TURN * arrow[0], KEY_TURN * arrow[1]);
    else if (arrow) steer(KEY_STEP * arrow[0], KEY_STEP * arrow[1], event.shiftKey);
    else if (event.key === 'PageDown') press(NOTCH, event.shiftKey);
    else if (event.key === 'PageUp') press(-NOTCH, event.shiftKey);
    else return;
    event.preventDefault();
  });
  document.addEventListener('keydown', event => {
    const command = page.commands[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    // A focused control keeps the keys that it uses itself.
    const {target} = event, control = target.closest?.('input, select, button, summary');
    const keeps = control && (target.type === 'range' ? event.key === 'Home' : target.matches('[type=text], select') || event.key.length > 1 || event.key === ' ');
    if (!command || keeps || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    if (!event.repeat) command();
  });
}
