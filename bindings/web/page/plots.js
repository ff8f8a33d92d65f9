// Plots over time, and of force over depth, on a canvas.

const SECONDS = 8;
const CAPACITY = 16384;  // ticks
const TICK_SPACING_X = 80, TICK_SPACING_Y = 20;  // CSS pixels, smallest
const LEFT = 40, RIGHT = 10, TOP = 6, BOTTOM = 20;

/** The smallest of 1, 2, 2.5 and 5 times a power of ten that is not below the value. */
export function roundStep(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return power * ([1, 2, 2.5, 5].find(factor => value <= factor * power * (1 + 1e-9)) ?? 10);
}

/** The upper end of an axis: the smallest of 1, 1.5, 2, 2.5, 3, 4, 5, 6 and 8 times a power of ten. */
export function roundEnd(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return power * ([1, 1.5, 2, 2.5, 3, 4, 5, 6, 8].find(factor => value <= factor * power * (1 + 1e-9)) ?? 10);
}

/** The ticks of the last seconds. */
export class History {
  constructor() {
    this.columns = {};
    for (const name of ['time', 'phase', 'depth', 'force', 'tissue', 'noise']) this.columns[name] = new Float64Array(CAPACITY);
    this.clear();
  }
  clear() { [this.count, this.now] = [0, 0]; }

  /** Adds rows of six numbers: time [s], phase, depth [m], force at the hand, tissue force, noise [N]. */
  add(rows) {
    const columns = Object.values(this.columns);
    for (let i = 0; i < rows.length; i += columns.length) {
      const at = this.count++ % CAPACITY;
      columns.forEach((column, k) => { column[at] = rows[i + k]; });
      this.now = rows[i];
    }
  }

  /** The index of the first tick not before a time, and the number of ticks from it. */
  from(time) {
    let low = Math.max(0, this.count - CAPACITY), high = this.count;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.columns.time[middle % CAPACITY] < time) low = middle + 1; else high = middle;
    }
    return low;
  }

  /** Calls visit(slot) for every tick from an index on. */
  each(from, visit) { for (let i = from; i < this.count; i++) visit(i % CAPACITY); }
}

/** Axes of a plot on a canvas: a frame, ticks and labels; then x() and y() give pixels. */
class Axes {
  /** @param unitX of the labels below; '': no labels */
  constructor(canvas, [xLow, xHigh], [yLow, yHigh], colours, unitX) {
    const ratio = devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
    const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
    if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
    const c = this.c = canvas.getContext('2d', {willReadFrequently: true});  // drawn by the processor: faster with OpenGL in software
    c.setTransform(ratio, 0, 0, ratio, 0, 0);
    c.clearRect(0, 0, width, height);
    [this.left, this.right, this.top, this.bottom] = [LEFT, width - RIGHT, TOP, height - (unitX ? BOTTOM : 4)];
    this.x = value => this.left + (value - xLow) / (xHigh - xLow) * (this.right - this.left);
    this.y = value => this.bottom - (value - yLow) / (yHigh - yLow) * (this.bottom - this.top);
    this.#grid(xLow, xHigh, yLow, yHigh, colours, unitX);
  }

  #grid(xLow, xHigh, yLow, yHigh, colours, unitX) {
    const c = this.c, half = v => Math.round(v) + 0.5;
    c.lineWidth = 1;
    c.strokeStyle = colours.grid;
    c.fillStyle = colours.faint;
    c.font = '11px system-ui, sans-serif';
    c.beginPath();
    const stepX = roundStep((xHigh - xLow) * Math.min(1, TICK_SPACING_X / Math.max(1, this.right - this.left)));
    [c.textAlign, c.textBaseline] = ['center', 'top'];
    for (let i = Math.ceil(xLow / stepX - 1e-9); i * stepX <= xHigh + 1e-9; i++) {
      const x = half(this.x(i * stepX));
      c.moveTo(x, this.top); c.lineTo(x, this.bottom);
      if (unitX) c.fillText(`${decimal(i * stepX, stepX)} ${unitX}`, Math.min(x, this.right - 8), this.bottom + 5);
    }
    const stepY = roundStep((yHigh - yLow) * Math.min(1, TICK_SPACING_Y / Math.max(1, this.bottom - this.top)));
    [c.textAlign, c.textBaseline] = ['right', 'middle'];
    for (let i = Math.ceil(yLow / stepY - 1e-9); i * stepY <= yHigh + 1e-9 * stepY; i++) {
      const y = half(this.y(i * stepY));
      c.moveTo(this.left, y); c.lineTo(this.right, y);
      c.fillText(decimal(i * stepY, stepY), this.left - 6, y);
    }
    c.stroke();
  }

  clip(draw) {
    this.c.save();
    this.c.beginPath();
    this.c.rect(this.left, this.top - 2, this.right - this.left, this.bottom - this.top + 3);
    this.c.clip();
    draw(this.c);
    this.c.restore();
  }
}

