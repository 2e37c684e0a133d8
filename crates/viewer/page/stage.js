// The scene in three dimensions: which items the renderer gets at each instant, and in what manner.

function createStage(canvas, plan, bodies, base, changed) {
  const renderer = createRenderer(canvas);
  if (!renderer) return null;
  const scene = plan.scene;
  const upload = (batch) => renderer.upload(batch);
  for (const body of [...bodies.fixtures, ...bodies.objects, ...bodies.links]) {
    body.drawable = upload(body.batch);
    for (const cloud of body.points ?? []) cloud.uploaded = renderer.uploadPoints(cloud.vertices.flat());
  }
  const places = (scene.place ?? []).map((area) => {
    const [x, y] = area.size.map((v) => v / 2);
    const sheet = batchOf([{ kind: 'box', size: [2 * x, 2 * y, 0.0004], pose: IDENTITY, colour: null }], new Map());
    sheet.edges = dashed([[-x, -y, 0], [x, -y, 0], [x, y, 0], [-x, y, 0], [-x, -y, 0]]);
    return { drawable: upload(sheet), pose: { position: add(area.position, [0, 0, 0.0012]), quaternion: IDENTITY.quaternion } };
  });
  const eyes = scene.camera ? upload({ edges: frustumEdges(scene.camera) }) : null;
  let paths = [];

  const around = stageBounds(bodies, scene, base);
  const camera = createCamera(canvas, startingView(bodies, scene, base, around), changed);
  const light = stageLight(bodies, base, around);

  /** Ways of the tool, one list of points per segment; `held` ones are drawn stronger. */
  function setPaths(list) {
    paths = list.map(({ points, ...rest }) => ({ ...rest, drawable: upload({ edges: strip(points) }) }));
  }

  function items(state, theme) {
    const list = [];
    const eye = camera.eye();
    const edge = (alpha) => [...theme.edge, theme.edgeAlpha * alpha];
    const put = (drawable, pose, rest) => list.push({ drawable, matrix: matrixFromPose(pose), centre: pose.position, alpha: 1, tint: [1, 1, 1], stroke: null, ...rest });

    for (const fixture of bodies.fixtures) {
      const centre = scaled(add(fixture.world.min, fixture.world.max), 0.5);
      let [alpha, stroke, tint] = [1, edge(0.8), theme.fixture];
      if (!fixture.solid) {
        const towards = dot(fixture.outward, normalized(subtract(eye, centre)));
        const far = 1 - smoothstep(-0.12, 0.18, towards);
        [alpha, stroke, tint] = [mix(0.05, 0.5, far), edge(mix(0.45, 0.8, far)), theme.wall];
      }
      put(fixture.drawable, fixture.pose, { alpha, stroke, tint, centre });
    }
    for (const object of bodies.objects) {
      const { pose, state: how } = state.objects.get(object.id);
      // What the camera has not seen yet is hardly there.
      const known = object.seenFrom <= Math.max(state.stepIndex, 0);
      put(object.drawable, pose, { tint: object.colour ?? theme.other, stroke: edge(known ? 1 : 0.35), alpha: known ? 1 : 0.12 });
      if (how !== 'standing') {
        put({ edges: object.drawable.edges, edgeCount: object.drawable.edgeCount }, object.pose, { stroke: [...(object.colour ?? theme.other), 0.55], alpha: 0 });
      }
    }
    for (const link of bodies.links) {
      const pose = state.links[link.name];
      if (pose) put(link.drawable, pose, { tint: theme.robot, stroke: edge(0.75) });
    }
    for (const place of places) put(place.drawable, place.pose, { tint: TARGET_COLOUR, alpha: theme.place, stroke: [...TARGET_COLOUR, 0.75] });
    if (eyes) put(eyes, IDENTITY, { stroke: [...TARGET_COLOUR, 0.6] });
    if (state.showPath) {
      for (const path of paths) {
        if (path.stepIndex !== state.stepIndex) continue;
        put(path.drawable, IDENTITY, { alpha: 0, stroke: path.held ? [...path.colour, 0.9] : [...theme.edge.map((v) => mix(v, 0.5, 0.6)), 0.55] });
      }
    }
    return list;
  }

  function blobs(state) {
    return bodies.objects.filter((o) => !o.empty && state.objects.get(o.id).state !== 'held').map((object) => {
      const world = worldBounds([{ bounds: object.bounds, pose: state.objects.get(object.id).pose }]);
      const half = subtract(world.max, world.min).map((v) => v / 2);
      return { centre: [world.min[0] + half[0], world.min[1] + half[1], world.min[2] + 0.0015], radius: 1.4 * Math.max(half[0], half[1]), strength: 0.3 };
    });
  }

  function clouds(state, theme) {
    const posed = [
      ...bodies.fixtures.map((f) => [f, f.pose, theme.wall]),
      ...bodies.objects.map((o) => [o, state.objects.get(o.id).pose, o.colour ?? theme.other]),
    ];
    return posed.flatMap(([body, pose, tint]) => body.points.map((cloud) =>
      ({ ...cloud.uploaded, radius: cloud.radius, tint, matrix: matrixFromPose(compose(pose, cloud.pose)) })));
  }

  function draw(state, themeName) {
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    const [width, height] = [Math.max(1, Math.round(canvas.clientWidth * ratio)), Math.max(1, Math.round(canvas.clientHeight * ratio))];
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    const theme = THEMES[themeName];
    renderer.render({
      viewProjection: camera.viewProjection(), eye: camera.eye(), pixelsPerRadian: camera.pixelsPerRadian(),
      light: { ...light, sky: theme.sky, bounce: theme.bounce, sun: theme.sun },
      ground: { centre: around.centre, reach: around.radius * 3.2, stroke: theme.ground, shade: theme.shade },
      items: items(state, theme), blobs: blobs(state), clouds: clouds(state, theme),
    });
  }

  /** Where a world point is on the canvas, in CSS pixels; null behind the camera. */
  function onCanvas(point) {
    const p = project(camera.viewProjection(), point);
    if (p[3] <= 0) return null;
    return [(p[0] * 0.5 + 0.5) * canvas.clientWidth, (0.5 - p[1] * 0.5) * canvas.clientHeight];
  }

  return { draw, onCanvas, camera, setPaths, views: viewsOf(camera.home, bodies, base) };
}

