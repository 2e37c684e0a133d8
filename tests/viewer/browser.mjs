// A headless Chromium with a page in it, watched for errors and for anything it asks of a network.

import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { chromium } from 'playwright-core';

const FLAGS = [
  '--no-sandbox', '--disable-gpu', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader',
  '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync',
];

const LAUNCHES = 3;

/** The browsers that run, with WebGL and without: one of each serves all pages. */
const running = new Map();

async function browserWith(gl) {
  const found = running.get(gl);
  if (found?.browser.isConnected()) return found.browser;
  await found?.close();
  running.set(gl, await launch(gl));
  return running.get(gl).browser;
}

/** Starts a browser. One that ends before any page is open in it is no fault of a page: it is started anew, twice at most. */
async function launch(gl) {
  for (let left = LAUNCHES - 1; ; left -= 1) {
    const home = mkdtempSync(join(tmpdir(), 'clearway-viewer-'));
    const forget = () => rmSync(home, { recursive: true, force: true });
    try {
      const browser = await chromium.launch({
        executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
        headless: true,
        env: { ...process.env, HOME: home, XDG_CONFIG_HOME: home, XDG_CACHE_HOME: home },
        args: gl ? FLAGS : [...FLAGS.filter((f) => !f.includes('swiftshader') && !f.startsWith('--use-')), '--disable-3d-apis'],
      });
      return { browser, close: () => browser.close().finally(forget) };
    } catch (error) {
      forget();
      if (left === 0) throw error;
      console.error(`Chromium did not start (${left} more tries): ${error.message.split('\n')[0]}`);
    }
  }
}

/** Ends every browser; without it a program that opened a page does not end. */
export async function closeBrowsers() {
  await Promise.all([...running.values()].map(({ close }) => close()));
  running.clear();
}

/** Opens `file` (a path) with storage of its own; `gl: false` takes WebGL away. `problems` and `requests` fill as it runs. */
export async function openPage(file, { width = 1400, height = 900, theme = 'light', gl = true } = {}) {
  const browser = await browserWith(gl);
  const context = await browser.newContext({ viewport: { width, height }, colorScheme: theme, hasTouch: width < 600 });
  const page = await context.newPage();
  const address = pathToFileURL(resolve(file)).href;
  const problems = [];
  const requests = [];
  page.on('pageerror', (error) => problems.push(`uncaught: ${error.message}`));
  page.on('console', (message) => { if (message.type() === 'error') problems.push(`console: ${message.text()}`); });
  page.on('request', (request) => { if (request.url() !== address && !request.url().startsWith('data:')) requests.push(request.url()); });
  await page.goto(address);
  await page.waitForFunction(() => window.clearway?.ready === true, null, { timeout: 60_000 }).catch(() => problems.push('window.clearway never became ready'));
  return { page, problems, requests, close: () => context.close() };
}
