// The words beside the picture: verdict, steps, reasons, figures. Built from DOM nodes only, so
// that no name from a plan is ever read as HTML.

function element(tag, className, ...content) {
  const node = document.createElement(tag);
  if (className) node.className = className;
  node.append(...content.filter((c) => c !== null && c !== undefined));
  return node;
}

const byId = (id) => document.getElementById(id);

function swatch(colour, text = '') {
  const node = element('span', 'swatch', text);
  if (colour) node.style.setProperty('--mark', css(colour));
  return node;
}

/** Text that goes to a time when it is clicked; plain where there is none. */
function timeLink(text, time, go) {
  if (time === null) return element('span', '', text);
  const node = element('button', 'to-time', text);
  node.addEventListener('click', () => go(time));
  return node;
}

function showSummary(plan, timeline, go) {
  const [word, tone] = STATUS[plan.status] ?? [String(plan.status ?? 'unknown'), 'warn'];
  byId('name').textContent = plan.scene.name || 'Plan';
  byId('status').textContent = word;
  byId('status').className = `chip ${tone}`;
  const facts = [removalText(plan)];
  if (plan.timing?.total > 0) facts.push(`planned in ${seconds(plan.timing.total)}`);
  if (timeline.duration > 0) facts.push(`motion ${seconds(timeline.duration)}`);
  byId('facts').replaceChildren(...facts.map((f) => element('span', '', f)));
  const room = clearanceWords(plan);
  if (!room) return;
  const link = timeLink(room.short, room.time, go);
  link.title = room.whole;
  byId('facts').append(link);
}

/** The list of steps, each with its segments; a click goes to where one begins. */
function showSteps(plan, timeline, colours, go) {
  const rows = [];
  const list = byId('steps');
  for (const [stepIndex, step] of (plan.steps ?? []).entries()) {
    const segments = timeline.segments.filter((s) => s.stepIndex === stepIndex);
    const { colour, order } = colours.get(step.object) ?? {};
    const length = segments.length ? segments.at(-1).end - segments[0].start : 0;
    const known = plan.known?.find((k) => k.step === stepIndex);
    const looking = known && known.taking !== plan.scene.target;
    const verb = step.action === 'push' ? `push ${pushedBy(step)}` : plan.goal ? destination(plan, step) : step.object === plan.scene.target ? 'take out, the target' : looking ? `take out, to look behind ${known.taking === step.object ? 'it' : known.taking}` : 'take out';
    const head = element('button', 'step-head',
      swatch(colour, order ? String(order) : ''), element('span', 'step-name', step.object), element('span', 'quiet', verb), element('span', 'quiet time', seconds(length)));
    head.addEventListener('click', () => go(segments[0]?.start ?? 0));
    const chips = element('div', 'segments', ...segments.map((segment) => {
      const chip = element('button', 'segment', segment.kind);
      chip.title = `${doing(plan, segment)}, ${seconds(segment.end - segment.start)}`;
      chip.addEventListener('click', () => go(segment.start));
      rows.push({ segment, node: chip });
      return chip;
    }));
    const seen = known && element('div', 'quiet', `${known.seen.length} objects seen${known.new?.length ? `, ${known.new.join(', ')} just now` : ''}`);
    const item = element('li', '', head, seen, chips);
    rows.push({ stepIndex, node: item });
    list.append(item);
  }
  byId('steps-card').hidden = rows.length === 0;
  return (current) => {
    for (const row of rows) row.node.classList.toggle('now', row.segment ? row.segment === current : row.stepIndex === current?.stepIndex);
  };
}

function showWhy(plan, colours) {
  const why = plan.why ?? {};
  const box = byId('why');
  if (why.summary) box.append(element('p', 'verdict', why.summary));
  for (const object of why.objects ?? []) {
    const { colour, order } = colours.get(object.object) ?? {};
    const details = element('div', 'reason',
      element('h3', '', swatch(colour, order ? String(order) : ''), object.object),
      object.reason ? element('p', '', object.reason) : null);
    const line = (term, text) => details.append(element('p', 'quiet', element('b', '', term), ` ${text}`));
    if (object.blocked?.length) line('stood in the way of', object.blocked.join(', '));
    if (object.blocked_by?.length) line('needs gone', object.blocked_by.map(setText).join(' or '));
    if (object.push) details.append(element('p', 'quiet', object.push));
    if (object.grasps?.length) {
      const most = Math.max(...object.grasps.map((g) => g.count));
      details.append(element('ul', 'grasps', ...object.grasps.map((g) => {
        const bar = element('li', '', element('span', '', g.outcome), element('span', 'count', String(g.count)));
        bar.style.setProperty('--share', most > 0 ? g.count / most : 0);
        return bar;
      })));
    }
    box.append(details);
  }
  byId('why-card').hidden = box.childElementCount === 0;
}

function showFigures(plan, notes, go) {
  const { timing = {}, stats = {}, lower_bound: bound } = plan;
  const room = clearanceWords(plan);
  const rows = [
    ['Clearance', room && timeLink(room.whole, room.time, go)],
    ['Planning', timing.total > 0 ? `${seconds(timing.total)} (task ${seconds(timing.task)}, motion ${seconds(timing.motion)})` : null],
    ['Lower bound', bound ? `${bound.removed}, ${bound.kind}` : null],
    ['Rounds', stats.iterations || null],
    ['Exploration limit', stats.exploration_limit || null],
    ['Roadmap', stats.roadmap_nodes ? plural(stats.roadmap_nodes, 'node') : null],
    ['Retrieval graph', stats.retrieval_nodes ? plural(stats.retrieval_nodes, 'node') : null],
    ['Sequences tried', stats.sequences_tried || null],
    ['Grasps tried', stats.grasps_tried || null],
    ['Robot', plan.scene.robot?.model],
    ['Objects', plan.scene.objects?.length],
    ['Seed', plan.seed],
  ].filter(([, value]) => value !== null && value !== undefined);
  byId('figures').append(...rows.flatMap(([term, value]) => [element('dt', '', term), element('dd', '', value instanceof Node ? value : String(value))]));
  byId('notes').append(...notes.map((note) => element('p', 'note', note)));
}

/** The bands under the time slider: a block per step, a stripe per segment. */
function showBands(plan, timeline, colours) {
  const track = byId('bands');
  if (timeline.duration <= 0) return;
  const place = (node, from, to) => {
    node.style.left = `${(100 * from) / timeline.duration}%`;
    node.style.width = `${(100 * (to - from)) / timeline.duration}%`;
    return node;
  };
  for (const segment of timeline.segments) {
    const band = element('i', `band ${segment.attached || segment.kind === 'push' ? 'held' : segment.kind}`);
    const colour = colours.get(segment.step.object)?.colour;
    if (colour) band.style.setProperty('--mark', css(colour));
    track.append(place(band, segment.start, segment.end));
  }
  for (const [stepIndex, step] of plan.steps.entries()) {
    const own = timeline.segments.filter((s) => s.stepIndex === stepIndex);
    if (own.length === 0) continue;
    track.append(place(element('span', 'step-band', element('em', '', step.object)), own[0].start, own.at(-1).end));
  }
}
