// Test of the pictures in headless Chromium with OpenGL in software: node --test bindings/web/test
// PALPATE_WEB: folder of the package. CHROMIUM: the browser, default chromium. PALPATE_PICTURES: folder for the
// pictures, to look at.
import assert from 'node:assert/strict';
import {spawn} from 'node:child_process';
import {mkdtempSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {createServer} from 'node:http';
import {tmpdir} from 'node:os';
import path from 'node:path';
import test from 'node:test';
import {fileURLToPath} from 'node:url';

const here = fileURLToPath(new URL('.', import.meta.url));
const packageFolder = path.resolve(process.env.PALPATE_WEB ?? path.join(here, '../../../build/npm'));
const TYPES = {'.js': 'text/javascript', '.html': 'text/html', '.wasm': 'application/wasm'};

/** Serves the package and view.html, opens it in a browser, and waits for the report that it posts. */
async function reportOfBrowser() {
  let report = null;
  const server = createServer((request, response) => {
    const {pathname} = new URL(request.url, 'http://localhost');
    if (request.method === 'POST') {
      const parts = [];
      request.on('data', (part) => parts.push(part));
      request.on('end', () => {
        response.end();
        report(JSON.parse(Buffer.concat(parts).toString()));
      });
      return;
    }
    const folder = pathname === '/view.html' ? here : packageFolder;
    try {
      const contents = readFileSync(path.join(folder, path.basename(pathname)));
      response.writeHead(200, {'Content-Type': TYPES[path.extname(pathname)]}).end(contents);
    } catch {
      response.writeHead(404).end();
    }
  });
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  const profile = mkdtempSync(path.join(tmpdir(), 'palpate-chromium-'));
  const browser = spawn(process.env.CHROMIUM ?? 'chromium', [
    '--headless', '--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-quic',
    '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync',
    `--user-data-dir=${profile}`, `http://127.0.0.1:${server.address().port}/view.html`,
  ], {stdio: 'ignore', detached: true});
  let timer;
  try {
    return await new Promise((resolve, reject) => {
      report = resolve;
      browser.on('error', reject);
      browser.on('exit', (code) => reject(new Error(`the browser ended with ${code}`)));
      timer = setTimeout(() => reject(new Error('no report within two minutes')), 120e3);
    });
  } finally {
    clearTimeout(timer);
    server.close();
    server.closeAllConnections();
    browser.removeAllListeners('exit');
    const ended = new Promise((resolve) => browser.on('exit', resolve));
    if (browser.exitCode === null && browser.pid !== undefined) {
      process.kill(-browser.pid, 'SIGKILL');
      await ended;
    }
    rmSync(profile, {recursive: true, force: true, maxRetries: 5, retryDelay: 200});
  }
}

const report = await reportOfBrowser();
const picture = (name) => report.pictures.find((one) => one.name === name);

test('the browser draws without an error', () => {
  assert.equal(report.error, undefined);
  console.log(`${report.driver}: ${report.framesPerSecond.toFixed(1)} frames/s at 640 x 480 (${report.quality}); ` +
              `scene open after ${report.opened.toFixed(0)} ms, first picture after ${report.firstPicture.toFixed(0)} ms`);
  if (process.env.PALPATE_PICTURES) {
    for (const {name, url} of report.pictures) {
      writeFileSync(path.join(process.env.PALPATE_PICTURES, `${name}.png`), Buffer.from(url.split(',')[1], 'base64'));
    }
  }
});

for (const quality of ['full', 'balanced', 'fast']) {
  test(`a picture in quality ${quality} shows tissue, steel and background`, () => {
    const {tissue, steel, background} = picture(quality).shares;
    assert.ok(tissue > 0.3 && tissue < 0.8, `tissue ${tissue}`);
    assert.ok(steel > 0.002 && steel < 0.2, `steel ${steel}`);
    assert.ok(background > 0.1, `background ${background}`);
  });
}

test('the qualities show the same picture', () => {
  assert.ok(report.differences.balanced < 0.05, `balanced ${report.differences.balanced}`);
  assert.ok(report.differences.fast < 0.05, `fast ${report.differences.fast}`);
});

test('a view draws poses and contacts from elsewhere', () => {
  const {state, atRest} = report.states;
  assert.ok(atRest > 0.002 && state < 0.05 * atRest, `${state} and ${atRest}`);
  for (const words of report.refusals) assert.match(words, /^state: (must have one hand|too few numbers|every number)/);
});

test('a view draws the state of a snapshot', () => {
  const {snapshot, atRest} = report.differences;
  assert.ok(snapshot < 0.1 * atRest, `${snapshot} and ${atRest}`);  // 0 but for triangles that it split
});

test('the displacement map colours the indentation', () => {
  assert.ok(report.differences.displacement > 0.02, String(report.differences.displacement));
});

test('the middle of the picture meets the organ where the camera looks', () => {
  const {organ, world} = report.pick;
  assert.ok(Math.hypot(...organ) < 0.15 && Math.hypot(...world) < 0.3);
  assert.equal(report.pickOutside, null);
});
