// How far a pushed object has gone: with the hand, from where the hand met it.

/**
 * Notes with every row of a `push` segment how far the tool has come along the push by then, and
 * with the segment where the tool began. `toolAt(segment, row)` is a position, or null.
 */
function measurePushes(timeline, toolAt) {
  let before = null;
  for (const segment of timeline.segments) {
    const direction = segment.step.push?.direction;
    if (segment.kind !== 'push' || !direction || segment.rows === 0) continue;
    const same = before?.step === segment.step ? before : null;
    const from = same?.toolFrom ?? toolAt(segment, 0);
    if (!from) continue;
    let furthest = same?.toolWay.at(-1) ?? 0;
    segment.toolFrom = from;
    segment.toolWay = Array.from({ length: segment.rows }, (_, row) =>
      (furthest = Math.max(furthest, dot(direction, subtract(toolAt(segment, row), from)))));
    before = segment;
  }
}

/** How much of its way the object of a step that pushes has gone at `t`, from 0 to 1; `tool` is the tool's pose then. */
function shareOfPush(timeline, t, stepIndex, tool) {
  const pushes = timeline.segments.filter((s) => s.stepIndex === stepIndex && s.kind === 'push');
  const segment = pushes.findLast((s) => s.start <= t);
  if (!segment) return 0;
  if (!segment.toolWay || !tool) return shareOfTime(pushes, t);
  const { direction, distance, free = 0 } = segment.step.push;
  const now = dot(direction, subtract(tool.position, segment.toolFrom));
  const furthest = Math.max(segment.toolWay[rowAt(segment, t).row], t < segment.end ? now : 0);
  return distance > 0 ? clamp((furthest - free) / distance, 0, 1) : 1;
}

/** The same in proportion to the push's time, for a plan that says only where the push ends. */
function shareOfTime(pushes, t) {
  const length = pushes.reduce((sum, s) => sum + s.end - s.start, 0);
  const done = pushes.reduce((sum, s) => sum + clamp(t - s.start, 0, s.end - s.start), 0);
  return length > 0 ? done / length : 0;
}
