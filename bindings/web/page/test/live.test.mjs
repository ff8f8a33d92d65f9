// The page of `palpate serve` in headless Chromium (software OpenGL). PALPATE_PROGRAM names the program, PALPATE_PAGE the folder
// of tools/make_page; NODE_PATH must lead to playwright-core.
import assert from 'node:assert/strict';
import {spawn} from 'node:child_process';
import {createRequire} from 'node:module';
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

/** Serves the page with these flags, opens it, and waits for its picture. @return page, and the errors of its console */
async function opened(context, ...flags) {
  const server = spawn(process.env.PALPATE_PROGRAM,
    ['serve', '--json', '--port', '0', '--page', join(process.env.PALPATE_PAGE, 'live'), ...flags], {stdio: ['ignore', 'pipe', 'ignore']});
  context.after(() => server.kill('SIGINT'));
  const line = await new Promise((found, failed) => {
    let text = '';
    server.stdout.on('data', more => { if ((text += more).includes('\n')) found(text.split('\n')[0]); });
    server.on('exit', code => failed(new Error(`palpate serve ended with ${code}`)));
  });
  const page = await browser.newPage({viewport: {width: 700, height: 800}});
  context.after(() => page.close());
  page.setDefaultTimeout(LONG);
  const errors = [];
  page.on('console', message => { if (message.type() === 'error') errors.push(message.text()); });
  page.on('pageerror', error => errors.push(error.message));
  await page.goto(`http://127.0.0.1:${JSON.parse(line).listening.port}/`);
  await page.locator('#picture canvas').waitFor();
  return {page, errors};
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
  const {page, errors} = await opened(context, '--task', 'pull', '--device', 'emulated', '--wait', '--duration-s', '4.8');
  const rest = await shares(page);
  assert.ok(rest.red > 0.1, `${rest.red}`);
  await page.locator('[data-do=start]').click();
  // The run ends while the forceps hold the tissue up.
  await page.waitForFunction(() => /^The run has ended: \d+ of 4800 ticks began too late\.$/.test(document.getElementById('words').textContent));
  await page.waitForTimeout(1000);
  const lifted = await shares(page);
  assert.ok(lifted.top < rest.top - 0.03, `${rest.top}, then ${lifted.top}`);
  assert.equal(await page.locator('#organ').isHidden(), true);
  assert.deepEqual(errors, []);
});
