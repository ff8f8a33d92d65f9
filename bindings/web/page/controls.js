// The panel and the words on the picture.
import {EXERCISES, TISSUE_SLIDERS} from './scenes.js';
import {TissueHistory} from './tissue_history.js';

export const byId = id => document.getElementById(id);

// The words of the program's window, and those for fingers.
const HINTS = {
  demo: ['Demonstration. Click the picture to take the tool.', 'Demonstration. Touch the picture to take the tool.'],
  replay: ['Recording. Click the picture to take the tool.', 'Recording. Touch the picture to take the tool.'],
  haply: ['The Inverse3 holds the tool.', 'The Inverse3 holds the tool.'],
  move: ['Move: mouse.\u2003Press: wheel forward.', 'Move: one finger.\u2003Press: lever.'],
  jaws: ['\u2003Grip: hold left.', '\u2003Grip: Close the jaws.'],
  search: ['\u2003Mark: left button.', '\u2003Mark: button below.'],
  pull: ['Hold left and drag to pull.', 'Close the jaws, then drag to pull.'],
  inside: ['The needle stays on its axis.\u2003In\u00a0and\u00a0out: wheel.', 'The needle stays on its axis.\u2003In\u00a0and\u00a0out: lever.'],
};
const NOTE_TIME = 4000;  // ms that a message stays in place of the hint
const MARKS = ['force', 'scale', 'axes', 'section', 'inside'];

/** Shows a slider's value. */
function showValue(input) {
  const {unit, decimals} = input.dataset;
  input.closest('label').querySelector('output').textContent = `${Number(input.value).toFixed(decimals)} ${unit}`.trim();
}

export class Controls {
  /** @param page functions that the controls call: send, takeByLever, jaws, mark, finish, openScene, restart, view, map, drape, marks, record, link, files */
  constructor(page) {
    this.page = page;
    this.touch = matchMedia('(pointer: coarse)').matches;
    this.history = new TissueHistory();
    this.#buttons();
    this.#dialogs();
    this.#tissue();
    this.#noise();
    this.#lever();
  }

  #buttons() {
    const {page} = this, click = (id, act) => { byId(id).onclick = act; };
    for (const input of document.querySelectorAll('[name=task]')) input.onchange = () => page.openScene(EXERCISES[input.value].scene);
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
    click('link', page.link);
    click('undo', () => this.undo());
    click('redo', () => this.redo());
    click('preset_again', () => this.#change({...this.history.now, values: {}}));
    byId('map').onchange = event => {
      byId('legend').classList.toggle('shown', event.target.checked);
      page.map(event.target.checked);
    };
    byId('drape').onchange = event => page.drape(event.target.checked);
    for (const mark of MARKS) byId(`show_${mark}`).onchange = () => page.marks();
  }

