// The page of `palpate serve` and `palpate run --page` in headless Chromium (software OpenGL). PALPATE_PROGRAM names the program, PALPATE_PAGE the folder
// of tools/make_page; NODE_PATH must lead to playwright-core.
import assert from 'node:assert/strict';
import {spawn, spawnSync} from 'node:child_process';
import {mkdtemp, readdir, rm} from 'node:fs/promises';
import {createRequire} from 'node:module';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, before, test} from 'node:test';
import {pixelsOf} from './picture.mjs';

const {chromium} = createRequire(import.meta.url)('playwright-core');
const FLAGS = ['--headless', '--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-quic',
  '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync'];
const LONG = 90000;  // ms: software OpenGL on a busy machine
let browser;

before(async () => {
  browser = await chromium.launch({executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium', args: FLAGS});
});
after(() => browser?.close());

/** Starts the program, opens its page, and waits for the picture. @return page, the errors of its console, and the program's folder */
async function opened(context, ...words) {
  const folder = await mkdtemp(join(tmpdir(), 'palpate-live-'));
  const server = spawn(process.env.PALPATE_PROGRAM, words, {cwd: folder, stdio: ['ignore', 'pipe', 'ignore']});
  context.after(async () => {
    server.kill('SIGINT');
    await new Promise(ended => { if (server.exitCode !== null) ended(); else server.on('exit', ended); });
    await rm(folder, {recursive: true});
  });
  const line = await new Promise((found, failed) => {
    let text = '';
    server.stdout.on('data', more => { if ((text += more).includes('\n')) found(text.split('\n')[0]); });
    server.on('exit', code => failed(new Error(`palpate ended with ${code}`)));
  });
  const {port, token} = JSON.parse(line).listening;
  const page = await browser.newPage({viewport: {width: 700, height: 800}});
  context.after(() => page.close());
  page.setDefaultTimeout(LONG);
  const errors = [];
  page.on('console', message => { if (message.type() === 'error') errors.push(message.text()); });
  page.on('pageerror', error => errors.push(error.message));
  await page.goto(`http://127.0.0.1:${port}/${token ? '#' + token : ''}`);
  await page.locator('#picture canvas').waitFor();
  return {page, errors, folder};
}

/** Share of red pixels, and the height of the highest one, 0 at the top. */
async function shares(page) {
  return (await pixelsOf(page)).evaluate(({data, width, height}) => {
    let red = 0, top = height;
    for (let i = 0; i < data.length; i += 4) {
      if (data[i] < data[i + 2] + 40) continue;
      red++;
      top = Math.min(top, Math.floor(i / 4 / width));
    }
    return {red: red / (data.length / 4), top: top / height};
  });
}

test('the page of a live run draws the heart and how the forceps lift it', async context => {
  const {page, errors} = await opened(context, 'serve', '--json', '--port', '0',
    '--page', join(process.env.PALPATE_PAGE, 'live'), '--task', 'pull', '--device', 'emulated', '--wait', '--duration-s', '4.8');
  const rest = await shares(page);
  assert.ok(rest.red > 0.1, `${rest.red}`);
  await page.locator('#start').click();
  // The run ends while the forceps hold the tissue up.
  await page.waitForFunction(() => /^The run has ended: \d+ of 4800 ticks began too late\.$/.test(document.getElementById('words').textContent));
  await page.waitForTimeout(1000);
  const lifted = await shares(page);
  assert.ok(lifted.top < rest.top - 0.03, `${rest.top}, then ${lifted.top}`);
  assert.equal(await page.locator('#organ').isHidden(), true);

  // The picture of an ended run still follows the window's size and the view.
  await page.setViewportSize({width: 390, height: 800});
  await page.waitForFunction(() => {
    const canvas = document.querySelector('#picture canvas');
    return Math.abs(canvas.width / canvas.height - canvas.clientWidth / canvas.clientHeight) < 0.02;
  });
  const box = await page.locator('#picture canvas').boundingBox();
  const before = await page.locator('#picture canvas').screenshot();
  await page.mouse.move(box.x + 0.3 * box.width, box.y + 0.5 * box.height);
  await page.mouse.down();
  await page.mouse.move(box.x + 0.6 * box.width, box.y + 0.5 * box.height, {steps: 4});
  await page.mouse.up();
  await page.waitForTimeout(1000);
  assert.notDeepEqual(await page.locator('#picture canvas').screenshot(), before);
  assert.deepEqual(errors, []);
});

/** Force [N] and depth [mm] that the page shows. */
const shown = page => page.locator('#now').textContent().then(text => text.match(/: ([\d.]+) N at (-?[\d.]+) mm/).slice(1).map(Number));

/** Waits for more than this depth [mm]. */
const deeper = (page, depth) => page.waitForFunction(least => Number(/at (-?[\d.]+) mm/.exec(document.getElementById('now').textContent)?.[1]) > least, depth);

test('the mouse on the page presses, its recording replays, and another device follows', async context => {
  const began = performance.now();
  const {page, errors, folder} = await opened(context, 'run', '--page', '--json', '--device', 'mouse');
  await page.locator('#mouse').waitFor();
  const box = await page.locator('#picture canvas').boundingBox();
  await page.mouse.move(box.x + 0.5 * box.width, box.y + 0.5 * box.height);
  for (let i = 0; i < 9; i++) await page.mouse.wheel(0, -100);
  await deeper(page, 2);
  context.diagnostic(`2 mm deep ${((performance.now() - began) / 1000).toFixed(1)} s after the start of the program`);
  const [force, depth] = await shown(page);
  assert.ok(force > 0.02 && depth < 5, `${force} N at ${depth} mm`);
  await page.waitForFunction(() => /^\d+ of 1000 ticks a second; \d+ of \d+ began too late$/.test(document.getElementById('timing').textContent));
  assert.equal(await page.locator('#device').isDisabled(), true);
  assert.equal(await page.locator('#device').inputValue(), 'mouse');

  await page.locator('#record').click();
  await page.waitForFunction(() => document.getElementById('record').textContent === 'End the recording');
  await page.mouse.move(box.x + 0.6 * box.width, box.y + 0.5 * box.height);
  await page.waitForTimeout(500);
  await page.locator('#record').click();
  await page.waitForFunction(() => document.getElementById('recording').textContent.startsWith('Recorded in '));
  const [file] = await readdir(folder);
  const path = process.env.WINEPREFIX ? `Z:${join(folder, file)}`.replaceAll('/', '\\') : join(folder, file);
  assert.equal(await page.locator('#recording').textContent(), `Recorded in ${path}`);
  const replay = spawnSync(process.env.PALPATE_PROGRAM, ['replay', file, '--verify'], {cwd: folder, encoding: 'utf8'});
  assert.equal(replay.status, 0, replay.stderr);

  await page.locator('[data-do=stop]').click();
  await page.waitForFunction(() => document.querySelector('#device option:checked')?.value === 'mouse' && !document.getElementById('device').disabled);
  assert.equal(await page.locator('#device option[value=haply]').isDisabled(), true);
  await page.locator('#device').selectOption('emulated');
  await page.locator('#start').click();
  await page.locator('#mouse').waitFor({state: 'hidden'});
  assert.equal(await page.locator('#device').inputValue(), 'emulated');
  assert.deepEqual(errors, []);
});

test("the browser's gamepad presses the tool into the organ", async context => {
  const {page, errors} = await opened(context, 'run', '--page', '--json', '--device', 'gamepad');
  await page.locator('#gamepad').waitFor();
  await page.evaluate(() => {
    const buttons = Array.from({length: 17}, () => ({pressed: false, value: 0}));
    buttons[7].value = 0.6;  // the right trigger: 15 mm, from 10 mm above the organ
    navigator.getGamepads = () => [null, {mapping: 'standard', axes: [0.1, 0, 0, 0], buttons}];
  });
  await deeper(page, 2);
  assert.equal(await page.locator('#fault').isHidden(), true);
  assert.deepEqual(errors, []);
});
