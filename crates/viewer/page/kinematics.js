// Where the links are: forward kinematics over the joint tree, parents before children.

const MOVING = new Set(['revolute', 'continuous', 'prismatic']);

/** The tree of `urdf`, in an order in which every parent comes before its children. */
function kinematicTree(urdf) {
  const children = new Set(urdf.joints.map((j) => j.child));
  const roots = urdf.links.map((l) => l.name).filter((name) => !children.has(name));
  const byParent = new Map();
  for (const joint of urdf.joints) byParent.set(joint.parent, [...(byParent.get(joint.parent) ?? []), joint]);
  const ordered = [];
  const waiting = [...roots];
  const seen = new Set(roots);
  while (waiting.length > 0) {
    for (const joint of byParent.get(waiting.shift()) ?? []) {
      if (seen.has(joint.child)) continue;
      seen.add(joint.child);
      ordered.push(joint);
      waiting.push(joint.child);
    }
  }
  return { roots, joints: ordered, byName: new Map(urdf.joints.map((j) => [j.name, j])) };
}

/** Every moving joint's value, mimics followed (a chain of at most eight). Missing ones are 0. */
function jointValues(tree, given) {
  const value = (joint, depth) => {
    const leader = joint.mimic && tree.byName.get(joint.mimic.joint);
    if (leader && depth < 8) return joint.mimic.multiplier * value(leader, depth + 1) + joint.mimic.offset;
    const known = given[joint.name];
    return Number.isFinite(known) ? known : 0;
  };
  const values = {};
  for (const joint of tree.joints) if (MOVING.has(joint.type)) values[joint.name] = value(joint, 0);
  return values;
}

/** World poses of all links by name; `base` is the pose of the root link. */
function linkPoses(tree, values, base) {
  const poses = {};
  for (const root of tree.roots) poses[root] = base;
  for (const joint of tree.joints) {
    let pose = compose(poses[joint.parent], joint.origin);
    if (joint.type === 'prismatic') {
      pose = compose(pose, { position: scaled(joint.axis, values[joint.name]), quaternion: IDENTITY.quaternion });
    } else if (MOVING.has(joint.type)) {
      pose = compose(pose, { position: [0, 0, 0], quaternion: quatFromAxisAngle(joint.axis, values[joint.name]) });
    }
    poses[joint.child] = pose;
  }
  return poses;
}
