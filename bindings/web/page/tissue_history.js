// Changes of the tissue, for undo and redo.

const ONE_CHANGE = 1000;  // ms: motions of one slider within it are one change
const MOST = 100;

/** States of the tissue: {name: of a built-in tissue, or null for the scene's own; values: {FIELD: number that differs}}. */
export class TissueHistory {
  constructor() { this.begin(null); }
  begin(name) { [this.now, this.before, this.after, this.last] = [{name, values: {}}, [], [], {}]; }

  get canUndo() { return this.before.length > 0; }
  get canRedo() { return this.after.length > 0; }

  /** @param field of a slider, whose motions in quick succession are one change */
  change(state, field = '', time = performance.now()) {
    const same = field !== '' && field === this.last.field && time - this.last.time < ONE_CHANGE;
    if (!same) this.before.push(this.now);
    if (this.before.length > MOST) this.before.shift();
    this.last = {field, time};
    [this.now, this.after] = [state, []];
  }
  /** @return the state before the last change, or null */
  undo() { return this.#go(this.before, this.after); }
  /** @return the state that was undone last, or null */
  redo() { return this.#go(this.after, this.before); }

  #go(from, to) {
    if (!from.length) return null;
    to.push(this.now);
    this.last = {};
    this.now = from.pop();
    return this.now;
  }
}
