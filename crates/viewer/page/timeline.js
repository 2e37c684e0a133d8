// The plan as one stretch of time: all segments end to end, what the joints and the gripper are at
// an instant, and where each object then is.

/** Segments in order, with plan-global `start` and `end` in seconds. */
function flattenSegments(plan) {
  const segments = [];
  const base = (plan.robot?.base_joints ?? []).map((name) => plan.robot.joints.indexOf(name));
  let clock = 0;
  (plan.steps ?? []).forEach((step, stepIndex) => {
    const list = step.segments ?? [];
    const firstHeld = list.findIndex((s) => s.attached);
    const lastMoved = list.findLastIndex((s) => (step.action === 'push' ? s.kind === 'push' : s.attached));
    list.forEach((segment, index) => {
      const rows = Math.min(segment.times?.length ?? 0, segment.positions?.length ?? 0);
      const length = rows > 0 ? Math.max(0, segment.times[rows - 1]) : 0;
      segments.push({
        ...segment, rows, step, stepIndex, index,
        start: clock, end: clock + length,
        drives: rows > 0 && base.some((c) => segment.positions[0][c] !== segment.positions[rows - 1][c]),
        released: lastMoved >= 0 && index > lastMoved,
        beforeHold: firstHeld < 0 || index < firstHeld,
      });
      clock += length;
    });
  });
  return { segments, duration: clock };
}

/** The segment that runs at `t`: the last one that has begun. */
function segmentAt(timeline, t) {
  const { segments } = timeline;
  let low = 0, high = segments.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (segments[middle].start <= t) low = middle; else high = middle - 1;
  }
  return segments[low] ?? null;
}

/** Row below `t` within the segment, and the fraction of the way to the next. */
function rowAt(segment, t) {
  const local = t - segment.start;
  let low = 0, high = segment.rows - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (segment.times[middle] <= local) low = middle; else high = middle - 1;
  }
  if (low >= segment.rows - 1) return { row: Math.max(0, segment.rows - 1), fraction: 0 };
  const span = segment.times[low + 1] - segment.times[low];
  return { row: low, fraction: span > 0 ? clamp((local - segment.times[low]) / span, 0, 1) : 0 };
}

/** Joint values at the start, before any motion: fixed, home, then the scene's own start. */
function startValues(plan) {
  const values = { ...plan.robot?.fixed, ...plan.robot?.home, ...plan.scene?.robot?.start };
  const first = plan.steps?.[0]?.segments?.[0];
  for (const [joint, value] of Object.entries(first?.gripper ?? {})) values[joint] = Array.isArray(value) ? value[0] : value;
  return values;
}

/** Joint values at `t`, before mimics. */
function valuesAt(plan, timeline, t) {
  const values = startValues(plan);
  const segment = segmentAt(timeline, t);
  if (!segment || segment.rows === 0) return values;
  const { row, fraction } = rowAt(segment, t);
  const between = (rows) => {
    const here = Array.isArray(rows) ? rows[Math.min(row, rows.length - 1)] : rows;
    const next = Array.isArray(rows) ? rows[Math.min(row + 1, rows.length - 1)] : rows;
    return fraction > 0 ? mix(here, next, fraction) : here;
  };
  const now = segment.positions[row];
  const next = segment.positions[Math.min(row + 1, segment.rows - 1)];
  (plan.robot?.joints ?? []).forEach((name, i) => { values[name] = mix(now[i], next[i], fraction); });
  for (const [joint, value] of Object.entries(segment.gripper ?? {})) values[joint] = between(value);
  return values;
}

/**
 * Where an object is at `t`: {pose, state}, the state one of `standing`, `held`, `pushed`,
 * `placed`. `poses` are the links' at `t`.
 */
function objectAt(plan, timeline, t, object, poses) {
  let pose = poseFromKeys(object);
  let state = 'standing';
  const current = segmentAt(timeline, t);
  for (const [stepIndex, step] of (plan.steps ?? []).entries()) {
    if (!current || stepIndex > current.stepIndex) break;
    const held = stepIndex === current.stepIndex ? current.attached : null;
    if (held?.object === object.id && poses[held.tool]) {
      return { pose: compose(poses[held.tool], poseFromKeys(held.pose_in_tool)), state: 'held' };
    }
    if (step.object !== object.id || !step.placed) continue;
    if (stepIndex < current.stepIndex || current.released) {
      pose = poseFromKeys(step.placed);
      state = 'placed';
    } else if (step.action === 'push') {
      const share = shareOfPush(timeline, t, stepIndex, poses[plan.robot?.tool]?.position);
      if (share > 0) {
        pose = poseBetween(pose, poseFromKeys(step.placed), share);
        state = share < 1 ? 'pushed' : 'placed';
      }
    }
  }
  return { pose, state };
}
