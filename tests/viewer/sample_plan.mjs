// Writes a plausible plan without a planner: a shelf of twelve cylinders, three picks, rows from
// numerical inverse kinematics. Nothing here is checked for collisions; it is food for the page.
//   node sample_plan.mjs > sample.plan.json        node sample_plan.mjs --impossible > …

import { readFileSync } from 'node:fs';
import { pathToFileURL } from 'node:url';
import { sampleTrace } from './sample_trace.mjs';
import { fromPose, invert, linkMatrices, multiply, positionOf, quaternionOf, readJoints } from './fk.mjs';

const URDF = readFileSync(new URL('./sample_robot.urdf', import.meta.url), 'utf8');
const JOINTS = ['shoulder_pan_joint', 'shoulder_lift_joint', 'elbow_joint', 'wrist_1_joint', 'wrist_2_joint', 'wrist_3_joint'];
const TOOL = 'grasp_center';
const BASE = { position: [0, 0, 0.45], rpy: [0, 0, 0] };
const ROW = 0.02;
const SHELF_TOP = 0.6;
const TRAY = { id: 'tray', size: [0.56, 0.66], position: [0.08, -0.86, 0.5] };

const cylinder = (id, x, y, radius = 0.036, height = 0.24) => ({
  id, cylinder: { radius, height }, position: [x, y, SHELF_TOP + height / 2],
});
const SCENE = {
  format: 'clearway-scene/1',
  name: 'shelf-12',
  frame: 'world',
  robot: { model: 'sample_arm', base: BASE },
  fixtures: [
    { id: 'shelf_floor', box: { size: [0.56, 0.94, 0.02] }, position: [0.98, 0, 0.59] },
    { id: 'shelf_top', box: { size: [0.56, 0.94, 0.02] }, position: [0.98, 0, 1.11] },
    { id: 'shelf_left', box: { size: [0.56, 0.02, 0.52] }, position: [0.98, 0.46, 0.85] },
    { id: 'shelf_right', box: { size: [0.56, 0.02, 0.52] }, position: [0.98, -0.46, 0.85] },
    { id: 'shelf_back', box: { size: [0.02, 0.94, 0.52] }, position: [1.25, 0, 0.85] },
    { id: 'shelf_foot', box: { size: [0.5, 0.88, 0.58] }, position: [0.99, 0, 0.29] },
    { id: 'table', box: { size: [0.64, 0.74, 0.03] }, position: [0.08, -0.86, 0.485] },
    { id: 'table_leg', cylinder: { radius: 0.05, height: 0.47 }, position: [0.08, -0.86, 0.235] },
    { id: 'pedestal', box: { size: [0.3, 0.3, 0.17] }, position: [0, 0, 0.085] },
  ],
  objects: [
    cylinder('o1', 0.80, 0.33), cylinder('o2', 0.93, 0.26, 0.04, 0.2), cylinder('o3', 0.92, -0.03),
    cylinder('o4', 0.86, -0.22, 0.034, 0.26), cylinder('o5', 1.06, -0.33, 0.04, 0.22), cylinder('o6', 1.16, -0.2),
    cylinder('o7', 1.09, 0.02, 0.034, 0.24), cylinder('o8', 0.80, 0.07, 0.036, 0.2), cylinder('o9', 1.16, 0.18, 0.038, 0.26),
    cylinder('o10', 1.05, 0.34, 0.034, 0.18), cylinder('o11', 1.17, 0.36), cylinder('o12', 0.80, -0.36, 0.04, 0.18),
  ],
  target: 'o7',
  place: [TRAY],
  workspace: { min: [0.62, -0.44], max: [1.24, 0.44] },
  exit: [0.6, 0.04],
};
const REMOVED = ['o8', 'o3', 'o7'];
const SLOTS = [[0.2, -0.7], [-0.02, -0.7], [0.1, -0.92]];

const tree = readJoints(URDF);
const toolMatrix = (q, base = fromPose(BASE)) =>
  linkMatrices(tree, Object.fromEntries(JOINTS.map((name, i) => [name, q[i]])), base)[TOOL];

// The tool level at `position`, pointing along world yaw, closing sideways.
const level = (position, yaw) => {
  const [c, s] = [Math.cos(yaw), Math.sin(yaw)];
  return [s, 0, c, position[0], -c, 0, s, position[1], 0, -1, 0, position[2], 0, 0, 0, 1];
};

function poseError(now, wanted) {
  const column = (m, c) => [m[c], m[4 + c], m[8 + c]];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const turn = [0, 0, 0];
  for (let c = 0; c < 3; c++) cross(column(now, c), column(wanted, c)).forEach((v, i) => (turn[i] += v / 2));
  return [...positionOf(wanted).map((v, i) => v - positionOf(now)[i]), ...turn];
}

