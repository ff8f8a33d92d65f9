// Mouse, fingers, wheel and keys on the picture: the tool is under the pointer, or the view turns.
import {clamp, placeOf} from './vectors.js';

const NOTCH = 1e-3;          // m of depth per notch of the wheel
const FINE = 0.2;            // factor while Shift is held
const WHEEL_NOTCH = 100;     // CSS pixels of a notch
const MOST_NOTCHES = 20;     // of one event; a slow page gets several turns of the wheel as one
const KEY_STEP = 0.015;      // fraction of the picture's height per key press
const KEY_TURN = 0.06, TURN = 0.008;  // rad per key press and per CSS pixel
const NEARER = 0.88;         // factor of the distance per notch

/**
 * Listens on the stage. @param page {view(): View or null, take(fromDemonstration): whether the pointer holds the tool,
 *   takeByLever(): takes it without a place, send(what, fields): to the worker, nearest(): place of the organ nearest to the
 *   tool [m, world], moved(): the user moved the view, primary(down): left button of the mouse, touched(): a finger was used,
 *   looks(): whether the pointer moves the view alone (absent: never), commands: {KEY: function}}
 */
export function listen(stage, picture, page) {
  const fingers = new Map(), looks = () => page.looks?.() ?? false;
  let spread = 0;
  let place = null;  // of the pointer over the picture, 0 to 1; null: it is elsewhere

  const aim = () => {
    const view = page.view();
    if (view && place && page.take(false)) page.send('point', {ray: view.ray(place.x, place.y)});
  };
  const point = event => {
    const box = picture.getBoundingClientRect();
    place = {x: clamp((event.clientX - box.left) / box.width, 0, 1), y: clamp((event.clientY - box.top) / box.height, 0, 1)};
    aim();
  };
  const freeze = () => {
    if (place) page.send('point', {ray: null});
    place = null;
  };
  /** Moves the tool's place by fractions of the picture's height, for keys. */
  const step = (right, up) => {
    const view = page.view(), aspect = picture.clientWidth / picture.clientHeight;
    if (!view || !page.take(true)) return;
    place ??= placeOf(view.camera, aspect, page.nearest()) ?? {x: 0.5, y: 0.5};
    place = {x: clamp(place.x + right / aspect, 0, 1), y: clamp(place.y - up, 0, 1)};
    aim();
  };
  const press = (deeper, fine) => {
    if (place ? !page.take(true) : !page.takeByLever()) return;
    aim();
    page.send('press', {deeper: deeper * (fine ? FINE : 1)});
  };
  const turn = (right, up) => { page.view()?.orbit(right, up); page.moved(); };
  const zoom = factor => { page.view()?.zoom(factor); page.moved(); };
  const distance = () => {
    const [a, b] = [...fingers.values()];
    return Math.hypot(a.x - b.x, a.y - b.y);
  };

  picture.addEventListener('contextmenu', event => event.preventDefault());
  picture.addEventListener('pointerdown', event => {
    stage.focus({preventScroll: true, focusVisible: false});
    picture.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, {x: event.clientX, y: event.clientY, button: event.button});
    if (event.pointerType === 'touch') page.touched();
    if (fingers.size === 2) {
      spread = distance();
      freeze();
    } else if (fingers.size === 1 && event.button === 0 && !looks()) {
      const had = page.take(false);
      page.take(true);
      point(event);
      if (had && event.pointerType !== 'touch') page.primary(true);
    } else {
      freeze();
    }
  });
  picture.addEventListener('pointermove', event => {
    const finger = fingers.get(event.pointerId);
    if (!finger) {
      if (event.pointerType !== 'touch') point(event);
      return;
    }
    const [right, down] = [event.clientX - finger.x, event.clientY - finger.y], height = picture.clientHeight;
    [finger.x, finger.y] = [event.clientX, event.clientY];
    if (fingers.size >= 2) {
      turn(0.5 * TURN * right, 0.5 * TURN * down);
      zoom(clamp(spread / Math.max(1, distance()), 0.5, 2));
      spread = distance();
    } else if (finger.button === 0 && !looks()) {
      point(event);
    } else if (finger.button === 1) {
      page.view()?.pan(right / height, -down / height);
      page.moved();
    } else {
      turn(TURN * right, TURN * down);
    }
  });
  for (const end of ['pointerup', 'pointercancel']) {
    picture.addEventListener(end, event => {
      const finger = fingers.get(event.pointerId);
      fingers.delete(event.pointerId);
      if (finger?.button === 0 && event.pointerType !== 'touch') page.primary(false);
    });
  }
  // The tool stays under the last place of a finger, also after a tap.
  picture.addEventListener('pointerleave', event => { if (event.pointerType !== 'touch') freeze(); });
  picture.addEventListener('wheel', event => {
    event.preventDefault();
    const notches = -clamp(event.deltaY / (event.deltaMode === 0 ? WHEEL_NOTCH : 3), -MOST_NOTCHES, MOST_NOTCHES);
    if (event.ctrlKey || looks()) {
      zoom(NEARER ** notches);
      aim();
    } else {
      // With Shift, browsers turn the wheel sideways.
      const sideways = -clamp(event.deltaX / WHEEL_NOTCH, -MOST_NOTCHES, MOST_NOTCHES);
      press((notches || (event.shiftKey ? sideways : 0)) * NOTCH, event.shiftKey);
    }
  }, {passive: false});

  const arrows = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1]};
  stage.addEventListener('keydown', event => {
    if (event.target !== stage) return;
    const arrow = arrows[event.key];
    if (arrow && event.altKey) turn(-KEY_TURN * arrow[0], KEY_TURN * arrow[1]);
    else if (arrow) step(KEY_STEP * (event.shiftKey ? FINE : 1) * arrow[0], KEY_STEP * (event.shiftKey ? FINE : 1) * arrow[1]);
    else if (event.key === 'PageDown') press(NOTCH, event.shiftKey);
    else if (event.key === 'PageUp') press(-NOTCH, event.shiftKey);
    else if (event.key === '+') zoom(NEARER);
    else if (event.key === '-') zoom(1 / NEARER);
    else return;
    event.preventDefault();
  });
  document.addEventListener('keydown', event => {
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    const control = event.ctrlKey || event.metaKey;
    const command = page.commands[control ? `Ctrl+${event.shiftKey ? 'Shift+' : ''}${key}` : key];
    // A focused control keeps the keys that it uses itself.
    const {target} = event, field = target.closest?.('input, select, button, summary, a');
    const keeps = field && (target.type === 'range' ? event.key === 'Home'
      : target.matches('[type=text], select') || (!control && (event.key.length > 1 || event.key === ' ')));
    if (!command || keeps || event.altKey || document.querySelector('dialog[open]')) return;
    event.preventDefault();
    if (!event.repeat) command();
  });
}
