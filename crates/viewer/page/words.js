// What happens, in words.

const plural = (count, one, many = `${one}s`) => `${count} ${count === 1 ? one : many}`;
const setText = (names) => `{${names.join(', ')}}`;

function seconds(value) {
  if (!Number.isFinite(value)) return '–';
  if (value < 1) return `${Number((value * 1000).toPrecision(3))} ms`;
  return `${value < 100 ? value.toFixed(1) : Math.round(value)} s`;
}

/** A length of some millimetres: two digits of a small one, a large one to the millimetre. */
function millimetres(metres) {
  const value = 1000 * metres;
  return `${Math.abs(value) < 10 ? Number(value.toPrecision(2)) : Math.round(value)} mm`;
}

/** How far a step pushes: “aside by 80 mm”. */
const pushedBy = ({ push }) => (push?.distance > 0 ? `aside by ${millimetres(push.distance)}` : 'aside');

/** Whether all that is done to an object is to push it. */
function onlyPushed(plan, id) {
  const own = (plan.steps ?? []).filter((step) => step.object === id);
  return own.length > 0 && own.every((step) => step.action === 'push');
}

/** The least room of the plan's motions, as {short, whole, time}; null if the plan does not say. */
function clearanceWords({ clearance }) {
  if (!clearance) return null;
  const { least, asked, up_to: upTo } = clearance;
  const wanted = asked > 0 ? `, ${millimetres(asked)} asked for` : '';
  if (!least) return upTo > 0 ? { short: `clearance above ${millimetres(upTo)}`, whole: `above ${millimetres(upTo)}${wanted}`, time: null } : null;
  const room = millimetres(least.distance);
  return { short: `clearance ${room}`, whole: `${room}: ${(least.between ?? []).join(', ')}, at ${least.time.toFixed(1)} s${wanted}`, time: least.time };
}

/** The place area under a position, or null. */
function placeUnder(plan, position) {
  return (plan.scene.place ?? []).find((area) =>
    [0, 1].every((i) => Math.abs(position[i] - area.position[i]) <= area.size[i] / 2 + 1e-6)) ?? null;
}

/** Where a step leaves its object: “to the tray”, “back to its place”, “aside”. */
function destination(plan, step) {
  const area = step.placed && placeUnder(plan, step.placed.position);
  if (area) return `to the ${area.id}`;
  const stood = plan.scene.objects.find((object) => object.id === step.object)?.position;
  const back = stood && step.placed && Math.hypot(...stood.map((v, i) => v - step.placed.position[i])) < 1e-3;
  return back ? 'back to its place' : 'aside';
}

/** What the robot does in a segment: “carrying o8 to the tray”. */
function doing(plan, segment) {
  const name = segment.step.object;
  const where = destination(plan, segment.step);
  if (segment.drives) return segment.attached ? `driving with ${name}` : `driving to where ${name} is in reach`;
  const pushes = segment.step.action === 'push';
  switch (segment.kind) {
    case 'transit': return segment.beforeHold && !segment.released ? `moving to ${name}` : 'moving away';
    case 'approach': return pushes ? `reaching round ${name}, to push it` : `reaching for ${name}`;
    case 'grasp': return `gripping ${name}`;
    case 'transfer': return `carrying ${name} ${where}`;
    case 'release': return `letting go of ${name}`;
    case 'retreat': return `drawing back from ${name}`;
    case 'push': return `pushing ${name} ${pushedBy(segment.step)}`;
    default: return segment.kind;
  }
}

const STATUS = {
  solved: ['Solved', 'good'],
  impossible: ['Impossible', 'bad'],
  out_of_budget: ['Budget spent', 'warn'],
};

/** “3 removed, at least 2 needed” – every count includes the target. */
function removalText(plan) {
  const removed = plan.removed?.length ?? 0;
  const bound = plan.lower_bound?.removed;
  if (plan.goal && removed) return `${removed} moved in ${plural(plan.steps.length, 'step')}`;
  if (removed === 0) return bound ? `at least ${bound} to remove` : 'no plan';
  if (!bound) return `${removed} removed`;
  return removed === bound ? `${removed} removed, proved fewest` : `${removed} removed, at least ${bound} needed`;
}
