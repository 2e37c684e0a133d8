// Takes a picture of a page, for people to look at:
//   node look.mjs PAGE.html OUT.png [width height time theme script]
// FULL=1 takes the whole page, not only the window.
import { closeBrowsers, openPage } from './browser.mjs';

const [page, out, width = 1400, height = 900, time = 0, theme = 'light', script = ''] = process.argv.slice(2);
const session = await openPage(page, { width: Number(width), height: Number(height), theme, gl: process.env.GL !== '0' });
await session.page.evaluate((t) => window.clearway?.setTime(t), Number(time));
if (script) console.log(await session.page.evaluate(script));
// Long enough for a camera on its way to arrive.
await session.page.waitForTimeout(900);
await session.page.screenshot({ path: out, fullPage: process.env.FULL === '1' });
for (const problem of session.problems) console.error(problem);
await session.close();
await closeBrowsers();
