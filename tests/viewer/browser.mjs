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

/** Opens `file` (a path); `gl: false` takes WebGL away. `problems` and `requests` fill as it runs. */
export async function openPage(file, { width = 1400, height = 900, theme = 'light', gl = true } = {}) {
  const profile = mkdtempSync(join(tmpdir(), 'clearway-viewer-'));
  const context = await chromium.launchPersistentContext(profile, {
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    headless: true,
    env: { ...process.env, HOME: profile, XDG_CONFIG_HOME: profile, XDG_CACHE_HOME: profile },
    args: gl ? FLAGS : [...FLAGS.filter((f) => !f.includes('swiftshader') && !f.startsWith('--use-')), '--disable-3d-apis'],
    viewport: { width, height },
    colorScheme: theme,
    hasTouch: width < 600,
  });
  const page = context.pages()[0] ?? (await context.newPage());
  const address = pathToFileURL(resolve(file)).href;
  const problems = [];
  const requests = [];
  page.on('pageerror', (error) => problems.push(`uncaught: ${error.message}`));
  page.on('console', (message) => { if (message.type() === 'error') problems.push(`console: ${message.text()}`); });
  page.on('request', (request) => { if (request.url() !== address && !request.url().startsWith('data:')) requests.push(request.url()); });
  await page.goto(address);
  await page.waitForFunction(() => window.clearway?.ready === true, null, { timeout: 60_000 }).catch(() => problems.push('window.clearway never became ready'));
  const close = async () => {
    await context.close();
    rmSync(profile, { recursive: true, force: true });
  };
  return { page, problems, requests, close };
}
