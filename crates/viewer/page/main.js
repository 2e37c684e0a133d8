// Puts the page together: reads the plan, builds the views, runs the clock.

function readEmbedded(id, fallback) {
  const text = byId(id)?.textContent;
  return text ? JSON.parse(text) : fallback;
}

/** Links from the root, or from a base that drives, to the tool: for the arm seen from above. */
function chainTo(tree, tool, baseJoints) {
  const chain = [];
  for (let link = tool; link && chain.length < 200;) {
    chain.unshift(link);
    const joint = tree.joints.find((j) => j.child === link);
    link = joint && !baseJoints.includes(joint.name) ? joint.parent : null;
  }
  return chain;
}

function start() {
  const plan = readEmbedded('plan', null);
  const meshes = new Map(readEmbedded('meshes', []).map((m) => [m.uri, unpackedMesh(m)]));
  const notes = [];
  let urdf = null;
  try {
    urdf = parseUrdf(plan.robot?.urdf);
  } catch (error) {
    notes.push(error.message);
  }
  const tree = urdf ? kinematicTree(urdf) : { roots: [], joints: [], byName: new Map() };
  const timeline = flattenSegments(plan);
  const base = poseFromKeys(plan.scene.robot?.base);
  const bodies = prepareBodies(plan, urdf, meshes);
  if (bodies.missing.length) notes.push(`Not in this page, and drawn in outline at most: ${bodies.missing.join(', ')}.`);
  const colours = removalColours(plan);
  const chain = chainTo(tree, plan.robot?.tool, plan.robot?.base_joints ?? []);

  measurePushes(plan, timeline, toolAt);

  let time = 0;
  let playing = false;
  let dirty = true;
  let lastFrame = 0;
  const options = { names: false, showPath: true };

  function stateAt(t) {
    const values = jointValues(tree, valuesAt(plan, timeline, t));
    const links = linkPoses(tree, values, base);
    const objects = new Map(bodies.objects.map((o) => [o.id, objectAt(plan, timeline, t, o.keys, links)]));
    const segment = segmentAt(timeline, t);
    return { t, values, links, objects, segment, stepIndex: segment?.stepIndex ?? -1, showPath: options.showPath, chain };
  }

  const canvas = byId('view');
  const invalidate = () => { dirty = true; };
  let stage = null;
  try {
    stage = createStage(canvas, plan, bodies, base, invalidate);
  } catch (error) {
    notes.push(`The 3D view could not start: ${error.message}`);
  }
  document.body.classList.toggle('no-stage', !stage);
  byId('no-gl').hidden = Boolean(stage);
  canvas.addEventListener('webglcontextlost', (event) => event.preventDefault());
  canvas.addEventListener('webglcontextrestored', () => window.location.reload());
  stage?.setPaths(toolPaths());
  const labels = createLabels(byId('labels'), bodies);
  const above = createTopView(byId('above'), plan, bodies, base, byId('above-tip'));

  /** Where the tool is at a row of a segment; null if the robot is not known. */
  function toolAt(segment, row) {
    const values = valuesAt(plan, { segments: [segment] }, segment.start + segment.times[row]);
    return linkPoses(tree, jointValues(tree, values), base)[plan.robot?.tool]?.position ?? null;
  }

  function toolPaths() {
    return timeline.segments.filter((s) => s.rows > 1).map((segment) => {
      const every = Math.max(1, Math.floor(segment.rows / 40));
      const points = [];
      for (let row = 0; row < segment.rows + every - 1; row += every) {
        const position = toolAt(segment, Math.min(row, segment.rows - 1));
        if (position) points.push(position);
      }
      return { points, stepIndex: segment.stepIndex, held: Boolean(segment.attached), colour: colours.get(segment.step.object)?.colour ?? TARGET_COLOUR };
    });
  }

  showSummary(plan, timeline, (t) => setTime(t));
  const markStep = showSteps(plan, timeline, colours, (t) => setTime(t));
  showWhy(plan, colours);
  showBands(plan, timeline, colours);
  showFigures(plan, notes, (t) => setTime(t));
  const controls = createControls({ timeline, stage, above, options, setTime, toggle, invalidate, jump });

  function draw() {
    dirty = false;
    const state = stateAt(time);
    const theme = currentTheme();
    if (stage) {
      stage.draw(state, theme);
      labels(stage, state, options.names);
    }
    above.draw(state, theme);
    markStep(state.segment);
    controls.show(plan, state, playing);
  }

  function setTime(t) {
    time = clamp(Number.isFinite(t) ? t : 0, 0, timeline.duration);
    draw();
  }

  function play() {
    if (timeline.duration <= 0 || playing) return;
    if (time >= timeline.duration) time = 0;
    playing = true;
    lastFrame = performance.now();
    invalidate();
  }

  function pause() {
    playing = false;
    invalidate();
  }

  function toggle() {
    playing ? pause() : play();
  }

  /** To the next (+1) or previous (−1) beginning of a segment. */
  function jump(direction) {
    const starts = [...timeline.segments.map((s) => s.start), timeline.duration];
    const next = direction > 0 ? starts.find((s) => s > time + 1e-6) : starts.findLast((s) => s < time - 0.05);
    if (next !== undefined) setTime(next);
  }

  function frame(now) {
    if (playing) {
      time += (Math.min(now - lastFrame, 250) / 1000) * controls.speed();
      lastFrame = now;
      if (time >= timeline.duration) {
        time = timeline.duration;
        playing = false;
      }
      dirty = true;
    }
    if (stage?.camera.advance(now)) dirty = true;
    if (dirty) draw();
    requestAnimationFrame(frame);
  }

  for (const box of [canvas, byId('above')]) new ResizeObserver(invalidate).observe(box);
  window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', invalidate);
  draw();
  requestAnimationFrame(frame);

  window.clearway = {
    get time() { return time; },
    get playing() { return playing; },
    get duration() { return timeline.duration; },
    setTime, play, pause,
    jointPositions: () => stateAt(time).values,
    linkPose: (name) => stateAt(time).links[name] ?? null,
    objectPose: (id) => stateAt(time).objects.get(id)?.pose ?? null,
    ready: true,
  };
}

start();
