// Vectors [x, y, z], quaternions [x, y, z, w], poses {position, quaternion}, and column-major 4x4
// matrices as WebGL takes them. World: metres, right-handed, z up.

const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const subtract = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const scaled = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const norm = (a) => Math.hypot(a[0], a[1], a[2]);
const mix = (a, b, s) => a + (b - a) * s;
const clamp = (v, low, high) => Math.min(high, Math.max(low, v));
const smoothstep = (low, high, v) => {
  const s = clamp((v - low) / (high - low), 0, 1);
  return s * s * (3 - 2 * s);
};

function normalized(a) {
  const n = norm(a);
  return n > 0 ? scaled(a, 1 / n) : [0, 0, 1];
}

function quatMultiply(a, b) {
  return [
    a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1],
    a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
    a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3],
    a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2],
  ];
}

function quatRotate(q, v) {
  const u = [q[0], q[1], q[2]];
  const t = scaled(cross(u, v), 2);
  return add(add(v, scaled(t, q[3])), cross(u, t));
}

function quatFromAxisAngle(axis, angle) {
  const [x, y, z] = normalized(axis);
  const s = Math.sin(angle / 2);
  return [x * s, y * s, z * s, Math.cos(angle / 2)];
}

/** URDF's fixed axes: roll about x, then pitch about y, then yaw about z. */
function quatFromRpy([roll, pitch, yaw]) {
  return quatMultiply(
    quatFromAxisAngle([0, 0, 1], yaw),
    quatMultiply(quatFromAxisAngle([0, 1, 0], pitch), quatFromAxisAngle([1, 0, 0], roll)),
  );
}

function quatNormalized(q) {
  const n = Math.hypot(...q);
  return n > 0 ? q.map((v) => v / n) : [0, 0, 0, 1];
}

function quatSlerp(a, b, s) {
  let d = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
  const sign = d < 0 ? -1 : 1;
  d *= sign;
  if (d > 0.9995) return quatNormalized(a.map((v, i) => mix(v, sign * b[i], s)));
  const angle = Math.acos(d);
  const [wa, wb] = [Math.sin((1 - s) * angle), sign * Math.sin(s * angle)];
  return a.map((v, i) => (wa * v + wb * b[i]) / Math.sin(angle));
}

const IDENTITY = Object.freeze({ position: [0, 0, 0], quaternion: [0, 0, 0, 1] });

function compose(a, b) {
  return {
    position: add(a.position, quatRotate(a.quaternion, b.position)),
    quaternion: quatMultiply(a.quaternion, b.quaternion),
  };
}

/** From one pose to another: `s` of the straight way, and of the turn. */
function poseBetween(a, b, s) {
  return {
    position: a.position.map((v, i) => mix(v, b.position[i], s)),
    quaternion: quatSlerp(a.quaternion, b.quaternion, s),
  };
}

function invertPose(a) {
  const [x, y, z, w] = a.quaternion;
  const quaternion = [-x, -y, -z, w];
  return { position: scaled(quatRotate(quaternion, a.position), -1), quaternion };
}

/** A pose as files write it: position with `quaternion` or `rpy`. */
function poseFromKeys(keys) {
  if (!keys) return IDENTITY;
  return {
    position: keys.position ?? [0, 0, 0],
    quaternion: keys.quaternion ? quatNormalized(keys.quaternion) : quatFromRpy(keys.rpy ?? [0, 0, 0]),
  };
}

function matrixFromPose({ position: p, quaternion: [x, y, z, w] }) {
  return [
    1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w), 0,
    2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w), 0,
    2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y), 0,
    p[0], p[1], p[2], 1,
  ];
}

function matrixMultiply(a, b) {
  const out = new Array(16);
  for (let c = 0; c < 4; c++)
    for (let r = 0; r < 4; r++)
      out[4 * c + r] = a[r] * b[4 * c] + a[4 + r] * b[4 * c + 1] + a[8 + r] * b[4 * c + 2] + a[12 + r] * b[4 * c + 3];
  return out;
}

function perspective(verticalAngle, aspect, near, far) {
  const f = 1 / Math.tan(verticalAngle / 2);
  return [f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0, (2 * far * near) / (near - far), 0];
}

function orthographic(halfWidth, halfHeight, near, far) {
  return [1 / halfWidth, 0, 0, 0, 0, 1 / halfHeight, 0, 0, 0, 0, 2 / (near - far), 0, 0, 0, (far + near) / (near - far), 1];
}

/** The view from `eye` to `centre`; `up` must not be parallel to that. */
function lookAt(eye, centre, up) {
  const z = normalized(subtract(eye, centre));
  const x = normalized(cross(up, z));
  const y = cross(z, x);
  return [x[0], y[0], z[0], 0, x[1], y[1], z[1], 0, x[2], y[2], z[2], 0, -dot(x, eye), -dot(y, eye), -dot(z, eye), 1];
}

/** A point through a matrix, divided by w: [x, y, z, w]. */
function project(m, p) {
  const v = [0, 1, 2, 3].map((r) => m[r] * p[0] + m[4 + r] * p[1] + m[8 + r] * p[2] + m[12 + r]);
  return [v[0] / v[3], v[1] / v[3], v[2] / v[3], v[3]];
}