function solve(a, b) {
  const n = b.length;
  const m = a.map((row, i) => [...row, b[i]]);
  for (let c = 0; c < n; c++) {
    let p = c;
    for (let r = c + 1; r < n; r++) if (Math.abs(m[r][c]) > Math.abs(m[p][c])) p = r;
    [m[c], m[p]] = [m[p], m[c]];
    for (let r = 0; r < n; r++) {
      if (r === c) continue;
      const f = m[r][c] / m[c][c];
      for (let k = c; k <= n; k++) m[r][k] -= f * m[c][k];
    }
  }
  return m.map((row, i) => row[n] / row[i]);
}

// Damped least squares from `start`, with a numerical Jacobian.
function inverse(wanted, start) {
  const q = [...start];
  for (let iteration = 0; iteration < 200; iteration++) {
    const now = toolMatrix(q);
    const e = poseError(now, wanted);
    if (Math.hypot(...e) < 1e-6) return q;
    const h = 1e-6;
    const columns = q.map((_, j) => {
      const moved = [...q];
      moved[j] += h;
      return poseError(toolMatrix(moved), wanted).map((v, i) => (e[i] - v) / h);
    });
    const jjt = e.map((_, r) => e.map((_, c) => columns.reduce((sum, k) => sum + k[r] * k[c], r === c ? 1e-4 : 0)));
    const y = solve(jjt, e);
    const step = columns.map((k) => k.reduce((sum, v, i) => sum + v * y[i], 0));
    const scale = Math.min(1, 0.3 / Math.max(...step.map(Math.abs)));
    step.forEach((v, j) => (q[j] += scale * v));
  }
  throw new Error(`no posture for ${positionOf(wanted)}`);
}

// Tool poses between two [x, y, z, yaw], straight or round the robot's axis.
function between(a, b, round) {
  const count = Math.max(2, Math.ceil(Math.hypot(...a.map((v, i) => v - b[i])) / 0.03));
  const mix = (x, y, s) => x + (y - x) * s;
  return Array.from({ length: count + 1 }, (_, i) => {
    const s = i / count;
    const yaw = mix(a[3], b[3], s);
    const z = mix(a[2], b[2], s);
    if (!round) return level([mix(a[0], b[0], s), mix(a[1], b[1], s), z], yaw);
    const angle = mix(Math.atan2(a[1], a[0]), Math.atan2(b[1], b[0]), s);
    const r = mix(Math.hypot(a[0], a[1]), Math.hypot(b[0], b[1]), s);
    return level([r * Math.cos(angle), r * Math.sin(angle), z], yaw);
  });
}

// Rows through the postures, at rest at both ends, a row every 20 ms.
function timed(postures, speed = 0.9) {
  const s = [0];
  for (let i = 1; i < postures.length; i++)
    s.push(s[i - 1] + Math.hypot(...postures[i].map((v, j) => v - postures[i - 1][j])));
  const length = s.at(-1);
  const count = Math.max(1, Math.ceil((1.9 * length) / speed / ROW));
  const times = [], positions = [];
  for (let row = 0; row <= count; row++) {
    const u = row / count;
    const at = length * u * u * u * (10 - 15 * u + 6 * u * u);
    let i = s.findIndex((v) => v >= at - 1e-12);
    i = Math.max(1, i === -1 ? s.length - 1 : i);
    const f = s[i] > s[i - 1] ? (at - s[i - 1]) / (s[i] - s[i - 1]) : 0;
    times.push(Number((row * ROW).toFixed(6)));
    positions.push(postures[i].map((v, j) => postures[i - 1][j] + f * (v - postures[i - 1][j])));
  }
  return { times, positions };
}

