// A plan with a push, made of another plan's robot and scene: the way in of one of its steps becomes
// the way of the pushing hand. Nothing here is checked for collisions.

import { fromPose, linkMatrices, positionOf, readJoints } from './fk.mjs';

const along = (direction, way) => direction.reduce((sum, v, i) => sum + v * way[i], 0);

/** Where the tool is at each row. */
function toolPositions({ robot, scene }, rows) {
  const joints = readJoints(robot.urdf);
  const base = fromPose(scene.robot.base ?? {});
  const named = (row) => Object.fromEntries(robot.joints.map((name, i) => [name, row[i]]));
  return rows.map((row) => positionOf(linkMatrices(joints, { ...robot.fixed, ...robot.home, ...named(row) }, base)[robot.tool]));
}

/**
 * {plan, ways}: one step that pushes its object, and how far the object has gone at each row of the
 * push. The hand goes a third of its way free; before the push is over it draws back, which leaves
 * the object where it is.
 */
export function pushingPlan(given) {
  const source = given.steps.find((step) => step.segments.some((s) => s.kind === 'approach' && s.times.length > 2));
  const { times, positions, gripper } = source.segments.find((s) => s.kind === 'approach' && s.times.length > 2);
  const back = [...positions].reverse();
  const end = times.at(-1);
  const tool = toolPositions(given, positions);
  const travel = [0, 1].map((i) => tool.at(-1)[i] - tool[0][i]);
  const length = Math.hypot(...travel);
  const direction = [travel[0] / length, travel[1] / length, 0];
  const [free, distance] = [length / 3, (2 * length) / 3];
  let furthest = 0;
  const going = tool.map((p) => {
    furthest = Math.max(furthest, along(direction, p.map((v, i) => v - tool[0][i])));
    return Math.min(distance, Math.max(0, furthest - free));
  });
  const object = given.scene.objects.find((o) => o.id === source.object);
  const stood = fromPose(object);
  const at = (way) => positionOf(stood).map((v, i) => v + way * direction[i]);
  const { known, goal, trace, ...rest } = given;
  const plan = {
    ...rest,
    removed: [object.id],
    steps: [{
      object: object.id,
      action: 'push',
      segments: [
        { kind: 'push', gripper, attached: null, times: [...times, ...times.slice(1).map((t) => end + t)], positions: [...positions, ...back.slice(1)] },
        { kind: 'retreat', gripper, attached: null, times, positions },
      ],
      placed: { position: at(distance), quaternion: object.quaternion ?? [0, 0, 0, 1] },
      push: { direction, distance, free, height: 0.05, tips_at: 0.1, margin_of_error: 0.005 },
    }],
    clearance: { asked: 0, up_to: 0.05, least: { distance: 0.00367, step: 0, segment: 0, time: end / 2, between: ['link right_finger', 'object o8'], at: [0, 0, 0] } },
    why: { summary: '', objects: [{ object: object.id, order: 1, reason: '', push: 'pushed aside, for it is the shorter way' }] },
  };
  return { plan, at, ways: [...going, ...going.slice(1).map(() => distance)] };
}
