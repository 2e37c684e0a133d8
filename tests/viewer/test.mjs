// Drives a viewer page in headless Chromium:
//   node test.mjs [PAGE.html]      or      PAGE=page.html npm test
// Without a page, one is made from the sample plan (which needs cargo).

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { closeBrowsers, openPage } from './browser.mjs';
import { angleBetween, fromPose, linkMatrices, multiply, positionOf, quaternionOf, readJoints } from './fk.mjs';
import { pushingPlan } from './pushing_plan.mjs';
import { impossiblePlan, samplePlan } from './sample_plan.mjs';

const POSITION_TOLERANCE = 1e-5;
const ANGLE_TOLERANCE = 1e-5;
const folder = mkdtempSync(join(tmpdir(), 'clearway-page-'));
const path = process.argv[2] ?? process.env.PAGE ?? samplePage();
const plan = planIn(readFileSync(path, 'utf8'));
after(async () => {
  await closeBrowsers();
  rmSync(folder, { recursive: true, force: true });
});

function samplePage() {
  const [from, to] = [join(folder, 'sample.plan.json'), join(folder, 'sample.html')];
  writeFileSync(from, JSON.stringify(samplePlan()));
  const root = fileURLToPath(new URL('../..', import.meta.url));
  execFileSync('cargo', ['run', '--quiet', '-p', 'clearway-viewer', '--example', 'page', '--', from, to], { cwd: root, stdio: 'inherit' });
  return to;
}

function planIn(html) {
  return JSON.parse(html.match(/<script type="application\/json" id="plan">([\s\S]*?)<\/script>/)[1]);
}

/** The same page with another plan in it. */
function pageWith(other, meshes = []) {
  const safe = (value) => JSON.stringify(value).replace(/[<>&\u2028\u2029]/g, (c) => `\\u${c.charCodeAt(0).toString(16).padStart(4, '0')}`);
  const file = join(folder, `other-${Math.random().toString(36).slice(2)}.html`);
  const html = readFileSync(path, 'utf8');
  const put = (id, value) => (text) =>
    text.replace(new RegExp(`(<script type="application/json" id="${id}">)[\\s\\S]*?(</script>)`), (_, open, close) => open + safe(value) + close);
  writeFileSync(file, put('plan', other)(put('meshes', meshes)(html)));
  return file;
}

/** Segments end to end, each with the plan-global time of its first row. */
function segmentsOf(steps) {
  let clock = 0;
  return steps.flatMap((step) => step.segments.map((segment) => {
    const start = clock;
    clock += segment.times.at(-1) ?? 0;
    return { ...segment, step, start, end: clock };
  }));
}

/** Link matrices at a row, by kinematics that share nothing with the page's. */
function expectedLinks(segment, row) {
  const { robot, scene } = plan;
  const values = { ...robot.fixed, ...robot.home, ...scene.robot.start };
  robot.joints.forEach((name, i) => { values[name] = segment.positions[row][i]; });
  for (const [name, value] of Object.entries(segment.gripper ?? {})) values[name] = Array.isArray(value) ? value[row] : value;
  return linkMatrices(readJoints(robot.urdf), values, fromPose(scene.robot.base ?? {}));
}

function assertPose(pose, matrix, what) {
  const off = Math.hypot(...positionOf(matrix).map((v, i) => v - pose.position[i]));
  assert.ok(off < POSITION_TOLERANCE, `${what}: ${off} m off`);
  const turned = angleBetween(quaternionOf(matrix), pose.quaternion);
  assert.ok(turned < ANGLE_TOLERANCE || Math.abs(turned) < 1e-4, `${what}: turned by ${turned} rad`);
}

/** A small copy of the 3D picture at `t`: bytes RGBA. */
const pictureAt = (page, t) => page.evaluate((time) => {
  window.clearway.setTime(time);
  const small = new OffscreenCanvas(160, 120).getContext('2d');
  small.drawImage(document.getElementById('view'), 0, 0, 160, 120);
  return [...small.getImageData(0, 0, 160, 120).data];
}, t);

const differing = (a, b) => a.filter((v, i) => Math.abs(v - b[i]) > 12).length;

