// How far a pushed object has gone: with the hand, from where the hand met it.

const pushesOf = (timeline, stepIndex) =>
  timeline.segments.filter((s) => s.stepIndex === stepIndex && s.kind === 'push' && s.rows > 0);

/**
 * Notes with every segment that pushes where the tool began, and with each of its rows how far the
 * tool has come along the push by then. `toolAt(segment, row)` is a position, or null.
 */
function measurePushes(plan, timeline, toolAt) {
  for (const [stepIndex, { push }] of (plan.steps ?? []).entries()) {
    const pushes = pushesOf(timeline, stepIndex);
    const from = push && pushes.length > 0 ? toolAt(pushes[0], 0) : null;
    if (!from) continue;
    let furthest = 0;
    for (const segment of pushes) {
      segment.toolFrom = from;
      segment.toolWay = Array.from({ length: segment.rows }, (_, row) =>
        (furthest = Math.max(furthest, dot(push.direction, subtract(toolAt(segment, row), from)))));
    }
  }
}

/** How much of its way, from 0 to 1, the object of a step that pushes has gone at `t`, when the tool is at `tool`. */
function shareOfPush(timeline, t, stepIndex, tool) {
  const pushes = pushesOf(timeline, stepIndex);
  const segment = pushes.findLast((s) => s.start <= t);
  if (!segment) return 0;
  if (!segment.toolWay || !tool) return shareOfTime(pushes, t);
  const { direction, distance, free } = segment.step.push;
  const before = segment.toolWay[rowAt(segment, t).row];
  const now = t < segment.end ? dot(direction, subtract(tool, segment.toolFrom)) : before;
  return distance > 0 ? clamp((Math.max(before, now) - free) / distance, 0, 1) : 1;
}

/** The same in proportion to time, for a plan that says only where the push ends. */
function shareOfTime(pushes, t) {
  const length = pushes.reduce((sum, s) => sum + s.end - s.start, 0);
  const done = pushes.reduce((sum, s) => sum + clamp(t - s.start, 0, s.end - s.start), 0);
  return length > 0 ? done / length : 0;
}
