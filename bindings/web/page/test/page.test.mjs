// The page in headless Chromium (software OpenGL) on a server on localhost.
// PALPATE_PAGE names the folder with the page and the package, PALPATE_PROGRAM the native program; NODE_PATH must lead to playwright-core.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {mkdtempSync, rmSync} from 'node:fs';
import {createServer} from 'node:http';
import {readFile} from 'node:fs/promises';
import {createRequire} from 'node:module';
import {tmpdir} from 'node:os';
import {extname, join} from 'node:path';
import {after, before, test} from 'node:test';
import {FakeHaply} from './fake_haply.mjs';
import {pixelsOf} from './picture.mjs';

const {chromium} = createRequire(import.meta.url)('playwright-core');
const FLAGS = ['--headless', '--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-quic',
  '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync'];
const TYPES = {'.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.png': 'image/png', '.wasm': 'application/wasm'};
const LONG = 90000;  // ms: software OpenGL on a busy machine
let server, browser, url;
const outside = [], errors = [];

before(async () => {
  server = createServer(async (request, answer) => {
    const path = new URL(request.url, 'http://localhost').pathname.replace(/\/$/, '/index.html');
    try {
      const body = await readFile(join(process.env.PALPATE_PAGE, path));
      answer.writeHead(200, {'content-type': TYPES[extname(path)] ?? 'application/octet-stream'}).end(body);
    } catch {
      answer.writeHead(404).end();
    }
  });
  await new Promise(ready => server.listen(0, '127.0.0.1', ready));
  url = `http://127.0.0.1:${server.address().port}/`;
  browser = await chromium.launch({executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium', args: FLAGS});
});

after(async () => {
  await browser?.close();
  server?.closeAllConnections();
  server?.close();
});

/** Notes what worker and page say to each other: rows of ticks, results, and lines of sight of the pointer. */
function note() {
  window.noted = {rows: [], results: [], rays: [], words: []};
  const {Worker} = window;
  window.Worker = class extends Worker {
    constructor(...all) {
      super(...all);
      this.addEventListener('message', ({data}) => {
        if (data.is !== 'frame' || !data.result) return;
        for (let i = 0; i < data.rows.length; i += 6) window.noted.rows.push(Array.from(data.rows.slice(i, i + 3)));
        window.noted.results.push({contact: data.result.contact, phase: data.result.phase, tool: data.result.toolPosition, rays: window.noted.rays.length});
      });
    }
    postMessage(message) {
      if (message.do === 'point' && message.ray) window.noted.rays.push(message.ray);
      super.postMessage(message);
    }
  };
}

/** Notes the words over the picture, with their colours. */
function noteWords() {
  const {fillText, clearRect} = CanvasRenderingContext2D.prototype;
  Object.assign(CanvasRenderingContext2D.prototype, {
    clearRect(...all) {
      if (this.canvas.id === 'overlay') window.noted.words = [];
      clearRect.apply(this, all);
    },
    fillText(words, ...all) {
      if (this.canvas.id === 'overlay') window.noted.words.push([words, this.fillStyle]);
      fillText.call(this, words, ...all);
    },
  });
}

/** Opens the page, until the end of the test. @param pictures at most so many a second */
async function opened(context, {width = 840, height = 540, touch = false, pictures = 60, search = '', ready = 'press'} = {}) {
  const page = await browser.newPage({viewport: {width, height}, hasTouch: touch, colorScheme: 'dark', acceptDownloads: true});
  context.after(() => page.close());
  page.setDefaultTimeout(LONG);
  await page.addInitScript(note);
  await page.addInitScript(noteWords);
  if (pictures < 60) {
    await page.addInitScript(rate => { window.requestAnimationFrame = act => setTimeout(() => act(performance.now()), 1000 / rate); }, pictures);
  }
  page.on('request', request => {
    if (!['127.0.0.1', 'localhost'].includes(new URL(request.url()).hostname) && !/^(data|blob):/.test(request.url())) outside.push(request.url());
  });
  page.on('console', message => { if (message.type() === 'error') errors.push(message.text()); });
  page.on('pageerror', error => errors.push(error.message));
  await page.goto(url + search);
  if (!ready) return page;
  await page.locator('#message').waitFor({state: 'hidden'});
  await page.locator(`body[data-ready=${ready}]`).waitFor();
  return page;
}

const text = (page, selector) => page.locator(selector).textContent();
const until = (page, test, ...all) => page.waitForFunction(test, ...all);
const pressing = page => until(page, () => /^Pressing, [3-9]\.|^Pressing, \d\d/.test(document.getElementById('state').textContent) &&
  parseFloat(document.getElementById('force_now').textContent) > 0.05);

/** Chooses an exercise, and waits until its demonstration runs. */
async function choose(page, task) {
  await page.locator(`label:has([value=${task}])`).click();
  await page.locator(`body[data-ready=${task}]`).waitFor();
  await page.locator('#message').waitFor({state: 'hidden'});
}

/** Takes the tool, points at a place of the organ (shares of the picture), and lowers the tool by the lever [mm]. */
async function press(page, depth = 5, x = 0.45, y = 0.55) {
  const box = await page.locator('#picture').boundingBox();
  await page.mouse.click(box.x + x * box.width, box.y + y * box.height);
  await until(page, () => /^Move/.test(document.getElementById('hint').textContent));
  await page.locator('#depth:enabled').waitFor();
  await page.locator('#depth').fill(String(depth));
  await pressing(page);
}

/** Moves the mouse slowly over the picture, between places given as its shares. @param steps of some 50 ms */
async function sweep(page, from, to, steps = 40) {
  const {x, y, width, height} = await page.locator('#picture').boundingBox();
  for (let i = 0; i <= steps; i++) {
    const [right, down] = [0, 1].map(k => from[k] + (to[k] - from[k]) * i / steps);
    await page.mouse.move(x + right * width, y + down * height);
    await page.waitForTimeout(50);
  }
  await page.waitForTimeout(1200);
}

/** Turns the wheel by notches of 1 mm; positive presses. */
async function wheel(page, notches) {
  for (let i = 0; i < Math.abs(notches); i++) await page.mouse.wheel(0, -100 * Math.sign(notches));
}

/** Number of pixels of a plot that show the colour of its curve. */
const curvePixels = (page, id, name) => page.evaluate(([id, name]) => {
  const canvas = document.getElementById(id), c = canvas.getContext('2d');
  const hex = getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const colour = [1, 3, 5].map(at => parseInt(hex.slice(at, at + 2), 16));
  const {data} = c.getImageData(0, 0, canvas.width, canvas.height);
  let count = 0;
  for (let i = 0; i < data.length; i += 4) if (colour.every((value, k) => Math.abs(data[i + k] - value) < 12)) count++;
  return count;
}, [id, name]);

test('the page shows a picture and the demonstration presses by itself', async context => {
  const page = await opened(context);
  await pressing(page);
  assert.match(await text(page, '#hint'), /^Demonstration/);
  const shot = await page.locator('#picture').screenshot();
  assert.ok(shot.length > 20000, `a picture of ${shot.length} bytes is empty`);
});

test('a click and the wheel press at once after the page has opened', async context => {
  const page = await opened(context), {x, y, width, height} = await page.locator('#picture').boundingBox();
  await page.mouse.click(x + 0.45 * width, y + 0.55 * height);
  await wheel(page, 10);
  await pressing(page);
  const times = await page.evaluate(() => [performance.getEntriesByName('first picture')[0].startTime, performance.now()]);
  context.diagnostic(`first picture and first felt contact ${times.map(time => (time / 1000).toFixed(1)).join(' and ')} s after the opening`);
});

test('the first picture shows the tool above the organ', async context => {
  const page = await browser.newPage({viewport: {width: 840, height: 540}});
  context.after(() => page.close());
  page.setDefaultTimeout(LONG);
  await page.addInitScript(() => { window.Worker = class { postMessage() {} }; });  // so no later picture comes
  await page.goto(url);
  await page.locator('#picture canvas').waitFor();
  await page.locator('#message').waitFor({state: 'hidden'});
  // Range of brightness, 0..255, of a row, given as a share of the height, in the middle half of the picture.
  const range = await (await pixelsOf(page)).evaluate(({data, width, height}) => [0.02, 0.98].map(share => {
    const middle = 4 * (width * Math.floor(share * height) + Math.floor(width / 4));
    const green = data.subarray(middle, middle + 2 * width).filter((_, i) => i % 4 === 1);
    return Math.max(...green) - Math.min(...green);
  }));
  assert.ok(range[0] > 40 && range[1] < 25, `${range}: not the shaft above and the background below`);
});

test('the tool rides under the pointer at its set depth, and touches nothing before a press', async context => {
  const page = await opened(context);
  const {x, y, width, height} = await page.locator('#picture').boundingBox();
  await page.mouse.click(x + 0.4 * width, y + 0.55 * height);
  await until(page, () => /^Move: mouse/.test(document.getElementById('hint').textContent));
  await page.evaluate(() => window.noted.rows.splice(0));
  await sweep(page, [0.4, 0.55], [0.6, 0.6]);
  await sweep(page, [0.6, 0.6], [0.95, 0.2], 15);  // beside the organ
  await sweep(page, [0.95, 0.2], [0.35, 0.55], 15);
  const before = await page.evaluate(() => window.noted.rows.splice(0));
  assert.ok(before.length > 2000 && before.every(([, phase]) => phase === 0), 'touched before a press');
  await wheel(page, 10);  // from 5 mm above to 5 mm deep
  await until(page, () => /^Pressing, 5\.0 mm/.test(document.getElementById('state').textContent));
  await page.waitForTimeout(500);
  await page.evaluate(() => { for (const all of Object.values(window.noted)) all.splice(0); });
  await sweep(page, [0.35, 0.55], [0.6, 0.6]);
  const {rows, results, rays} = await page.evaluate(() => window.noted);
  const depths = rows.map(([, , depth]) => 1e3 * depth);
  context.diagnostic(`${rows.length} ticks at ${Math.min(...depths).toFixed(2)} to ${Math.max(...depths).toFixed(2)} mm, ${rays.length} places`);
  assert.ok(rows.length > 2000 && rows.every(([, phase]) => phase === 1));
  assert.ok(depths.every(depth => Math.abs(depth - 5) < 0.3), `${Math.min(...depths)} to ${Math.max(...depths)} mm`);
  // The contact is on the way of the pointer over the picture, and at last under it.
  const off = ({origin, direction}, point) => {
    const way = point.map((v, i) => v - origin[i]), along = way.reduce((sum, v, i) => sum + v * direction[i], 0);
    return 1e3 * Math.hypot(...way.map((v, i) => v - along * direction[i]));
  };
  for (const {contact, rays: sent} of results.filter(one => one.rays > 0)) {
    assert.ok(Math.min(...rays.slice(0, sent).map(ray => off(ray, contact))) < 6, 'away from all places of the pointer');
  }
  assert.ok(off(rays.at(-1), results.at(-1).contact) < 3, `${off(rays.at(-1), results.at(-1).contact)} mm from the pointer`);
});

test('the tool stays when the pointer leaves the picture, turns the view, and is parked by F', async context => {
  const page = await opened(context);
  await press(page);
  const {x, y, width, height} = await page.locator('#picture').boundingBox();
  const contact = () => page.evaluate(() => window.noted.results.at(-1).contact);
  const first = await contact();
  const moved = async () => 1e3 * Math.hypot(...(await contact()).map((v, i) => v - first[i]));
  // On to a place some 30 mm away, and off the picture at once: the tool does not go there.
  await page.evaluate(() => {
    const picture = document.getElementById('picture'), {x, y, width, height} = picture.getBoundingClientRect();
    const at = {clientX: x + 0.25 * width, clientY: y + 0.6 * height, pointerId: 1, pointerType: 'mouse'};
    for (const type of ['pointermove', 'pointerleave']) picture.dispatchEvent(new PointerEvent(type, at));
  });
  await page.waitForTimeout(1000);
  assert.ok(await moved() < 5, `${await moved()} mm beside the picture`);
  await page.mouse.move(x + 0.45 * width, y + 0.55 * height);
  await page.waitForTimeout(600);
  await page.mouse.down({button: 'right'});
  await page.mouse.move(x + 0.6 * width, y + 0.5 * height, {steps: 5});
  await page.waitForTimeout(600);
  assert.ok(await moved() < 0.5, `${await moved()} mm while the view turns`);
  await page.mouse.up({button: 'right'});
  await page.mouse.move(x + width + 100, y + 200);
  await page.keyboard.press('f');
  await until(page, () => /^2\d\.\d mm from the tissue\. Parked|^3\d\.\d mm from the tissue\. Parked/.test(document.getElementById('state').textContent));
  await page.locator('#restart').click();  // with the pointer on the panel
  await until(page, () => /^Move/.test(document.getElementById('hint').textContent));
  await page.locator('#depth').fill('5');
  await pressing(page);
});

test('a hint says what to do until the first contact', async context => {
  const page = await opened(context);
  assert.match(await text(page, '#hint'), /^Demonstration\. Click/);
  await press(page);
  assert.equal(await page.locator('#hint').isVisible(), false);
  assert.ok(await page.locator('#overlay').evaluate(canvas => canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data.some(v => v > 0)), 'no marks');
  await page.keyboard.press('a');
  await page.keyboard.press('b');
  await page.keyboard.press('x');
  await until(page, () => {
    const canvas = document.getElementById('overlay');
    return !canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data.some(v => v > 0);
  });
});

test('the wheel presses deeper, and the plot shows the force', async context => {
  const page = await opened(context);
  await press(page);
  await page.waitForTimeout(500);
  const before = await curvePixels(page, 'force_plot', '--force');
  assert.ok(before > 10, `${before} pixels of the force`);
  const depth = parseFloat(await text(page, '#depth_now'));
  await wheel(page, 3);  // away from the user: 3 mm deeper
  await until(page, least => parseFloat(document.getElementById('depth_now').textContent) > least, depth + 2);
  await wheel(page, -40);
  await until(page, () => /from the tissue/.test(document.getElementById('state').textContent));
});

test('the held left button grips the heart, and a drag pulls it', async context => {
  const page = await opened(context);
  await choose(page, 'pull');
  await press(page);
  const {x, y, width, height} = await page.locator('#picture').boundingBox();
  await page.mouse.move(x + 0.45 * width, y + 0.55 * height);
  await page.mouse.down();
  await page.waitForTimeout(800);
  await page.mouse.move(x + 0.45 * width, y + 0.3 * height, {steps: 8});
  await until(page, () => /^Pulling, stretched ([3-9]|\d\d)\./.test(document.getElementById('state').textContent));
  assert.ok(parseFloat(await text(page, '#force_now')) > 0.05);
  await page.mouse.up();
  await until(page, () => !/^Pulling/.test(document.getElementById('state').textContent));
});

test('closed jaws pull the heart by the wheel', async context => {
  const page = await opened(context);
  await choose(page, 'pull');
  await press(page);
  await page.locator('#jaws').click();
  assert.equal(await page.locator('#jaws').getAttribute('aria-pressed'), 'true');
  await page.waitForTimeout(600);
  await page.locator('#picture').hover({position: {x: 200, y: 150}});
  await wheel(page, -16);
  await until(page, () => /^Pulling, stretched ([3-9]|\d\d)\./.test(document.getElementById('state').textContent));
  assert.ok(parseFloat(await text(page, '#force_now')) > 0.05);
});

test('a mark needs contact, and the end of a search shows its answer on the picture', async context => {
  const page = await opened(context);
  await choose(page, 'palpate');
  const {x, y, width, height} = await page.locator('#picture').boundingBox();
  await page.mouse.click(x + 0.25 * width, y + 0.35 * height);
  await until(page, () => /^Move/.test(document.getElementById('hint').textContent));
  await page.keyboard.press('m');
  await until(page, () => /^Nothing is marked/.test(document.getElementById('hint').textContent));
  assert.equal(await text(page, '#marks'), '0');
  await page.locator('#depth').fill('5');
  await until(page, () => /times the uniform/.test(document.getElementById('ratio').textContent));
  const button = () => page.locator('#finish').evaluate(one => one.getBoundingClientRect().y);
  const before = await button();
  await page.mouse.click(x + 0.25 * width, y + 0.35 * height);
  await page.keyboard.press('m');
  await page.locator('#mark').click();
  assert.equal(await text(page, '#marks'), '3');
  await page.locator('#finish').click();
  assert.match(await text(page, '#answer'), /^\d of 3 lumps found(, \d false marks?)?\. Rings: the lumps\./);
  assert.equal(await button(), before, 'the button has moved');
  const rows = await page.locator('#score').evaluate(list => [...list.children].map(one => one.textContent));
  const [found, lumps] = rows[rows.indexOf('Found') + 1].split(' of ').map(Number);
  assert.equal(lumps, 3);
  assert.equal(Number(rows[rows.indexOf('Missed') + 1]), 3 - found);
  assert.equal(await page.locator('#mark').isDisabled(), true);
  await page.locator('#finish').click();
  await page.locator('body[data-ready=palpate]').waitFor();
  assert.equal(await text(page, '#marks'), '0');
  await page.locator('#link').click();
  await until(page, () => /scene=find-the-lump&seed=8$/.test(document.getElementById('file_note').textContent));
});

test('the gallery opens a scene of two hands, whose link opens it again', async context => {
  const page = await opened(context);
  await page.locator('#more').click();
  assert.deepEqual(await page.locator('#cards b').allTextContents(), ['Press', 'Pull', 'Lump search', 'Beating heart', 'Two hands', 'Gallstone', 'Plaque', 'Needle']);
  await page.locator('[data-scene=bimanual]').click();
  await until(page, () => /^Two instruments/.test(document.getElementById('name').textContent));
  await page.locator('body[data-ready=press]').waitFor();
  await pressing(page);
  assert.equal(await page.locator('#hands button').count(), 2);
  await page.locator('#link').click();
  await until(page, () => document.getElementById('file_note').textContent !== '');
  assert.match(await text(page, '#file_note'), /\?scene=bimanual$/);
  const again = await opened(context, {search: '?scene=bimanual&tissue=liver'});
  assert.equal(await again.locator('#preset').inputValue(), 'liver');
  assert.equal(await again.locator('#hands button').count(), 2);
});

test('the button of the jaws says what the jaws of the chosen hand do', async context => {
  const page = await opened(context, {search: '?scene=bimanual'});
  const jaws = page.locator('#jaws'), hand = which => page.locator('#hands button').nth(which);
  const closed = is => page.locator(`#jaws[aria-pressed=${is}]`).waitFor();
  await jaws.click();
  await closed(true);
  assert.equal(await jaws.textContent(), 'Open the jaws');
  await hand(1).click();
  await closed(false);
  assert.equal(await jaws.textContent(), 'Close the jaws');
  await hand(0).click();
  await closed(true);
  await jaws.click();
  await closed(false);
});

test('on a phone the buttons of two hands lie beside each other', async context => {
  const page = await opened(context, {width: 390, height: 844, touch: true, search: '?scene=bimanual'});
  const boxes = await page.locator('#actions button:visible').evaluateAll(all => all.map(one => {
    const {left, right, top} = one.getBoundingClientRect();
    return {left, right, top, cut: one.scrollWidth > one.clientWidth};
  }));
  assert.equal(boxes.length, 5);
  for (const {left, right, cut} of boxes) assert.ok(left >= 0 && right <= 390 && !cut, JSON.stringify(boxes));
});

test('the switch spreads a drape under the organ', async context => {
  const page = await opened(context);
  // Red over blue in the lower left corner.
  const tint = async () => (await pixelsOf(page)).evaluate(({data, width, height}) => {
    let [red, blue] = [0, 0];
    for (let y = Math.floor(0.8 * height); y < 0.9 * height; y++) {
      for (let x = 0; x < 0.1 * width; x++) [red, blue] = [red + data[4 * (y * width + x)], blue + data[4 * (y * width + x) + 2]];
    }
    return red / blue;
  });
  const before = await tint();
  await page.locator('#drape').check();
  await page.waitForTimeout(2000);
  const after = await tint();
  assert.ok(after < 0.9 * before, `${before} to ${after}: it is bluer than the wall`);
});

test('a needle stays on its axis while the pointer moves sideways, the section names the layer at its tip, and its hole stays', async context => {
  const page = await opened(context, {width: 1100, height: 640, search: '?scene=insert', ready: 'insert'});
  const {x, y, width, height} = await page.locator('#picture').boundingBox(), [right, down] = [0.45, 0.4];
  await page.mouse.click(x + right * width, y + down * height);
  await until(page, () => /^Move: mouse/.test(document.getElementById('hint').textContent));
  await page.waitForTimeout(2500);
  const inside = () => page.evaluate(() => parseFloat(/^Needle ([\d.]+) mm inside/.exec(document.getElementById('state').textContent)?.[1] ?? 0));
  const turned = async (notches, reached) => {
    for (let i = 0; i < 80 && !await reached(); i++) {
      await wheel(page, notches);
      await page.waitForTimeout(200);
    }
    await page.waitForTimeout(1500);
    assert.ok(await reached(), await text(page, '#state'));
  };
  await turned(3, async () => await inside() >= 20);
  const newest = () => page.evaluate(() => window.noted.results.at(-1));
  const before = await newest();
  assert.equal(before.phase, 3);
  const layers = (await page.evaluate(() => window.noted.words)).filter(([words]) => ['skin', 'fat', 'muscle'].includes(words));
  const force = '#f5a852';
  assert.deepEqual(layers.map(([words, colour]) => [words, colour === force]), [['skin', false], ['fat', false], ['muscle', true]]);
  await sweep(page, [right, down], [0.7, 0.45], 15);
  const moved = 1e3 * Math.hypot(...(await newest()).tool.map((v, i) => v - before.tool[i]));
  assert.ok(moved < 0.2, `the handle moved ${moved} mm`);
  await turned(-4, () => page.evaluate(() => /from the tissue/.test(document.getElementById('state').textContent)));
  // The needle is now under the pointer, away from its hole. Dark pixels there, and beside it.
  const dark = await (await pixelsOf(page)).evaluate(({data, width, height}, [right, down]) => [0, 0.1].map(aside => {
    let count = 0;
    for (let row = -25; row <= 25; row++) {
      for (let column = -25; column <= 25; column++) {
        const at = 4 * (Math.round(down * height + row) * width + Math.round((right + aside) * width + column));
        if (data[at] < 80) count++;
      }
    }
    return count;
  }), [right, down]);
  context.diagnostic(`moved ${moved.toFixed(3)} mm, ${dark} dark pixels at the hole and beside it`);
  assert.ok(dark[0] > 3 && dark[1] === 0, `${dark} dark pixels at the hole and beside it`);
});

test('a scene that moves reads its table from the page\u2019s folder', async context => {
  const page = await opened(context, {search: '?scene=beating-heart'});
  await until(page, () => window.noted.rows.some(([time]) => time > 1));
});

test('a wrong address is answered in words', async context => {
  for (const [search, words] of [['?scene=kidnee', /^scene = kidnee: must be press, pull/], ['?scene=none.toml', /none\.toml: cannot be read: HTTP status 404/],
    ['?scene=press&organ=kidnee', /did you mean kidney/], ['?sceen=press', /^sceen: unknown/]]) {
    const page = await opened(context, {search, ready: ''});
    await until(page, text => new RegExp(text).test(document.getElementById('message').textContent), words.source);
    await page.close();
  }
  errors.splice(0, errors.length, ...errors.filter(error => !/404/.test(error)));
});

test('a dropped scene with its mesh opens, and HDF5 is answered with the command that exports it', async context => {
  const page = await opened(context);
  const mesh = 'v 30 30 30\nv 30 -30 -30\nv -30 30 -30\nv -30 -30 30\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n';
  const toml = '[scene]\nname = "a tetrahedron"\n[organ]\nmesh = "shape.obj"\nunit = "mm"\ntissue = "liver"\n[tool]\nmesh = "sphere:5"\n';
  const file = (name, content) => ({name, mimeType: 'text/plain', buffer: Buffer.from(content)});
  await page.locator('#file').setInputFiles([file('mine.toml', toml), file('shape.obj', mesh)]);
  await until(page, () => document.getElementById('name').textContent === 'a tetrahedron');
  await page.locator('#link').click();
  assert.match(await text(page, '#file_note'), /has no address/);
  await page.locator('#file').setInputFiles([file('run.h5', 'x')]);
  await until(page, () => /palpate export RECORDING\.h5 --csv/.test(document.getElementById('file_note').textContent));
});

test('a recording saves a CSV with every tick', async context => {
  const page = await opened(context);
  await page.locator('#record').click();
  await until(page, () => document.getElementById('record').textContent === 'Stop and save CSV');
  await page.waitForTimeout(800);
  const download = page.waitForEvent('download');
  await page.locator('#record').click();
  const csv = await readFile(await (await download).path(), 'utf8');
  const lines = csv.trim().split('\n').filter(line => !line.startsWith('#'));
  assert.match(lines[0], /^tick,/);
  const ticks = lines.slice(1).map(line => Number(line.split(',')[0]));
  assert.ok(ticks.length > 100, `${ticks.length} ticks`);
  ticks.forEach((tick, i) => assert.equal(tick, i));
  await until(page, () => document.getElementById('record').textContent === 'Record');
});

test('the CSV of palpate export plays with the recorded depths, and another scene is noticed', async context => {
  const folder = mkdtempSync(join(tmpdir(), 'palpate-'));
  context.after(() => rmSync(folder, {recursive: true}));
  const [h5, csv] = ['run.h5', 'run.csv'].map(name => join(folder, name));
  execFileSync(process.env.PALPATE_PROGRAM, ['run', '--offline', '--duration-s', '3', '--record', h5], {stdio: 'pipe'});
  execFileSync(process.env.PALPATE_PROGRAM, ['export', h5, '--csv', csv], {stdio: 'pipe'});
  const page = await opened(context);
  await page.locator('#file').setInputFiles(csv);
  await until(page, () => /^Recording/.test(document.getElementById('hint').textContent));
  await page.evaluate(() => window.noted.rows.splice(0));
  await until(page, () => window.noted.rows.some(([time]) => time > 2.5));
  const lines = (await readFile(csv, 'utf8')).split('\n').map(line => line.split(','));
  const [time, depth] = ['time_s', 'depth_m'].map(name => lines[0].indexOf(name));
  const recorded = new Map(lines.slice(1).map(line => [line[time], Number(line[depth])]));
  const rows = await page.evaluate(() => window.noted.rows);
  for (const [at, , here] of rows.filter(([at]) => at < 2.99)) assert.equal(here, recorded.get(String(at)), `${at} s`);
  assert.ok(Math.max(...rows.map(([, , here]) => here)) > 5e-3);
  await choose(page, 'pull');
  await page.locator('#file').setInputFiles(csv);
  await until(page, () => /^The recording is of another scene/.test(document.getElementById('file_note').textContent));
});

test('changes of the tissue are undone, done again and reset', async context => {
  const page = await opened(context);
  const slide = value => page.evaluate(number => {
    const input = document.getElementById('k1_N_per_m');
    input.value = number;
    input.dispatchEvent(new Event('input'));
  }, value);
  const becomes = value => until(page, wanted => document.getElementById('k1_N_per_m').value === wanted, value);
  await slide(40);
  await page.waitForTimeout(1100);
  await slide(60);
  await page.keyboard.press('Control+z');
  await becomes('40');
  await page.locator('#preset_again').click();
  await becomes('18');
  await page.locator('#undo').click();
  await becomes('40');
  await page.keyboard.press('Control+y');
  await becomes('18');
});

test('tissue and noise follow their sliders', async context => {
  const page = await opened(context);
  await press(page);
  const force = () => page.evaluate(() => parseFloat(document.getElementById('force_now').textContent));
  const soft = await force();
  await page.evaluate(() => { document.getElementById('noise').click(); });
  await page.evaluate(() => {
    const input = document.getElementById('k1_N_per_m');
    input.value = 80;
    input.dispatchEvent(new Event('input'));
  });
  await until(page, limit => parseFloat(document.getElementById('force_now').textContent) > limit, 2 * soft);
  assert.match(await page.locator('#preset').evaluate(list => list.selectedOptions[0].textContent), /, changed$/);
});

test('a phone shows everything without overflow, and a finger presses', async context => {
  const page = await opened(context, {width: 390, height: 844, touch: true});
  const overflow = () => page.evaluate(() => [document.documentElement.scrollWidth, document.documentElement.scrollHeight]);
  assert.deepEqual(await overflow(), [390, 844]);
  await page.locator('#sheet').tap();
  assert.deepEqual(await overflow(), [390, 844]);
  assert.equal(await page.locator('#preset').isVisible(), true);
  await page.locator('#sheet').tap();
  const {x, y, width, height} = await page.locator('#picture').boundingBox();
  await page.touchscreen.tap(x + 0.45 * width, y + 0.52 * height);
  await until(page, () => /^Move: one finger\.\u2003Press: lever/.test(document.getElementById('hint').textContent));
  await page.locator('#depth').fill('6');
  await pressing(page);
  const stage = await page.locator('#picture').boundingBox();
  assert.ok(stage.height > 0.4 * 844, `the picture is ${stage.height} high`);
});

test('an Inverse3 presses, feels the force, and gets zero force after its connection broke', async context => {
  const service = await new FakeHaply().start();
  const page = await opened(context, {pictures: 8});  // few, which leaves the processor to the loop
  const connect = async () => {
    await page.evaluate(address => { document.getElementById('address').value = address; }, service.address);
    await page.evaluate(() => document.getElementById('connect').click());
  };
  try {
    await connect();
    await until(page, () => /^Inverse3 04BA/.test(document.getElementById('haply').textContent));
    await until(page, () => document.getElementById('hint').textContent === 'The Inverse3 holds the tool.');
    await reachTissue(page, service);
    const [x, y, z] = service.forces.at(-1);
    assert.ok(Math.hypot(x, y, z) > 0.05, `${x} ${y} ${z}`);
    service.drop();
    await until(page, () => /^Zero force: the device could not be read.*the service closed the connection/.test(document.getElementById('fault').textContent));
    assert.equal(await text(page, '#force_now'), '0.00 N');
    const before = service.forces.length;
    await until(page, () => /^Inverse3 04BA/.test(document.getElementById('haply').textContent));  // connected again
    await page.waitForTimeout(300);
    assert.ok(service.forces.length > before);
    assert.ok(service.forces.slice(before).every(force => force.every(part => part === 0)), 'a latched fault keeps zero force');
    // Again if the loop of a busy machine stalls meanwhile.
    for (let i = 0; i < 50 && await page.locator('#fault').isVisible(); i++) {
      await page.evaluate(() => document.getElementById('reset').click());
      await page.waitForTimeout(100);
    }
    assert.equal(await page.locator('#fault').isVisible(), false);
    service.text = '{"inverse3": [{"device_id": "04BA"}]}';
    await until(page, () => /cursor_position.x: missing/.test(document.getElementById('fault').textContent));
    service.text = null;
  } finally {
    await service.stop();
  }
});

/**
 * Lowers the arm from outside, as a hand does, until the tool presses with a force. On a busy machine the loop may stall
 * meanwhile: then the arm goes back, the fault is reset, and it begins again.
 */
async function reachTissue(page, service) {
  const read = () => page.evaluate(() => ({state: document.getElementById('state').textContent, fault: !document.getElementById('fault').hidden}));
  const start = [...service.position];
  for (let attempt = 0; attempt < 12; attempt++) {
    service.position = [...start];
    await page.waitForTimeout(200);
    await page.evaluate(() => document.getElementById('reset').click());
    await page.waitForTimeout(300);
    for (let i = 0; i < 200; i++) {
      const {state, fault} = await read();
      if (fault) break;
      if (/^Pressing, [3-9]\.\d mm deep$/.test(state) && Math.hypot(...service.forces.at(-1)) > 0.05) return;
      const near = !/^\d\d/.test(state), ramp = /Force at/.test(state);  // the ramp rises while the arm is still
      if (!ramp && !/^Pressing, [4-9]/.test(state)) service.position[2] -= near ? 1e-3 : 5e-3;
      await page.waitForTimeout(80);
    }
  }
  assert.fail(`no force: ${JSON.stringify(await read())}`);
}

test('without a service the page says what to do', async context => {
  const page = await opened(context);
  await page.evaluate(() => {
    document.getElementById('address').value = 'ws://127.0.0.1:9';
    document.getElementById('connect').click();
  });
  await until(page, () => /no service answers. Start Haply/.test(document.getElementById('haply').textContent));
  errors.splice(0, errors.length, ...errors.filter(error => !/WebSocket connection to 'ws:\/\/127.0.0.1:9\//.test(error)));
});

test('no request left this computer, and no error reached the console', () => {
  assert.deepEqual(outside, []);
  assert.deepEqual(errors, []);
});