  #tissue() {
    for (const {field, label, unit, low, high, step, decimals, meaning, task} of TISSUE_SLIDERS) {
      const row = document.createElement('label'), input = document.createElement('input');
      row.className = 'slider';
      row.title = meaning;
      if (task) row.dataset.task = task;
      Object.assign(input, {type: 'range', min: low, max: high, step, id: field});
      Object.assign(input.dataset, {unit, decimals, high});
      row.append(label, ' ', document.createElement('output'), input);
      byId('tissue').append(row);
      input.oninput = () => {
        showValue(input);
        const {now} = this.history;
        this.history.change({...now, values: {...now.values, [field]: Number(input.value)}}, field);
        this.page.send('tissueValue', {field, value: Number(input.value)});
        this.#tissueState();
      };
    }
    byId('preset').onchange = event => this.#change({name: event.target.value || null, values: {}});
  }

  undo() { this.#show(this.history.undo()); }
  redo() { this.#show(this.history.redo()); }
  #change(state) {
    this.history.change(state);
    this.#show(state);
  }
  #show(state) {
    if (state) this.page.send('tissue', {name: state.name, values: Object.entries(state.values)});
  }
  #tissueState() {
    const {now, canUndo, canRedo} = this.history, changed = Object.keys(now.values).length > 0;
    byId('preset').value = now.name ?? '';
    for (const option of byId('preset').options) {
      option.textContent = option.dataset.name + (option.selected && changed ? ', changed' : '');
    }
    [byId('undo').disabled, byId('redo').disabled, byId('preset_again').disabled] = [!canUndo, !canRedo, !changed];
  }

  #dialogs() {
    const {page} = this;
    for (const link of document.querySelectorAll('a.about')) {
      link.onclick = event => {
        event.preventDefault();
        byId('about').showModal();
      };
    }
    byId('more').onclick = () => {
      this.#cards();
      byId('gallery').showModal();
    };
    byId('browse').onclick = () => byId('file').click();
    byId('file').onchange = event => {
      page.files(event.target.files);
      event.target.value = '';
    };
    document.addEventListener('dragover', event => event.preventDefault());
    document.addEventListener('drop', event => {
      event.preventDefault();
      if (event.dataTransfer?.files.length) page.files(event.dataTransfer.files);
    });
  }
  /** The gallery, when it is opened first. */
  #cards() {
    if (byId('cards').childElementCount || !this.scenes) return;
    byId('cards').append(...this.scenes.map(({name, title, line}) => {
      const card = document.createElement('button'), picture = document.createElement('img');
      Object.assign(picture, {src: `scenes/${name}.png`, alt: '', loading: 'lazy', width: 240, height: 160});
      const [head, text] = ['b', 'span'].map(tag => document.createElement(tag));
      [head.textContent, text.textContent] = [title, line];
      card.dataset.scene = name;
      card.append(picture, head, text);
      card.onclick = () => {
        byId('gallery').close();
        this.page.openScene(name);
      };
      return card;
    }));
  }
  /** Asks for the unit of a mesh. @return promise of its name; '': cancelled */
  unitOf(file) {
    const dialog = byId('unit');
    byId('unit_of').textContent = `${file}: which unit do its coordinates have?`;
    dialog.returnValue = '';
    dialog.showModal();
    return new Promise(done => { dialog.addEventListener('close', () => done(dialog.returnValue), {once: true}); });
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
    byId('depth').onpointerdown = () => { this.leverHeld = true; };
    byId('depth').onpointerup = byId('depth').onpointercancel = () => { this.leverHeld = false; };
    byId('depth').oninput = event => {
      const value = 1e-3 * event.target.value;
      if (this.page.takeByLever()) this.page.send('press', {deeper: value - this.lever});
      this.lever = value;
    };
  }

  /** Which marks are drawn over the picture. */
  get marksShown() { return Object.fromEntries(MARKS.map(mark => [mark, byId(`show_${mark}`).checked])); }

  /** Colours of the plots, as the style sheet has them. */
  colours() {
    const style = getComputedStyle(document.documentElement);
    const names = ['force', 'depth', 'law', 'grid', 'faint', 'text'];
    return Object.fromEntries(names.map(name => [name, style.getPropertyValue(`--${name}`).trim()]));
  }

  /** Shows that a scene is being opened. */
  opening() {
    byId('answer').hidden = true;
    byId('score').replaceChildren();
    byId('mark').disabled = false;
    byId('finish').textContent = 'End the search';
    byId('marks').textContent = '0';
    byId('fault').hidden = true;
    byId('depth').disabled = true;  // until begun()
    byId('hint').hidden = true;
    delete document.body.dataset.ready;
  }

  /** Shows the controls of a scene. @param line what the user does in it; '': a scene of the user's */
  exercise({task, jaws, lumps}, name, line, builtin) {
    Object.assign(this, {task, jawed: jaws && task !== 'palpate'});
    for (const input of document.querySelectorAll('[name=task]')) input.checked = EXERCISES[input.value].scene === builtin;
    byId('name').textContent = line || name;
    byId('depth_name').textContent = task === 'pull' ? 'Depth, or stretch' : 'Depth';
    byId('mark').hidden = byId('search').hidden = task !== 'palpate' || lumps === 0;
    for (const row of document.querySelectorAll('[data-task]')) row.hidden = row.dataset.task !== task;
  }

  /** One line over the picture: what to do until the first contact; in a pull until the first pull; with a needle inside. */
  hint(mode, touched, pulled, inside) {
    if (performance.now() < (this.noteUntil ?? 0)) return;
    const words = which => HINTS[which][this.touch ? 1 : 0];
    let text = '';
    if (mode !== 'pointer') text = words(mode);
    else if (!touched) text = words('move') + (this.task === 'palpate' ? words('search') : this.task === 'pull' ? words('jaws') : '');
    else if (this.task === 'pull' && !pulled) text = words('pull');
    else if (inside) text = words('inside');
    byId('hint').textContent = text;
    byId('hint').hidden = !text;
    byId('lever').hidden = mode === 'haply';
    byId('demonstrate').disabled = mode === 'demo' || mode === 'haply';
  }
  /** A message in place of the hint, for some seconds. */
  note(words) {
    this.noteUntil = performance.now() + NOTE_TIME;
    byId('hint').textContent = words;
    byId('hint').hidden = false;
  }
  fileNote(words) { byId('file_note').textContent = words; }

  opened({scene, hands, rate, maxForce, record, ownTissue, noise}, fresh) {
    byId('loop').textContent = `${rate} Hz, at most ${maxForce} N`;
    byId('record').classList.toggle('recording', record);
    byId('record').textContent = record ? 'Stop and save CSV' : 'Record';
    byId('noise').checked = noise.enabled;
    byId('sigma').value = 1e3 * noise.gain / noise.threshold;
    byId('reach').value = 1e3 * noise.threshold;
    for (const id of ['sigma', 'reach']) showValue(byId(id));
    if (!fresh) return;
    this.history.begin(ownTissue ? null : scene.tissue);
    const option = (name, value) => {
      const one = new Option(name, value);
      one.dataset.name = name;
      return one;
    };
    byId('preset').replaceChildren(...(ownTissue ? [option(`${scene.tissue} (of the scene)`, '')] : []),
      ...this.page.tissueNames().map(name => option(name, name)));
    byId('hands').hidden = hands < 2;
    byId('jaws').hidden = !this.jawed || (this.task !== 'pull' && hands < 2);
    byId('hands').replaceChildren(...Array.from({length: hands}, (_, which) => {
      const button = document.createElement('button');
      [button.type, button.textContent, button.title] = ['button', `Hand ${which + 1}`, `${which + 1}`];
      button.onclick = () => this.page.hand(which);
      return button;
    }));
    this.hand(0);
  }
  hand(which) {
    [...byId('hands').children].forEach((button, i) => button.setAttribute('aria-pressed', i === which));
  }
  begun(task) {
    Object.assign(byId('depth'), {disabled: false, max: task === 'insert' ? 60 : 25, value: -5});
    this.lever = -5e-3;
    byId('set').textContent = '-5.0';
    document.body.dataset.ready = task;
  }

  tissue({curve, values}) {
    byId('curves').hidden = !curve;
    for (const [field, value] of values) {
      byId(field).max = Math.max(byId(field).dataset.high, value);  // a needle's tissues are stiffer, with more friction
      byId(field).value = value;
      showValue(byId(field));
    }
    this.#tissueState();
  }

  frame({mode, result, felt, fault, lever, parked}, task) {
    const mm = metres => `${(1e3 * metres).toFixed(1)} mm`;
    const {phase, depth, distance, deviceForce, engagement} = result;
    const words = phase === 1 ? `Pressing, ${mm(depth)} deep` : phase === 2 ? `Pulling, stretched ${mm(depth)}`
      : phase === 3 ? (depth > 0 ? `Needle ${mm(depth)} inside` : `Needle ${mm(-depth)} out, with tissue on it`)
      : distance < 0 ? 'Inside the organ: move out first' : `${mm(distance)} from the tissue`;
    const ramp = mode === 'haply' && engagement < 1 ? `. Force at ${Math.round(100 * engagement)} %: keep still outside the tissue` : '';
    byId('state').textContent = words + ramp + (parked ? '. Parked: F brings the tool back' : '');
    byId('force_now').textContent = `${Math.hypot(...deviceForce).toFixed(2)} N`;
    byId('depth_now').textContent = phase === 0 ? '' : mm(depth);
    if (task === 'palpate') byId('ratio').textContent = phase === 0 ? 'not in contact' : felt === null ? 'press deeper than 1 mm' : `${felt.toFixed(2)} times the uniform`;
    byId('fault').hidden = !fault;
    if (fault) byId('fault').firstElementChild.textContent = `Zero force: ${fault}.`;
    if (mode !== 'pointer') return;
    byId('set').textContent = (1e3 * lever).toFixed(1);  // a needle may move less far than the lever
    if (this.leverHeld) return;
    byId('depth').value = 1e3 * lever;
    this.lever = lever;
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
    const lumps = found === 1 && missed === 0 ? 'lump' : 'lumps', marks = wrong === 1 ? 'mark' : 'marks';
    byId('answer').textContent = `${found} of ${found + missed} ${lumps} found${wrong ? `, ${wrong} false ${marks}` : ''}. Rings: the lumps. Dots and crosses: right and false marks.`;
    byId('answer').hidden = false;
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
    if (of !== 'haply') return this.note(words);
    byId('haply').textContent = words;
    byId('haply').classList.add('bad');
  }
}
