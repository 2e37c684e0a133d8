// The scene from above, drawn as a plan: footprints, the roadmap coloured by |Col|, the retrieval
// graph with the best path, the target's way out. Turned so that the robot is at the bottom.

function createTopView(canvas, plan, bodies, base, tip) {
  const context = canvas.getContext('2d');
  const scene = plan.scene;
  const roadmap = plan.trace?.roadmap ?? null;
  const graph = plan.trace?.retrieval_graph ?? null;
  const footprints = createFootprints();
  const ghosts = createFootprints();
  const layers = { roadmap: true, graph: false, path: true, robot: true };
  const backdrop = { canvas: document.createElement('canvas'), key: '' };
  let window_ = null;
  let last = null;

  const middle = scaled(add(bodies.extent.min, bodies.extent.max), 0.5);
  const toShelf = subtract(middle, base.position);
  const up = Math.abs(toShelf[0]) >= Math.abs(toShelf[1]) ? [Math.sign(toShelf[0]) || 1, 0] : [0, Math.sign(toShelf[1]) || 1];
  const right = [up[1], -up[0]];
  const along = (p) => [p[0] * right[0] + p[1] * right[1], p[0] * up[0] + p[1] * up[1]];

  function extentOf(whole) {
    const points = [bodies.extent.min, bodies.extent.max, ...(roadmap?.nodes ?? [])];
    if (scene.exit) points.push(scene.exit);
    if (scene.workspace) points.push(scene.workspace.min, scene.workspace.max);
    const inner = boundsOf(points.flatMap((p) => [p[0], p[1], 0]));
    for (const fixture of bodies.fixtures) {
      const close = [0, 1].every((k) => fixture.world.min[k] < inner.max[k] + 0.15 && fixture.world.max[k] > inner.min[k] - 0.15);
      if (whole || close) points.push(fixture.world.min, fixture.world.max);
    }
    if (whole) {
      points.push(base.position);
      for (const { position: p, size: s } of scene.place ?? []) points.push([p[0] - s[0] / 2, p[1] - s[1] / 2], [p[0] + s[0] / 2, p[1] + s[1] / 2]);
    }
    return boundsOf(points.map(along).flatMap(([x, y]) => [x, y, 0]));
  }

  function fit(whole) {
    const { min, max } = extentOf(whole);
    window_ = { centre: [(min[0] + max[0]) / 2, (min[1] + max[1]) / 2], width: (max[0] - min[0]) * 1.06 + 0.04, height: (max[1] - min[1]) * 1.06 + 0.04, zoom: 1 };
    backdrop.key = '';
  }
  fit(false);
  canvas.style.aspectRatio = clamp(window_.width / window_.height, 1, 1.7);

  const perMetre = () => Math.min(canvas.clientWidth / window_.width, canvas.clientHeight / window_.height) * window_.zoom;
  const toCanvas = (p) => {
    const [x, y] = along(p);
    return [canvas.clientWidth / 2 + (x - window_.centre[0]) * perMetre(), canvas.clientHeight / 2 - (y - window_.centre[1]) * perMetre()];
  };

  function trace(g, points, close = true) {
    g.beginPath();
    points.forEach((p, i) => (i ? g.lineTo(...toCanvas(p)) : g.moveTo(...toCanvas(p))));
    if (close) g.closePath();
  }

  function disc(g, p, radius) {
    g.beginPath();
    g.arc(...toCanvas(p), radius, 0, 2 * Math.PI);
  }

  function drawBackdrop(g, ink) {
    for (const fixture of bodies.fixtures.filter((f) => !f.above)) {
      trace(g, footprints(fixture, fixture.pose));
      g.fillStyle = fixture.solid ? ink(0.045) : ink(0.2);
      g.fill();
      g.strokeStyle = ink(0.22);
      g.lineWidth = 1;
      g.stroke();
    }
    g.setLineDash([4, 3]);
    g.strokeStyle = css(TARGET_COLOUR, 0.8);
    for (const { position: p, size: s } of scene.place ?? []) {
      trace(g, [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([x, y]) => [p[0] + (x * s[0]) / 2, p[1] + (y * s[1]) / 2]));
      g.stroke();
    }
    if (scene.workspace) {
      const { min, max } = scene.workspace;
      trace(g, [min, [max[0], min[1]], max, [min[0], max[1]]]);
      g.strokeStyle = ink(0.35);
      g.stroke();
    }
    g.setLineDash([]);
    if (layers.roadmap && roadmap) drawRoadmap(g, ink);
  }

  function drawRoadmap(g, ink) {
    g.strokeStyle = ink(clamp(90 / ((roadmap.edges?.length ?? 0) + 1), 0.035, 0.13));
    g.lineWidth = 0.7;
    g.beginPath();
    for (const [a, b] of roadmap.edges ?? []) {
      if (!roadmap.nodes[a] || !roadmap.nodes[b]) continue;
      g.moveTo(...toCanvas(roadmap.nodes[a]));
      g.lineTo(...toCanvas(roadmap.nodes[b]));
    }
    g.stroke();
    const size = clamp((0.13 * perMetre()) / Math.sqrt(roadmap.nodes.length + 1), 0.9, 2.6);
    roadmap.nodes.forEach((node, i) => {
      disc(g, node, size);
      g.fillStyle = css(collisionColour(roadmap.collisions?.[i]), 0.85);
      g.fill();
    });
  }

  function drawGraph(g, ink, paper) {
    g.lineWidth = 1;
    g.strokeStyle = ink(0.3);
    for (const [a, b] of graph.edges ?? []) {
      if (!graph.nodes[a] || !graph.nodes[b]) continue;
      trace(g, [graph.nodes[a].position, graph.nodes[b].position], false);
      g.stroke();
    }
    g.strokeStyle = css(LAST_REMOVED);
    g.lineWidth = 2.5;
    trace(g, (graph.path ?? []).map((i) => graph.nodes[i]?.position).filter(Boolean), false);
    g.stroke();
    graph.nodes.forEach((node, i) => {
      const r = graphRadius(node);
      if (node.blocks) {
        const [x, y] = toCanvas(node.position);
        g.beginPath();
        [[0, -r - 2], [r + 2, 0], [0, r + 2], [-r - 2, 0]].forEach(([dx, dy], k) => (k ? g.lineTo(x + dx, y + dy) : g.moveTo(x + dx, y + dy)));
        g.closePath();
      } else disc(g, node.position, r);
      g.fillStyle = css(collisionColour(node.collisions));
      g.fill();
      g.lineWidth = 1.5;
      g.strokeStyle = graph.path?.includes(i) ? css(LAST_REMOVED) : paper;
      g.stroke();
    });
    for (const [i, name] of [[0, 's'], [1, 'g']]) if (graph.nodes[i]) text(g, toCanvas(graph.nodes[i].position), name, '#fff', 10);
  }

  const graphRadius = (node) => clamp(4 + Math.sqrt(node.roadmap_nodes ?? 0) * 0.7, 5, 14);

  function text(g, [x, y], value, colour, size) {
    g.font = `600 ${size}px system-ui, sans-serif`;
    g.textAlign = 'center';
    g.textBaseline = 'middle';
    g.fillStyle = colour;
    g.fillText(value, x, y + 0.5);
  }

  function drawPath(g, ink, state) {
    const points = (roadmap?.path ?? []).map((i) => roadmap.nodes[i]).filter(Boolean);
    if (points.length > 1) {
      g.lineWidth = 2;
      g.strokeStyle = css(TARGET_COLOUR);
      g.lineJoin = 'round';
      trace(g, points, false);
      g.stroke();
    }
    const exit = scene.exit ?? roadmap?.nodes?.[0];
    if (exit) {
      const [x, y] = toCanvas(exit);
      g.beginPath();
      g.moveTo(x - 4, y - 4); g.lineTo(x + 4, y + 4); g.moveTo(x + 4, y - 4); g.lineTo(x - 4, y + 4);
      g.lineWidth = 1.8;
      g.strokeStyle = css(TARGET_COLOUR);
      g.stroke();
    }
    const target = state.objects.get(scene.target);
    if (roadmap?.footprint_radius && target) {
      disc(g, target.pose.position, roadmap.footprint_radius * perMetre());
      g.setLineDash([3, 3]);
      g.lineWidth = 1.2;
      g.strokeStyle = css(TARGET_COLOUR, 0.9);
      g.stroke();
      g.setLineDash([]);
    }
  }

  function drawObjects(g, ink, theme, state) {
    for (const object of bodies.objects) {
      const { pose, state: how } = state.objects.get(object.id);
      if (how !== 'standing') {
        trace(g, ghosts(object, object.pose));
        g.setLineDash([2, 3]);
        g.lineWidth = 1;
        g.strokeStyle = css(object.colour ?? theme.other, 0.9);
        g.stroke();
        g.setLineDash([]);
      }
      trace(g, footprints(object, pose));
      const known = object.seenFrom <= Math.max(state.stepIndex, 0);
      g.fillStyle = css(object.colour ?? theme.other, known ? (object.colour ? 0.92 : 0.85) : 0.15);
      g.fill();
      g.lineWidth = 1;
      g.strokeStyle = ink(0.45);
      g.stroke();
      const reach = (perMetre() * (object.bounds.max[0] - object.bounds.min[0])) / 2;
      const mark = object.order ? String(object.order) : reach > 9 ? object.id : '';
      if (mark) text(g, toCanvas(pose.position), mark, object.colour ? '#fff' : 'rgb(40 40 40 / 0.85)', clamp(reach * (object.order ? 0.95 : 0.62), 8, 13));
    }
  }

  function drawRobot(g, ink, state) {
    const points = state.chain.map((name) => state.links[name]?.position).filter(Boolean);
    if (points.length < 2) return;
    g.lineCap = 'round';
    g.lineJoin = 'round';
    trace(g, points, false);
    g.lineWidth = 7;
    g.strokeStyle = ink(0.16);
    g.stroke();
    g.lineWidth = 1.5;
    g.strokeStyle = ink(0.7);
    g.stroke();
    for (const p of points) { disc(g, p, 2); g.fillStyle = ink(0.8); g.fill(); }
    g.lineCap = 'butt';
  }

  function draw(state, themeName) {
    last = { state, themeName };
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    const [width, height] = [Math.round(canvas.clientWidth * ratio), Math.round(canvas.clientHeight * ratio)];
    if (width === 0 || height === 0) return;
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    const ink = (alpha) => (themeName === 'dark' ? `rgb(235 240 245 / ${alpha})` : `rgb(25 30 38 / ${alpha})`);
    const paper = themeName === 'dark' ? '#1a1d21' : '#ffffff';
    const key = [width, height, themeName, layers.roadmap, window_.zoom, ...window_.centre].join();
    if (backdrop.key !== key) {
      backdrop.key = key;
      [backdrop.canvas.width, backdrop.canvas.height] = [width, height];
      const g = backdrop.canvas.getContext('2d');
      g.scale(ratio, ratio);
      drawBackdrop(g, ink);
    }
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, width, height);
    context.drawImage(backdrop.canvas, 0, 0);
    context.scale(ratio, ratio);
    drawObjects(context, ink, THEMES[themeName], state);
    if (layers.graph && graph) drawGraph(context, ink, paper);
    if (layers.path) drawPath(context, ink, state);
    if (layers.robot) drawRobot(context, ink, state);
  }

  const redraw = () => last && draw(last.state, last.themeName);

  /** What is under the pointer, in words; null for nothing. */
  function wordsAt(x, y) {
    const near = (p, r) => { const [a, b] = toCanvas(p); return Math.hypot(a - x, b - y) <= r; };
    if (layers.graph && graph) {
      const node = graph.nodes.find((n) => near(n.position, graphRadius(n) + 2));
      if (node?.blocks) return `${node.blocks} could not be taken: ${setText(node.collisions)} in the way`;
      if (node) return `NodeCol ${setText(node.collisions)} · ${plural(node.roadmap_nodes, 'sample')}`;
    }
    const object = last && bodies.objects.find((o) => near(last.state.objects.get(o.id).pose.position, Math.max(7, (perMetre() * (o.bounds.max[0] - o.bounds.min[0])) / 2)));
    if (object) return `${object.id} · ${object.target ? 'the target' : object.order ? `${onlyPushed(plan, object.id) ? 'pushed aside' : 'removed'} ${object.order}.` : 'stays'}`;
    if (layers.roadmap && roadmap) {
      const i = roadmap.nodes.findIndex((n) => near(n, 4));
      if (i >= 0) return `Col ${setText(roadmap.collisions?.[i] ?? [])}`;
    }
    return null;
  }

  followPointer(canvas, {
    words: wordsAt, tip,
    shift: (dx, dy) => { window_.centre = [window_.centre[0] - dx / perMetre(), window_.centre[1] + dy / perMetre()]; redraw(); },
    zoom: (factor) => { window_.zoom = clamp(window_.zoom * factor, 0.3, 20); redraw(); },
  });

  return { draw, layers, redraw, fit: (whole) => { fit(whole); redraw(); }, hasRoadmap: Boolean(roadmap?.nodes?.length), hasGraph: Boolean(graph?.nodes?.length) };
}

