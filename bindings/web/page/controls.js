// The panel and the words on the picture.
import {TISSUE_SLIDERS, EXERCISES} from './scenes.js';

export const byId = id => document.getElementById(id);

const HINTS = {
  demo: 'Demonstration. Touch the picture to take the tool.',
  press: 'Drag moves the tool; the wheel or the lever presses.',
  pull: 'Press until the jaws touch, close them, then lift.',
  palpate: 'Drag moves the ball; the wheel or the lever presses. Mark what feels hard.',
};
const HAPLY_HINT = 'The Inverse3 holds the tool.';

/** Shows a slider's value. */
function showValue(input) {
  const {unit, decimals} = input.dataset;
  input.closest('label').querySelector('output').textContent = `${Number(input.value).toFixed(decimals)} ${unit}`.trim();
}

export class Controls {
  /** @param page functions that the controls call: send, take, jaws, mark, finish, open, restart, view, map, record; steering */
  constructor(page) {
    this.page = page;
    this.#buttons();
    this.#tissue();
    this.#noise();
    this.#lever();
  }

  #buttons() {
    const {page} = this, click = (id, act) => { byId(id).onclick = act; };
    for (const input of document.querySelectorAll('[name=task]')) input.onchange = () => page.open(input.value);
    click('jaws', page.jaws);
    click('mark', page.mark);
    click('finish', page.finish);
    click('restart', page.restart);
    click('demonstrate', () => page.send('demonstrate'));
    click('whole', () => page.view(false));
    click('close', () => page.view(true));
    click('reset', () => page.send('resetFault'));
    click('record', page.record);
    click('sheet', () => byId('sheet').setAttribute('aria-expanded', byId('sheet').getAttribute('aria-expanded') !== 'true'));
    click('connect', () => page.send('haply', {address: this.linked ? null : byId('address').value.trim()}));
    byId('map').onchange = event => {
      byId('legend').hidden = !event.target.checked;
      page.map(event.target.checked);
    };
  }

  #tissue() {
    for (const {field, label, unit, low, high, step, decimals, meaning, task} of TISSUE_SLIDERS) {
      const row = document.createElement('label'), input = document.createElement('input');
      row.className = 'slider';
      row.title = meaning;
      if (task) row.dataset.task = task;
      Object.assign(input, {type: 'range', min: low, max: high, step, id: field});
      Object.assign(input.dataset, {unit, decimals});
      row.append(label, ' ', document.createElement('output'), input);
      byId('tissue').append(row);
      input.oninput = () => {
        showValue(input);
        byId('preset').value = '';
        this.page.send('tissueValue', {field, value: Number(input.value)});
      };
    }
    byId('preset').onchange = event => this.page.send('tissue', {name: event.target.value});
  }

  #noise() {
    for (const id of ['sigma', 'reach']) {
      byId(id).oninput = () => { showValue(byId(id)); this.#sendNoise(); };
      showValue(byId(id));
    }
    byId('noise').onchange = () => this.#sendNoise();
  }
  #sendNoise() {
    const threshold = 1e-3 * byId('reach').value;
    this.page.send('noise', {noise: {enabled: byId('noise').checked, threshold, gain: 1e-3 * byId('sigma').value * threshold}});
  }
  toggleNoise() { byId('noise').click(); }

  #lever() {
    byId('depth').oninput = event => {
      if (this.page.take()) this.page.steering.depth = 1e-3 * event.target.value;
    };
  }

  /** Colours of the plots, as the style sheet has them. */
  colours() {
    const style = getComputedStyle(document.documentElement);
    const names = ['force', 'depth', 'law', 'grid', 'faint', 'text'];
    return Object.fromEntries(names.map(name => [name, style.getPropertyValue(`--${name}`).trim()]));
  }

  /** Shows the controls of an exercise. */
  exercise(task) {
    document.querySelector(`[name=task][value=${task}]`).checked = true;
    byId('name').textContent = EXERCISES[task].name;
    byId('depth_name').textContent = task === 'pull' ? 'Depth, or stretch' : 'Depth';
    byId('jaws').hidden = task !== 'pull';
    byId('mark').hidden = byId('search').hidden = task !== 'palpate';
    for (const row of document.querySelectorAll('[data-task]')) row.hidden = row.dataset.task !== task;
    byId('score').hidden = true;
    byId('mark').disabled = false;
    byId('finish').textContent = 'End the search';
    byId('marks').textContent = '0';
    byId('fault').hidden = true;
    byId('depth').disabled = true;  // until lever()
    delete document.body.dataset.ready;
    this.#hint('demo');
  }
  #hint(mode, task) {
    byId('hint').textContent = mode === 'demo' ? HINTS.demo : mode === 'haply' ? HAPLY_HINT : HINTS[task];
    byId('lever').hidden = mode === 'haply';
    byId('demonstrate').disabled = mode !== 'pointer';
  }

  opened({task, rate, maxForce, record, noise}) {
    byId('loop').textContent = `${rate} Hz, at most ${maxForce} N`;
    byId('record').classList.toggle('recording', record);
    byId('record').textContent = record ? 'Stop and save CSV' : 'Record';
    byId('noise').checked = noise.enabled;
    byId('sigma').value = 1e3 * noise.gain / noise.threshold;
    byId('reach').value = 1e3 * noise.threshold;
    for (const id of ['sigma', 'reach']) showValue(byId(id));
    this.task = task;
  }
  begun(mode) {
    this.#hint(mode, this.task);
    byId('depth').disabled = true;
  }

  tissue({name, values}) {
    byId('preset').value = name ?? '';
    byId('curves').hidden = !name;
    for (const [field, value] of values) {
      byId(field).value = value;
      showValue(byId(field));
    }
  }

  /** Sets the lever's ends from the distance between tool and organ at the start [m]. */
  lever(distance) {
    const input = byId('depth');
    [input.min, input.max, input.value, input.disabled] = [-15, Math.ceil(1e3 * Math.max(0, distance) + 20), 0, false];
    document.body.dataset.ready = this.task;
  }

  frame({mode, result, felt, fault}, task) {
    const mm = metres => `${(1e3 * metres).toFixed(1)} mm`;
    const {phase, depth, distance, deviceForce, engagement} = result;
    const words = phase === 1 ? `Pressing, ${mm(depth)} deep` : phase === 2 ? `Pulling, stretched ${mm(depth)}`
      : distance < 0 ? 'Inside the organ: move out first' : `${mm(distance)} from the tissue`;
    const ramp = mode === 'haply' && engagement < 1 ? `. Force at ${Math.round(100 * engagement)} %: keep still outside the tissue` : '';
    byId('state').textContent = words + ramp;
    byId('force_now').textContent = `${Math.hypot(...deviceForce).toFixed(2)} N`;
    byId('depth_now').textContent = phase === 0 ? '' : mm(depth);
    if (task === 'palpate') byId('ratio').textContent = felt === null ? 'press deeper than 1 mm' : `${felt.toFixed(2)} times the uniform tissue`;
    byId('fault').hidden = !fault;
    if (fault) byId('fault').firstElementChild.textContent = `Zero force: ${fault}.`;
    if (document.activeElement !== byId('depth')) byId('depth').value = 1e3 * this.page.steering.depth;
  }

  pace({share, tickMicroseconds}, slowShare) {
    byId('slow').hidden = share > slowShare;
    byId('slow').textContent = `Slower than real time: ${Math.round(100 * share)} %`;
    byId('tick').textContent = `${tickMicroseconds.toFixed(1)} \u00b5s in the mean`;
  }
  frames(rate) {
    byId('frames').textContent = `${rate.toFixed(0)} per second`;
  }

  jaws(closed) {
    byId('jaws').setAttribute('aria-pressed', closed);
    byId('jaws').textContent = closed ? 'Open the jaws' : 'Close the jaws';
  }
  marks(count) { byId('marks').textContent = count; }

  score({found, missed, wrong, repeated, error}) {
    const rows = [['Found', `${found} of ${found + missed}`], ['Missed', missed], ['Wrong marks', wrong]];
    if (repeated) rows.push(['Repeated marks', repeated]);
    if (error !== null) rows.push(['Mean distance', `${(1e3 * error).toFixed(1)} mm`]);
    byId('score').replaceChildren(...rows.flatMap(([name, value]) => {
      const [dt, dd] = ['dt', 'dd'].map(tag => document.createElement(tag));
      [dt.textContent, dd.textContent] = [name, value];
      return [dt, dd];
    }));
    byId('score').hidden = false;
    byId('mark').disabled = true;
    byId('finish').textContent = 'Hide other lumps';
  }

  haply({address, arm, grip, trouble, connected}) {
    this.linked = Boolean(address);
    byId('connect').textContent = this.linked ? 'Disconnect' : 'Connect';
    byId('haply').classList.toggle('bad', Boolean(trouble));
    byId('haply').textContent = trouble || (connected ? `Inverse3 ${arm}${grip ? ` with verse grip ${grip}` : ''}`
      : this.linked ? `Connecting to ${address}` : '');
  }
  trouble({of, words}) {
    const place = of === 'haply' ? byId('haply') : byId('hint');
    place.textContent = words;
    if (of === 'haply') place.classList.add('bad');
  }
}