describe('the page', () => {
  let session;
  before(async () => { session = await openPage(path, { width: 1000, height: 640 }); });
  after(() => session?.close());
  const moving = plan.steps?.length > 0;
  const segments = segmentsOf(plan.steps ?? []);
  const duration = segments.at(-1)?.end ?? 0;

  test('opens without an error and asks nothing of a network', () => {
    assert.deepEqual(session.problems, []);
    assert.deepEqual(session.requests, []);
  });

  test('draws', async () => {
    const pixels = await pictureAt(session.page, 0);
    const colours = new Set();
    for (let i = 0; i < pixels.length; i += 4) if (pixels[i + 3] > 200) colours.add((pixels[i] >> 3 << 10) | (pixels[i + 1] >> 3 << 5) | (pixels[i + 2] >> 3));
    assert.ok(colours.size > 30, `only ${colours.size} colours`);
    const above = await session.page.evaluate(() => {
      const canvas = document.getElementById('above');
      return canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data.filter((v) => v > 0).length;
    });
    assert.ok(above > 1000, 'the view from above is blank');
  });

  test('says the verdict', async () => {
    const text = await session.page.innerText('#bar');
    assert.match(text, { solved: /Solved/, impossible: /Impossible/, out_of_budget: /Budget spent/ }[plan.status]);
    if (plan.removed?.length) assert.match(text, new RegExp(`${plan.removed.length} removed`));
    if (plan.why?.summary) assert.ok((await session.page.innerText('#why')).includes(plan.why.summary));
  });

  test('knows how long the plan is', async () => {
    assert.ok(Math.abs((await session.page.evaluate(() => window.clearway.duration)) - duration) < 1e-6);
  });

  test('plays and stops', { skip: !moving }, async () => {
    const { page } = session;
    const now = () => page.evaluate(() => ({ time: window.clearway.time, playing: window.clearway.playing }));
    await page.evaluate(() => window.clearway.setTime(0));
    await page.click('#play');
    await page.waitForFunction(() => window.clearway.time > 0.1);
    assert.equal((await now()).playing, true);
    await page.keyboard.press('Space');
    const { time, playing } = await now();
    assert.equal(playing, false);
    await page.waitForTimeout(200);
    assert.equal((await now()).time, time);
    await page.evaluate(() => { window.clearway.setTime(window.clearway.duration - 0.05); window.clearway.play(); });
    await page.waitForFunction(() => !window.clearway.playing);
    assert.ok(Math.abs((await now()).time - duration) < 1e-6);
  });

  test('the arrows step through the segments', { skip: !moving }, async () => {
    const { page } = session;
    await page.evaluate(() => window.clearway.setTime(0));
    const starts = [...new Set(segments.map((s) => s.start))];
    await page.keyboard.press('ArrowRight');
    assert.ok(Math.abs((await page.evaluate(() => window.clearway.time)) - starts[1]) < 1e-6);
    const words = await page.innerText('#step-words');
    assert.ok(words.includes(`1 of ${plan.steps.length}`) && words.includes(plan.steps[0].object), words);
    await page.keyboard.press('ArrowLeft');
    assert.equal(await page.evaluate(() => window.clearway.time), 0);
  });

  test('the slider moves the arm, as independent kinematics say', { skip: !moving }, async () => {
    const { page } = session;
    const slide = (t) => page.evaluate((time) => {
      const slider = document.getElementById('slider');
      slider.value = time;
      slider.dispatchEvent(new Event('input', { bubbles: true }));
      return window.clearway.time;
    }, t);
    const poseOf = (name) => page.evaluate((link) => window.clearway.linkPose(link), name);
    const seen = new Set();
    for (const segment of segments) {
      const row = Math.floor(segment.times.length / 2);
      // Off the row by a hair would still be within tolerance; on a border the later segment rules.
      const shown = await slide(segment.start + segment.times[row]);
      if (row === 0 || row === segment.times.length - 1) continue;
      assert.ok(Math.abs(shown - segment.start - segment.times[row]) < 1e-6);
      const links = expectedLinks(segment, row);
      for (const name of [plan.robot.tool, ...(plan.robot.hand?.links ?? [])]) assertPose(await poseOf(name), links[name], `${name} in ${segment.step.object} ${segment.kind} row ${row}`);
      seen.add((await poseOf(plan.robot.tool)).position.map((v) => v.toFixed(3)).join());
    }
    assert.ok(seen.size > 2, 'the tool hardly moves');
  });

  test('what is held follows the tool, and ends where it was placed', { skip: !moving }, async () => {
    const { page } = session;
    const at = (t, id) => page.evaluate(([time, name]) => { window.clearway.setTime(time); return window.clearway.objectPose(name); }, [t, id]);
    for (const segment of segments.filter((s) => s.attached)) {
      const { object, tool, pose_in_tool } = segment.attached;
      for (const share of [0.25, 0.75]) {
        const row = Math.floor(share * (segment.times.length - 1));
        const expected = multiply(expectedLinks(segment, row)[tool], fromPose(pose_in_tool));
        assertPose(await at(segment.start + segment.times[row], object), expected, `${object} row ${row}`);
      }
    }
    const last = new Map(plan.steps.map((step) => [step.object, step.placed]));
    for (const [id, placed] of last) assertPose(await at(duration, id), fromPose(placed), `${id} at the end`);
    for (const object of plan.scene.objects) if (!last.has(object.id)) assertPose(await at(duration, object.id), fromPose(object), `${object.id}, never moved`);
  });

  test('the end looks other than the start', { skip: !moving }, async () => {
    const count = differing(await pictureAt(session.page, 0), await pictureAt(session.page, duration));
    assert.ok(count > 200, `${count} values differ`);
  });

  test('the views and layers switch without an error', async () => {
    const { page } = session;
    const before = await pictureAt(page, 0);
    for (const view of ['front', 'side', 'top']) {
      await page.click(`[data-view=${view}]`);
      await page.waitForTimeout(450);
    }
    assert.ok(differing(before, await pictureAt(page, 0)) > 200, 'the view from the top looks like the first');
    for (const button of await page.$$('[data-layer]:visible, [data-option], #whole, #theme')) await button.click();
    await page.click('[data-view=home]');
    assert.deepEqual(session.problems, []);
    assert.deepEqual(session.requests, []);
  });
});

