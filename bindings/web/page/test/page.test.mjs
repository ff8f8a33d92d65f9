// The page in headless Chromium (software OpenGL) on a server on localhost.
// PALPATE_PAGE names the folder with the page and the package; NODE_PATH must lead to playwright-core.
import assert from 'node:assert/strict';
import {createServer} from 'node:http';
import {readFile} from 'node:fs/promises';
import {createRequire} from 'node:module';
import {extname, join} from 'node:path';
import {after, before, test} from 'node:test';
import {FakeHaply} from './fake_haply.mjs';
import {pixelsOf} from './picture.mjs';

const {chromium} = createRequire(import.meta.url)('playwright-core');
const FLAGS = ['--headless', '--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-quic',
  '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync'];
const TYPES = {'.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.wasm': 'application/wasm'};
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

/** Opens the page, until the end of the test. @param pictures at most so many a second */
async function opened(context, {width = 840, height = 540, touch = false, pictures = 60} = {}) {
  const page = await browser.newPage({viewport: {width, height}, hasTouch: touch, colorScheme: 'dark', acceptDownloads: true});
  context.after(() => page.close());
  page.setDefaultTimeout(LONG);
  if (pictures < 60) {
    await page.addInitScript(rate => { window.requestAnimationFrame = act => setTimeout(() => act(performance.now()), 1000 / rate); }, pictures);
  }
  page.on('request', request => {
    if (!['127.0.0.1', 'localhost'].includes(new URL(request.url()).hostname) && !/^(data|blob):/.test(request.url())) outside.push(request.url());
  });
  page.on('console', message => { if (message.type() === 'error') errors.push(message.text()); });
  page.on('pageerror', error => errors.push(error.message));
  await page.goto(url);
  await page.locator('#message').waitFor({state: 'hidden'});
  await page.locator('body[data-ready=press]').waitFor();
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

/** Takes the tool, and lowers it by the lever until it presses. */
async function press(page) {
  await page.locator('#picture').click({position: {x: 60, y: 100}});
  await until(page, () => /^Drag|^Press until/.test(document.getElementById('hint').textContent));
  await page.locator('#depth:enabled').waitFor();  // the first distance sets its ends
  const depth = await page.evaluate(() => document.getElementById('depth').max - 14);
  await page.locator('#depth').fill(String(depth));
  await pressing(page);
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
  const first = await page.evaluate(() => performance.getEntriesByName('first picture')[0].startTime);
  context.diagnostic(`first picture after ${Math.round(first)} ms`);
  await pressing(page);
  assert.match(await text(page, '#hint'), /^Demonstration/);
  const shot = await page.locator('#picture').screenshot();
  assert.ok(shot.length > 20000, `a picture of ${shot.length} bytes is empty`);
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

test('a drag and the lever press the gallbladder, and the plot shows the force', async context => {
  const page = await opened(context);
  await press(page);
  await page.waitForTimeout(500);
  const before = await curvePixels(page, 'force_plot', '--force');
  assert.ok(before > 10, `${before} pixels of the force`);
  const {x, y, width, height} = await page.locator('#picture').boundingBox();
  await page.mouse.move(x + width / 2, y + height / 2);
  const depth = parseFloat(await text(page, '#depth_now'));
  await wheel(page, 3);  // away from the user: 3 mm deeper
  await until(page, least => parseFloat(document.getElementById('depth_now').textContent) > least, depth + 2);
  await page.mouse.down();
  await page.mouse.move(x + width / 2 - 30, y + height / 2, {steps: 5});
  await page.mouse.up();
  await wheel(page, -40);
  await until(page, () => /from the tissue/.test(document.getElementById('state').textContent));
});

test('closed jaws pull the heart', async context => {
  const page = await opened(context);
  await choose(page, 'pull');
  await press(page);
  await page.locator('#jaws').click();
  assert.equal(await page.locator('#jaws').getAttribute('aria-pressed'), 'true');
  await page.waitForTimeout(600);
  await page.locator('#picture').hover({position: {x: 60, y: 100}});
  await wheel(page, -16);
  await until(page, () => /^Pulling, stretched ([3-9]|\d\d)\./.test(document.getElementById('state').textContent));
  assert.ok(parseFloat(await text(page, '#force_now')) > 0.05);
});

test('marks are counted, and the end of a search shows its score', async context => {
  const page = await opened(context);
  await choose(page, 'palpate');
  await press(page);
  await until(page, () => /times the uniform/.test(document.getElementById('ratio').textContent));
  await page.keyboard.press('m');
  await page.locator('#mark').click();
  assert.equal(await text(page, '#marks'), '2');
  await page.locator('#finish').click();
  const rows = await page.locator('#score').evaluate(list => [...list.children].map(one => one.textContent));
  const [found, lumps] = rows[rows.indexOf('Found') + 1].split(' of ').map(Number);
  assert.equal(lumps, 3);
  assert.equal(Number(rows[rows.indexOf('Missed') + 1]), 3 - found);
  assert.equal(await page.locator('#mark').isDisabled(), true);
  await page.locator('#finish').click();
  await until(page, () => document.getElementById('marks').textContent === '0');
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
  assert.equal(await page.locator('#preset').inputValue(), '');
});

test('a phone shows everything without overflow, and a finger presses', async context => {
  const page = await opened(context, {width: 390, height: 844, touch: true});
  const overflow = () => page.evaluate(() => [document.documentElement.scrollWidth, document.documentElement.scrollHeight]);
  assert.deepEqual(await overflow(), [390, 844]);
  await page.locator('#sheet').tap();
  assert.deepEqual(await overflow(), [390, 844]);
  assert.equal(await page.locator('#preset').isVisible(), true);
  await page.locator('#sheet').tap();
  await press(page);
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