/** Round what matters: objects, fixtures near them, places, the robot's foot. */
function stageBounds(bodies, scene, base) {
  const size = norm(subtract(bodies.extent.max, bodies.extent.min));
  const middle = scaled(add(bodies.extent.min, bodies.extent.max), 0.5);
  const near = bodies.fixtures.filter((f) => norm(subtract(f.world.max, f.world.min)) < 4 * size + 2 &&
    norm(subtract(scaled(add(f.world.min, f.world.max), 0.5), middle)) < 3 * size + 1).map((f) => f.world);
  const corners = [bodies.extent, ...near].flatMap((b) => [...b.min, ...b.max]);
  for (const area of scene.place ?? []) corners.push(...area.position);
  corners.push(...base.position, ...add(base.position, [0, 0, 0.9]));
  const { min, max } = boundsOf(corners);
  return { min, max, centre: scaled(add(min, max), 0.5), radius: norm(subtract(max, min)) / 2 };
}

/** From the robot’s side, turned towards the places, looking down into the shelf. */
function startingView(bodies, scene, base, around) {
  const middle = scaled(add(bodies.extent.min, bodies.extent.max), 0.5);
  const back = subtract(base.position, middle);
  const yawBack = Math.hypot(back[0], back[1]) > 0.05 ? Math.atan2(back[1], back[0]) : Math.PI;
  const place = scene.place?.[0]?.position;
  const side = place && cross(back, subtract(place, middle))[2] < 0 ? -1 : 1;
  // The shelf counts for more than the rest.
  const centre = around.centre.map((v, i) => mix(v, middle[i], 0.25));
  return { yaw: yawBack + side * 0.95, pitch: 0.46, distance: around.radius * 3.0, centre };
}

/** The named views, relative to where the robot stands. */
function viewsOf(home, bodies, base) {
  const middle = scaled(add(bodies.extent.min, bodies.extent.max), 0.5);
  const quarter = Math.PI / 2;
  const front = Math.round(Math.atan2(base.position[1] - middle[1], base.position[0] - middle[0]) / quarter) * quarter;
  return {
    home,
    front: { yaw: front, pitch: 0.12, centre: mixed(home.centre, middle, 0.25), distance: home.distance },
    side: { yaw: front + quarter, pitch: 0.12, centre: home.centre, distance: home.distance },
    top: { yaw: front, pitch: 1.56, centre: home.centre, distance: home.distance },
  };
}

const mixed = (a, b, s) => a.map((v, i) => mix(v, b[i], s));

function stageLight(bodies, base, around) {
  const middle = scaled(add(bodies.extent.min, bodies.extent.max), 0.5);
  const back = normalized([base.position[0] - middle[0], base.position[1] - middle[1], 0]);
  const left = [-back[1], back[0], 0];
  const toLight = normalized(add(add(scaled(back, 0.45), scaled(left, 0.4)), [0, 0, 1.25]));
  const reach = around.radius * 1.25 + 0.3;
  const view = lookAt(add(around.centre, scaled(toLight, reach * 2)), around.centre, [0, 0, 1]);
  return { toLight, matrix: matrixMultiply(orthographic(reach, reach, reach * 0.5, reach * 3.6), view) };
}

/** A polyline as separate lines. */
function strip(points) {
  const edges = [];
  for (let i = 0; i + 1 < points.length; i++) edges.push(...points[i], ...points[i + 1]);
  return edges;
}

function dashed(points, dash = 0.02) {
  const edges = [];
  for (let i = 0; i + 1 < points.length; i++) {
    const count = Math.max(1, Math.round(norm(subtract(points[i + 1], points[i])) / (2 * dash)));
    for (let k = 0; k < count; k++)
      edges.push(...mixed(points[i], points[i + 1], k / count), ...mixed(points[i], points[i + 1], (k + 0.55) / count));
  }
  return edges;
}

function frustumEdges({ position, look_at: lookAtPoint, fov }) {
  const forward = normalized(subtract(lookAtPoint, position));
  const right = normalized(cross(forward, Math.abs(forward[2]) > 0.99 ? [1, 0, 0] : [0, 0, 1]));
  const up = cross(right, forward);
  const [w, h, d] = [Math.tan(fov / 2) * 0.18, Math.tan(fov / 2) * 0.13, 0.18];
  const corners = [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([x, y]) =>
    add(position, add(scaled(forward, d), add(scaled(right, x * w), scaled(up, y * h)))));
  return [...strip([...corners, corners[0]]), ...corners.flatMap((c) => [...position, ...c])];
}