describe('a push', { skip: !plan.steps?.length }, () => {
  let session, made, object, segment;
  before(async () => {
    made = pushingPlan(plan);
    object = made.plan.steps[0].object;
    segment = made.plan.steps[0].segments[0];
    session = await openPage(pageWith(made.plan), { width: 1000, height: 640 });
  });
  after(() => session?.close());
  const objectAt = ({ page }, t) => page.evaluate(([time, id]) => { window.clearway.setTime(time); return window.clearway.objectPose(id).position; }, [t, object]);
  const assertNear = (found, expected, what) => {
    const off = Math.hypot(...found.map((v, i) => v - expected[i]));
    assert.ok(off < POSITION_TOLERANCE, `${what}: ${off} m off`);
  };

  test('takes the object along once the hand is at it, and leaves it where it has come', async () => {
    assert.ok(made.ways[1] === 0 && made.ways.filter((w) => w > 0).length > 3, `${made.ways}`);
    for (const [row, way] of made.ways.entries()) assertNear(await objectAt(session, segment.times[row]), made.at(way), `row ${row}`);
    const total = await session.page.evaluate(() => window.clearway.duration);
    assertNear(await objectAt(session, total), made.plan.steps[0].placed.position, 'at the end');
    assertNear(await objectAt(session, 0), made.at(0), 'back at the start');
    assert.deepEqual(session.problems, []);
  });

  test('goes evenly with time if the plan says only where it ends', async () => {
    const { push, ...step } = made.plan.steps[0];
    const other = await openPage(pageWith({ ...made.plan, steps: [step] }));
    const length = segment.times.at(-1);
    for (const share of [0, 0.25, 0.5, 1]) assertNear(await objectAt(other, share * length), made.at(share * push.distance), `at ${share}`);
    assert.deepEqual(other.problems, []);
    await other.close();
  });

  test('is told in words, with its reason', async () => {
    const { page } = session;
    const way = `aside by ${Math.round(made.plan.steps[0].push.distance * 1000)} mm`;
    await page.evaluate(() => window.clearway.setTime(0.001));
    assert.ok((await page.innerText('#step-words')).includes(`pushing ${object} ${way}`));
    assert.ok((await page.innerText('#steps')).includes(`push ${way}`));
    assert.ok((await page.innerText('#why')).includes(made.plan.why.objects[0].push));
  });
});

test('says the least clearance, and goes to where it is', { skip: !plan.steps?.length }, async () => {
  const { plan: other } = pushingPlan(plan);
  const session = await openPage(pageWith(other), { width: 1000, height: 640 });
  const { time } = other.clearance.least;
  assert.ok((await session.page.innerText('#bar')).includes('clearance 3.7 mm'));
  assert.ok((await session.page.innerText('#figures')).includes(`3.7 mm: link right_finger, object o8, at ${time.toFixed(1)} s`));
  for (const place of ['#bar', '#figures']) {
    await session.page.evaluate(() => window.clearway.setTime(0));
    await session.page.click(`${place} .to-time`);
    assert.equal(await session.page.evaluate(() => window.clearway.time), time);
  }
  assert.deepEqual(session.problems, []);
  await session.close();
  const far = await openPage(pageWith({ ...other, clearance: { asked: 0.002, up_to: 0.05 } }));
  assert.ok((await far.page.innerText('#figures')).includes('above 50 mm, 2 mm asked for'));
  await far.close();
});