export function samplePlan() {
  const homeAt = [0.56, 0.12, 0.98, 0];
  const home = inverse(level(homeAt.slice(0, 3), 0), [0, -0.6, 2.2, -1.6, -1.57, 0]);
  let q = home;
  const follow = (waypoints, round = []) => {
    const postures = [q];
    for (let i = 1; i < waypoints.length; i++)
      for (const pose of between(waypoints[i - 1], waypoints[i], round.includes(i)).slice(1)) postures.push((q = inverse(pose, q)));
    return timed(postures);
  };
  const rest = (seconds) => {
    const times = Array.from({ length: Math.round(seconds / ROW) + 1 }, (_, i) => Number((i * ROW).toFixed(6)));
    return { times, positions: times.map(() => [...q]) };
  };
  const objects = Object.fromEntries(SCENE.objects.map((o) => [o.id, o]));
  const steps = REMOVED.map((id, index) => {
    const { radius, height } = objects[id].cylinder;
    const [x, y, z] = objects[id].position;
    const closed = Number((0.05 - radius).toFixed(6));
    const yaw = id === 'o8' ? 0.1 : 0;
    const [cx, cy] = [Math.cos(yaw), Math.sin(yaw)];
    const out = 0.52;
    const [slotX, slotY] = SLOTS[index];
    const placedZ = TRAY.position[2] + height / 2;
    const before = [x - 0.12 * cx, y - 0.12 * cy, z, yaw];
    const front = [out, y - (x - out) * Math.tan(yaw), z, yaw];
    const transit = follow([homeAt, front, before]);
    const approach = follow([before, [x, y, z, yaw]]);
    const moved = (rows, gripper, attached = null) => ({ ...rows, gripper: { finger_joint: gripper }, attached });
    const still = rest(0.4);
    const closing = still.times.map((t) => (closed * t) / 0.4);
    const inTool = multiply(invert(toolMatrix(q)), fromPose(objects[id]));
    const held = { object: id, tool: TOOL, pose_in_tool: poseOf(inTool) };
    const above = [slotX, slotY, placedZ + 0.14, -Math.PI / 2];
    const transfer = follow(
      [[x, y, z, yaw], [x, y, z + 0.03, yaw], [front[0], front[1], z + 0.03, yaw], above, [slotX, slotY, placedZ, -Math.PI / 2]], [3]);
    const release = rest(0.4);
    const retreat = follow([[slotX, slotY, placedZ, -Math.PI / 2], [slotX, slotY + 0.12, placedZ, -Math.PI / 2]]);
    const back = follow([[slotX, slotY + 0.12, placedZ, -Math.PI / 2], [slotX + 0.1, slotY + 0.2, placedZ + 0.2, -Math.PI / 2], homeAt], [2]);
    return {
      object: id,
      action: 'pick_place',
      segments: [
        { kind: 'transit', ...moved(transit, 0) },
        { kind: 'approach', ...moved(approach, 0) },
        { kind: 'grasp', ...moved(still, closing) },
        { kind: 'transfer', ...moved(transfer, closed, held) },
        { kind: 'release', ...moved(release, release.times.map((t) => closed * (1 - t / 0.4))) },
        { kind: 'retreat', ...moved(retreat, 0) },
        { kind: 'transit', ...moved(back, 0) },
      ],
      placed: poseOf(multiply(toolMatrix(transfer.positions.at(-1)), inTool)),
    };
  });
  return {
    format: 'clearway-plan/1',
    status: 'solved',
    seed: 1,
    scene: SCENE,
    robot: {
      urdf: URDF, joints: JOINTS, tool: TOOL, fixed: {},
      home: Object.fromEntries(JOINTS.map((name, i) => [name, home[i]])),
      limits: { velocity: Object.fromEntries(JOINTS.map((n) => [n, 2.1])), acceleration: Object.fromEntries(JOINTS.map((n) => [n, 8])) },
      hand: { kind: 'parallel', frame: TOOL, joint: 'finger_joint', opening: { '0.0': 0.1, '0.05': 0 },
        links: ['left_finger', 'right_finger', 'hand_base'], base_radius: 0.06, finger_thickness: 0.012 },
      unchecked_pairs: [], meshes: [],
    },
    removed: REMOVED,
    lower_bound: { removed: 2, kind: 'geometric', proof: null },
    steps,
    trace: sampleTrace(SCENE),
    timing: { total: 0.041, task: 0.006, motion: 0.035 },
    stats: { iterations: 2, exploration_limit: 3, roadmap_nodes: 0, retrieval_nodes: 0, samples: 900, sequences_tried: 2, grasps_tried: 214 },
    why: {
      summary: 'o8 and o3 go first: every way out of the shelf for o7 passes at least one of them, and the hand needs both gone.',
      objects: [
        { object: 'o8', order: 1, reason: 'stands before o3; the forearm meets it in every posture that reaches o3', blocked: ['o3', 'o7'], blocked_by: [],
          grasps: [{ outcome: 'taken', count: 1 }, { outcome: 'no posture', count: 31 }] },
        { object: 'o3', order: 2, reason: "the target's way out passes through it", blocked: ['o7'], blocked_by: [['o8']],
          grasps: [{ outcome: 'taken', count: 1 }, { outcome: 'forearm_link meets o8', count: 9 }, { outcome: 'left_finger meets o7', count: 5 }] },
        { object: 'o7', order: 3, reason: 'the target', blocked: [], blocked_by: [['o3', 'o8'], ['o3', 'o4', 'o12']],
          grasps: [{ outcome: 'taken', count: 1 }, { outcome: 'hand_base meets o3', count: 12 }, { outcome: 'wrist_3_link meets shelf_back', count: 20 }] },
      ],
    },
  };
}

const poseOf = (m) => ({ position: positionOf(m), quaternion: quaternionOf(m) });

/** The same scene without a plan: what a proof of impossibility looks like. */
export function impossiblePlan() {
  const { steps, trace, lower_bound, removed, ...rest } = samplePlan();
  return {
    ...rest,
    status: 'impossible',
    why: {
      summary: 'No grasp of o7 exists: the shelf stands in every one, even with all other objects gone.',
      objects: [{ object: 'o7', order: 0, reason: 'every grasp meets a fixture', blocked: [], blocked_by: [],
        grasps: [{ outcome: 'hand_base meets shelf_back', count: 41 }, { outcome: 'no posture', count: 31 }] }],
    },
  };
}

if (process.argv[1] && import.meta.url === pathToFileURL(process.argv[1]).href)
  console.log(JSON.stringify(process.argv.includes('--impossible') ? impossiblePlan() : samplePlan()));
