// Forward kinematics of a URDF with 4x4 matrices and a regular-expression reader. It shares no code
// with the page, which it is there to check. Knows fixed, revolute, continuous and prismatic
// joints, and <mimic>. Metres, radians; matrices are row-major arrays of 16.

const attribute = (text, name) => text?.match(new RegExp(`\\b${name}\\s*=\\s*["']([^"']*)["']`))?.[1];
const triple = (text, fallback) => (text ? text.trim().split(/\s+/).map(Number) : fallback);

export function readJoints(urdf) {
  const text = urdf.replace(/<!--[\s\S]*?-->/g, '').replace(/<(transmission|gazebo)\b[\s\S]*?<\/\1>/g, '');
  return [...text.matchAll(/<joint\b([^>]*[^/])>([\s\S]*?)<\/joint>/g)].map(([, head, body]) => {
    const tag = (name) => body.match(new RegExp(`<${name}\\b[^>]*>`))?.[0];
    const mimic = tag('mimic');
    return {
      name: attribute(head, 'name'),
      type: attribute(head, 'type'),
      parent: attribute(tag('parent'), 'link'),
      child: attribute(tag('child'), 'link'),
      xyz: triple(attribute(tag('origin'), 'xyz'), [0, 0, 0]),
      rpy: triple(attribute(tag('origin'), 'rpy'), [0, 0, 0]),
      axis: triple(attribute(tag('axis'), 'xyz'), [1, 0, 0]),
      mimic: mimic && {
        joint: attribute(mimic, 'joint'),
        multiplier: Number(attribute(mimic, 'multiplier') ?? 1),
        offset: Number(attribute(mimic, 'offset') ?? 0),
      },
    };
  });
}

export function multiply(a, b) {
  const out = new Array(16).fill(0);
  for (let r = 0; r < 4; r++)
    for (let c = 0; c < 4; c++) for (let k = 0; k < 4; k++) out[4 * r + c] += a[4 * r + k] * b[4 * k + c];
  return out;
}

export const translation = ([x, y, z]) => [1, 0, 0, x, 0, 1, 0, y, 0, 0, 1, z, 0, 0, 0, 1];

// Rodrigues' formula.
export function rotation(axis, angle) {
  const n = Math.hypot(...axis) || 1;
  const [x, y, z] = axis.map((v) => v / n);
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  const t = 1 - c;
  return [
    t * x * x + c, t * x * y - s * z, t * x * z + s * y, 0,
    t * x * y + s * z, t * y * y + c, t * y * z - s * x, 0,
    t * x * z - s * y, t * y * z + s * x, t * z * z + c, 0,
    0, 0, 0, 1,
  ];
}

export const fromRpy = ([r, p, y]) =>
  multiply(rotation([0, 0, 1], y), multiply(rotation([0, 1, 0], p), rotation([1, 0, 0], r)));

export function fromQuaternion([x, y, z, w]) {
  const half = Math.hypot(x, y, z);
  return rotation(half ? [x, y, z] : [0, 0, 1], 2 * Math.atan2(half, w));
}

/** A pose of the plan or scene file: position with `quaternion` or `rpy`. */
export const fromPose = ({ position = [0, 0, 0], quaternion, rpy }) =>
  multiply(translation(position), quaternion ? fromQuaternion(quaternion) : fromRpy(rpy ?? [0, 0, 0]));

export const positionOf = (m) => [m[3], m[7], m[11]];

/** Matrices of all links by name; `values` by joint name; `base` places the root link. */
export function linkMatrices(joints, values, base) {
  const value = (joint) =>
    joint.mimic
      ? joint.mimic.multiplier * value(joints.find((j) => j.name === joint.mimic.joint)) + joint.mimic.offset
      : (values[joint.name] ?? 0);
  const children = new Set(joints.map((j) => j.child));
  const links = {};
  for (const j of joints) if (!children.has(j.parent)) links[j.parent] = base;
  let waiting = joints;
  while (waiting.length > 0) {
    const later = [];
    for (const j of waiting) {
      if (!links[j.parent]) { later.push(j); continue; }
      let m = multiply(links[j.parent], multiply(translation(j.xyz), fromRpy(j.rpy)));
      if (j.type === 'revolute' || j.type === 'continuous') m = multiply(m, rotation(j.axis, value(j)));
      if (j.type === 'prismatic') m = multiply(m, translation(j.axis.map((a) => a * value(j))));
      links[j.child] = m;
    }
    if (later.length === waiting.length) throw new Error(`joints not connected to the root: ${later.map((j) => j.name)}`);
    waiting = later;
  }
  return links;
}

/** The inverse of a rigid motion. */
export function invert(m) {
  const t = [0, 1, 2].map((c) => -(m[c] * m[3] + m[4 + c] * m[7] + m[8 + c] * m[11]));
  return [m[0], m[4], m[8], t[0], m[1], m[5], m[9], t[1], m[2], m[6], m[10], t[2], 0, 0, 0, 1];
}

/** A rotation matrix as a quaternion `[x, y, z, w]`, by its largest component. */
export function quaternionOf(m) {
  const d = [m[0], m[5], m[10]];
  const candidates = [
    [1 + d[0] - d[1] - d[2], m[1] + m[4], m[8] + m[2], m[9] - m[6]],
    [m[1] + m[4], 1 - d[0] + d[1] - d[2], m[6] + m[9], m[2] - m[8]],
    [m[8] + m[2], m[6] + m[9], 1 - d[0] - d[1] + d[2], m[4] - m[1]],
    [m[9] - m[6], m[2] - m[8], m[4] - m[1], 1 + d[0] + d[1] + d[2]],
  ];
  const best = candidates.reduce((a, b, i) => (b[i] > candidates[a][a] ? i : a), 0);
  const q = candidates[best];
  return q.map((v) => v / Math.hypot(...q));
}

/** Angle of the rotation between two quaternions, whichever their signs. */
export const angleBetween = (a, b) => 2 * Math.acos(Math.min(1, Math.abs(a.reduce((sum, v, i) => sum + v * b[i], 0))));