function decimal(value, step) {
  let digits = 0;
  for (let whole = step; digits < 6 && Math.abs(whole - Math.round(whole)) > 1e-6 * whole; whole *= 10) digits++;
  return (value === 0 ? 0 : value).toFixed(digits);
}

/** Draws a quantity of the history over the last seconds, as the range of its values per pixel. */
export function drawStrip(canvas, history, {column, factor, least, colour, unitX = ''}, colours) {
  const end = Math.max(SECONDS, history.now), begin = end - SECONDS;
  const values = history.columns[column], time = history.columns.time, from = history.from(begin);
  let most = least;
  history.each(from, i => { most = Math.max(most, factor * values[i]); });
  const axes = new Axes(canvas, [begin, end], [0, roundEnd(1.02 * most)], colours, unitX);
  axes.clip(c => {
    c.strokeStyle = colour;
    c.lineWidth = 1.6;
    c.lineJoin = 'round';
    c.beginPath();
    let pixel = -1, low = 0, high = 0;
    const column = () => {
      if (pixel < 0) return;
      c.lineTo(pixel, axes.y(low));
      if (high !== low) c.lineTo(pixel, axes.y(high));
    };
    history.each(from, i => {
      const x = Math.round(2 * axes.x(time[i])) / 2, value = factor * values[i];
      if (x !== pixel) {
        column();
        [pixel, low, high] = [x, value, value];
      }
      [low, high] = [Math.min(low, value), Math.max(high, value)];
    });
    column();
    c.stroke();
  });
}

/** Draws the tissue force over the depth of the last seconds, with the force law (points [mm, N], or null). */
export function drawForceOverDepth(canvas, history, law, colours) {
  const {time, phase, depth, tissue} = history.columns, begin = Math.max(SECONDS, history.now) - SECONDS;
  const from = history.from(begin);
  let deepest = 12, strongest = 0.5, next = 0;
  const points = [];
  history.each(from, i => {
    if (phase[i] === 0) { points.push(null); return; }
    deepest = Math.max(deepest, 1e3 * depth[i]);
    strongest = Math.max(strongest, tissue[i]);
    if (time[i] < next) return;
    next = time[i] + 5e-3;
    points.push([1e3 * depth[i], tissue[i]]);
  });
  deepest = 5 * Math.ceil(1.02 * deepest / 5);
  const curve = law ? law.filter(([mm]) => mm <= deepest) : [];
  const axes = new Axes(canvas, [0, deepest], [0, roundEnd(Math.max(1.02 * strongest, ...curve.map(([, force]) => force)))], colours, 'mm');
  axes.clip(c => {
    const line = (path, colour, width) => {
      [c.strokeStyle, c.lineWidth, c.lineJoin] = [colour, width, 'round'];
      c.beginPath();
      let joined = false;
      for (const point of path) {
        if (point) c[joined ? 'lineTo' : 'moveTo'](axes.x(point[0]), axes.y(point[1]));
        joined = point !== null;
      }
      c.stroke();
    };
    line(curve, colours.law, 4);
    line(points, colours.force, 1.4);
    const newest = points.at(-1);
    if (!newest) return;
    c.fillStyle = colours.text;
    c.beginPath();
    c.arc(axes.x(newest[0]), axes.y(newest[1]), 4, 0, 7);
    c.fill();
  });
}