test('fits a phone', async () => {
  const session = await openPage(path, { width: 390, height: 844, theme: 'dark' });
  assert.equal(await session.page.evaluate(() => document.documentElement.scrollWidth), 390);
  assert.deepEqual(session.problems, []);
  await session.close();
});

test('without WebGL it says so, and the rest works', async () => {
  const session = await openPage(path, { gl: false });
  assert.match(await session.page.innerText('#no-gl'), /No 3D view/);
  assert.deepEqual(session.problems, []);
  await session.page.evaluate(() => window.clearway.setTime(1));
  assert.ok(await session.page.evaluate((tool) => window.clearway.linkPose(tool), plan.robot.tool));
  await session.close();
});

const bare = (p) => {
  const { trace, why, lower_bound, timing, stats, removed, seed, ...rest } = p;
  return rest;
};
const hostileName = '</script><img src=x onerror=alert(1)><!-- \u2028 {{script}}';
const OTHERS = {
  'only what a plan must have': () => bare(plan),
  'nulls for what may be absent': () => ({ ...plan, trace: null, why: null, lower_bound: null }),
  'no steps, proved impossible': impossiblePlan,
  'a scene alone, budget spent': () => ({ ...bare(plan), status: 'out_of_budget', steps: [] }),
  'an unreadable URDF': () => ({ ...plan, robot: { ...plan.robot, urdf: '<robot' } }),
  'names made to break out': () => ({ ...plan, scene: { ...plan.scene, name: hostileName }, why: { summary: hostileName, objects: [] } }),
};
for (const [name, make] of Object.entries(OTHERS)) {
  test(`opens with ${name}`, async () => {
    const session = await openPage(pageWith(make()));
    assert.deepEqual(session.problems, []);
    assert.deepEqual(session.requests, []);
    await session.page.evaluate(() => window.clearway.setTime(window.clearway.duration));
    assert.equal(await session.page.$('img'), null);
    assert.deepEqual(session.problems, []);
    await session.close();
  });
}

test('every kind of shape is drawn, meshes and point clouds from the page itself', async () => {
  const wedge = { uri: 'wedge.stl', origin: [-0.1, -0.1, 0], step: 0.1, vertices: [0, 0, 0, 2, 0, 0, 2, 2, 0, 0, 2, 0, 1, 1, 3], triangles: [0, 2, 1, 0, 3, 2, 0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4] };
  const cloud = { uri: 'cloud.xyz', origin: [0, 0, 0], step: 0.02, vertices: Array.from({ length: 300 }, (_, i) => [i % 10, Math.floor(i / 10) % 10, Math.floor(i / 100)]).flat(), triangles: [] };
  const [x, y, z] = plan.scene.objects[0].position;
  const bodies = [
    { id: 'f_mesh', mesh: { file: 'wedge.stl', scale: [1, 1, 0.8] }, position: [x - 0.6, y + 0.9, 0] },
    { id: 'f_points', points: { file: 'cloud.xyz', radius: 0.008 }, position: [x - 0.4, y + 0.5, z] },
    { id: 'f_missing', mesh: { file: 'missing.stl' }, position: [x, y, z] },
  ];
  const objects = [
    { id: 'x_sphere', sphere: { radius: 0.05 }, position: [x - 0.7, y + 0.5, 0.05] },
    { id: 'x_capsule', capsule: { radius: 0.04, height: 0.1 }, position: [x - 0.85, y + 0.5, 0.09] },
    { id: 'x_box', box: { size: [0.1, 0.06, 0.2] }, position: [x - 1, y + 0.5, 0.1], rpy: [0, 0, 0.4] },
    { id: 'x_mug', compound: [{ cylinder: { radius: 0.04, height: 0.1 } }, { box: { size: [0.05, 0.012, 0.05] }, position: [0.055, 0, 0] }], position: [x - 1.15, y + 0.5, 0.05] },
  ];
  const scene = { ...plan.scene, fixtures: [...(plan.scene.fixtures ?? []), ...bodies], objects: [...plan.scene.objects, ...objects],
    camera: { position: [x - 1, y, z + 0.6], look_at: [x, y, z], fov: 1 } };
  const session = await openPage(pageWith({ ...plan, scene }, [wedge, cloud]), { width: 1000, height: 640 });
  assert.deepEqual(session.problems, []);
  const notes = await session.page.innerText('#notes');
  assert.ok(notes.includes('missing.stl') && !notes.includes('wedge.stl') && !notes.includes('cloud.xyz'), notes);
  const without = await openPage(path, { width: 1000, height: 640 });
  assert.ok(differing(await pictureAt(session.page, 0), await pictureAt(without.page, 0)) > 100);
  await without.close();
  if (process.env.PICTURE) await session.page.screenshot({ path: process.env.PICTURE });
  await session.close();
});
