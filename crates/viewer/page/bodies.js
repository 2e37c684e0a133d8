// What is drawn, prepared once: fixtures with the way they are shown, objects, robot links, places.

/** All bodies of a plan as batches of triangles and edges in their own frames. */
function prepareBodies(plan, urdf, meshes) {
  const scene = plan.scene;
  const colours = removalColours(plan);
  const missing = new Set();
  const prepared = (body) => {
    const shapes = shapesOfBody(body);
    const batch = batchOf(shapes, meshes);
    batch.missing.forEach((uri) => missing.add(uri));
    const clouds = shapes.filter((s) => s.kind === 'points');
    clouds.filter((c) => !meshes.has(c.uri)).forEach((c) => missing.add(c.uri));
    const points = clouds.filter((c) => meshes.has(c.uri)).map((c) => ({ ...c, vertices: meshes.get(c.uri).vertices }));
    const corners = [...batch.positions, ...points.flatMap((c) => c.vertices.flat())];
    const bounds = corners.length ? boundsOf(corners) : { min: [0, 0, 0], max: [0, 0, 0] };
    return { id: body.id, pose: poseFromKeys(body), batch, points, bounds, empty: corners.length === 0 };
  };
  const objects = (scene.objects ?? []).map((body) => {
    const { colour = null, order = 0 } = colours.get(body.id) ?? {};
    return { ...prepared(body), keys: body, colour, order, target: body.id === scene.target, seenFrom: seenFrom(plan, body.id) };
  });
  const extent = worldBounds(objects.map((o) => ({ bounds: o.bounds, pose: o.pose })));
  const fixtures = (scene.fixtures ?? []).map((body) => {
    const fixture = prepared(body);
    const world = worldBounds([fixture]);
    return { ...fixture, world, ...fixtureManner(world, extent, objects.map((o) => worldBounds([o])), scene.place ?? []) };
  });
  const links = urdf ? prepareLinks(urdf, meshes, missing, plan.robot?.hand?.links ?? []) : [];
  return { objects, fixtures, links, extent, missing: [...missing] };
}

/** The step before which an object came into view; 0 where all is known. */
function seenFrom(plan, id) {
  if (!plan.known?.length) return 0;
  return plan.known.find((known) => known.seen?.includes(id))?.step ?? Infinity;
}

/** The box round posed bodies, in the world. */
function worldBounds(bodies) {
  const corners = [];
  for (const { bounds, pose } of bodies)
    for (let i = 0; i < 8; i++) {
      const corner = [0, 1, 2].map((k) => (i >> k & 1 ? bounds.max[k] : bounds.min[k]));
      corners.push(...add(pose.position, quatRotate(pose.quaternion, corner)));
    }
  return corners.length ? boundsOf(corners) : { min: [-0.5, -0.5, 0], max: [0.5, 0.5, 1] };
}

/**
 * How a fixture is shown. What carries (a floor, a table under a place) or stands apart is solid;
 * what stands beside or above objects is see-through, and `outward` says on which side of them.
 */
function fixtureManner(world, extent, objects, places) {
  const apart = (other) => Math.max(...[0, 1].map((k) => Math.max(world.min[k] - other.max[k], other.min[k] - world.max[k])));
  const over = objects.some((o) => apart(o) < 0 && o.max[2] <= world.min[2] + 0.002);
  const area = ({ position: p, size: s }) => ({ min: [p[0] - s[0] / 2, p[1] - s[1] / 2], max: [p[0] + s[0] / 2, p[1] + s[1] / 2] });
  const carries = objects.some((o) => apart(o) < 0 && Math.abs(world.max[2] - o.min[2]) < 0.003) ||
    places.some((place) => apart(area(place)) < 0 && Math.abs(world.max[2] - place.position[2]) < 0.005);
  const beside = objects.some((o) => apart(o) < 0.35 && o.min[2] < world.max[2] - 0.002);
  if (!over && (carries || !beside)) return { solid: true, above: false, outward: null };
  const size = subtract(world.max, world.min);
  const thin = size.indexOf(Math.min(...size));
  const outward = [0, 0, 0];
  const offset = (world.min[thin] + world.max[thin] - extent.min[thin] - extent.max[thin]) / 2;
  outward[thin] = offset >= 0 ? 1 : -1;
  return { solid: false, above: over || (thin === 2 && offset > 0), outward };
}

/**
 * One batch per link: its visual if that can be drawn, else its collision shapes, else bones from
 * its origin to its children, which show where a link is when its mesh is not in the page. The hand
 * is darker than the arm, unless the URDF has colours of its own.
 */
function prepareLinks(urdf, meshes, missing, hand) {
  const drawable = (shapes) => shapes.length > 0 && shapes.every((s) => s.kind !== 'mesh' || meshes.has(s.uri));
  return urdf.links.map((link) => {
    const hasShape = link.visuals.length + link.collisions.length > 0;
    let shapes = [link.visuals, link.collisions].find(drawable);
    if (!shapes && hasShape) {
      [...link.visuals, ...link.collisions].filter((s) => s.kind === 'mesh').forEach((s) => missing.add(s.uri));
      shapes = bonesOf(urdf, link.name);
    }
    const batch = batchOf(shapes ?? [], meshes, hand.includes(link.name) ? HAND_COLOUR : undefined);
    return { name: link.name, batch, bounds: batch.positions.length ? boundsOf(batch.positions) : null };
  });
}

function bonesOf(urdf, link) {
  const joint = { kind: 'sphere', pose: IDENTITY, radius: 0.045, colour: null };
  const bones = urdf.joints.filter((j) => j.parent === link).map(({ origin: { position } }) => {
    const length = norm(position);
    const axis = cross([0, 0, 1], position);
    const angle = Math.atan2(norm(axis), position[2]);
    const quaternion = norm(axis) > 1e-9 ? quatFromAxisAngle(axis, angle) : [0, 0, 0, 1];
    return { kind: 'capsule', radius: 0.032, height: length, pose: { position: scaled(position, 0.5), quaternion }, colour: null };
  });
  return [joint, ...bones];
}