/** Outlines on the ground of bodies, each remembered at the pose it was last asked for. */
function createFootprints() {
  const known = new Map();
  return (body, pose) => {
    const key = [...pose.position, ...pose.quaternion].map((v) => v.toFixed(4)).join();
    if (known.get(body)?.key !== key) {
      const source = body.batch.positions.length ? body.batch.positions : body.points.flatMap((c) => c.vertices.flat());
      const points = [];
      for (let i = 0; i < source.length; i += 3) points.push(add(pose.position, quatRotate(pose.quaternion, source.slice(i, i + 3))));
      known.set(body, { key, hull: convexHull(points) });
    }
    return known.get(body).hull;
  };
}

/** Andrew's monotone chain, in x and y. */
function convexHull(points) {
  const sorted = points.map((p) => [p[0], p[1]]).sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const turn = (a, b, c) => (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
  const half = (list) => {
    const chain = [];
    for (const p of list) {
      while (chain.length > 1 && turn(chain.at(-2), chain.at(-1), p) <= 1e-12) chain.pop();
      chain.push(p);
    }
    return chain.slice(0, -1);
  };
  return [...half(sorted), ...half(sorted.reverse())];
}

/** Drag shifts, wheel zooms, hovering says what is there. */
function followPointer(canvas, { words, tip, shift, zoom }) {
  let held = null;
  canvas.addEventListener('pointerdown', (event) => { held = event; canvas.setPointerCapture(event.pointerId); });
  canvas.addEventListener('pointermove', (event) => {
    if (held) {
      shift(event.clientX - held.clientX, event.clientY - held.clientY);
      held = event;
    }
    const box = canvas.getBoundingClientRect();
    const said = words(event.clientX - box.left, event.clientY - box.top);
    tip.hidden = !said;
    if (said) {
      tip.textContent = said;
      tip.style.transform = `translate(${event.clientX - box.left}px, ${event.clientY - box.top - 10}px) translate(-50%, -100%)`;
    }
  });
  canvas.addEventListener('pointerleave', () => { tip.hidden = true; });
  for (const end of ['pointerup', 'pointercancel']) canvas.addEventListener(end, () => { held = null; });
  canvas.addEventListener('wheel', (event) => { event.preventDefault(); zoom(Math.exp(-clamp(event.deltaY, -120, 120) * 0.0014)); }, { passive: false });
}
