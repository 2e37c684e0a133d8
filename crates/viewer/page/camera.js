// A camera that circles a point: drag turns, right drag or two fingers shift, wheel or pinch zooms.

const FIELD_OF_VIEW = 0.56;
const FAR_ASPECT = 1;

function createCamera(canvas, home, changed) {
  let view = { ...home };
  let glide = null;

  const eye = () => {
    const [cp, sp] = [Math.cos(view.pitch), Math.sin(view.pitch)];
    return add(view.centre, scaled([cp * Math.cos(view.yaw), cp * Math.sin(view.yaw), sp], view.distance));
  };
  // The view keeps what it shows: narrower windows stand further back.
  const aspect = () => canvas.clientWidth / Math.max(1, canvas.clientHeight);
  const verticalAngle = () => 2 * Math.atan(Math.tan(FIELD_OF_VIEW / 2) * Math.max(1, FAR_ASPECT / aspect()));

  function viewProjection() {
    const far = view.distance * 4 + 20;
    return matrixMultiply(perspective(verticalAngle(), aspect(), view.distance / 60, far), lookAt(eye(), view.centre, [0, 0, 1]));
  }

  function moveTo(next, instantly = false) {
    const turn = ((((next.yaw ?? view.yaw) - view.yaw + Math.PI) % (2 * Math.PI)) + 2 * Math.PI) % (2 * Math.PI) - Math.PI;
    const goal = { ...view, ...next, yaw: view.yaw + turn };
    glide = instantly ? null : { from: view, goal, since: performance.now() };
    if (instantly) view = goal;
    changed();
  }

  /** Moves a glide on; true while one is under way. */
  function advance(now) {
    if (!glide) return false;
    const share = clamp((now - glide.since) / 320, 0, 1);
    const s = smoothstep(0, 1, share);
    const { from, goal } = glide;
    view = {
      yaw: mix(from.yaw, goal.yaw, s), pitch: mix(from.pitch, goal.pitch, s), distance: mix(from.distance, goal.distance, s),
      centre: from.centre.map((v, i) => mix(v, goal.centre[i], s)),
    };
    if (share >= 1) glide = null;
    return true;
  }

  function turn(dx, dy) {
    glide = null;
    view = { ...view, yaw: view.yaw - dx * 0.006, pitch: clamp(view.pitch + dy * 0.006, -0.2, 1.5607) };
    changed();
  }

  function shift(dx, dy) {
    glide = null;
    const perPixel = (2 * view.distance * Math.tan(verticalAngle() / 2)) / canvas.clientHeight;
    const back = normalized(subtract(eye(), view.centre));
    const right = normalized(cross([0, 0, 1], back));
    const up = cross(back, right);
    view = { ...view, centre: add(view.centre, add(scaled(right, -dx * perPixel), scaled(up, dy * perPixel))) };
    changed();
  }

  function zoom(factor) {
    glide = null;
    view = { ...view, distance: clamp(view.distance * factor, home.distance * 0.08, home.distance * 5) };
    changed();
  }

  const fingers = new Map();
  canvas.addEventListener('pointerdown', (event) => {
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, event);
  });
  canvas.addEventListener('pointermove', (event) => {
    const before = fingers.get(event.pointerId);
    if (!before) return;
    const [dx, dy] = [event.clientX - before.clientX, event.clientY - before.clientY];
    if (fingers.size === 1) {
      const shifting = event.buttons & 6 || event.shiftKey || event.ctrlKey;
      shifting ? shift(dx, dy) : turn(dx, dy);
    } else {
      const other = [...fingers.values()].find((f) => f.pointerId !== event.pointerId);
      const apart = (a) => Math.hypot(a.clientX - other.clientX, a.clientY - other.clientY);
      zoom(apart(before) / Math.max(1, apart(event)));
      shift(dx / 2, dy / 2);
    }
    fingers.set(event.pointerId, event);
  });
  for (const end of ['pointerup', 'pointercancel']) canvas.addEventListener(end, (event) => fingers.delete(event.pointerId));
  canvas.addEventListener('wheel', (event) => {
    event.preventDefault();
    zoom(Math.exp(clamp(event.deltaY, -120, 120) * 0.0014));
  }, { passive: false });
  canvas.addEventListener('contextmenu', (event) => event.preventDefault());
  canvas.addEventListener('dblclick', () => moveTo(home));

  return {
    eye, viewProjection, moveTo, advance, zoom, home,
    dragging: () => fingers.size > 0,
    pixelsPerRadian: () => canvas.height / (2 * Math.tan(verticalAngle() / 2)),
  };
}
