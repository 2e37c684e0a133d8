// A roadmap and a retrieval graph for the sample scene, in the manner of the planner's trace: nodes
// drawn at random in the workspace, clustered by the set of objects their disc overlaps.

function randomSource(seed) {
  let state = seed >>> 0;
  return () => {
    state = (state + 0x6d2b79f5) >>> 0;
    let t = Math.imul(state ^ (state >>> 15), 1 | state);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}

/** The cheapest path from node 0 to node 1 where entering a node costs `cost(node)`. */
function cheapest(count, edges, cost) {
  const next = Array.from({ length: count }, () => []);
  for (const [a, b] of edges) { next[a].push(b); next[b].push(a); }
  const distance = new Array(count).fill(Infinity), from = new Array(count).fill(-1), open = new Set([0]);
  distance[0] = 0;
  while (open.size > 0) {
    const node = [...open].reduce((a, b) => (distance[b] < distance[a] ? b : a));
    open.delete(node);
    for (const other of next[node]) {
      const d = distance[node] + cost(other, node);
      if (d < distance[other]) { distance[other] = d; from[other] = node; open.add(other); }
    }
  }
  const path = [1];
  while (path[0] !== 0 && from[path[0]] >= 0) path.unshift(from[path[0]]);
  return path;
}

export function sampleTrace(scene, count = 420) {
  const random = randomSource(7);
  const { min, max } = scene.workspace;
  const target = scene.objects.find((o) => o.id === scene.target);
  const footprint = 0.06;
  const nodes = [scene.exit, target.position.slice(0, 2)];
  while (nodes.length < count) nodes.push([0, 1].map((i) => Number((min[i] + random() * (max[i] - min[i])).toFixed(4))));
  const distance = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1]);
  const collisions = nodes.map((n) =>
    scene.objects.filter((o) => o.id !== scene.target && distance(n, o.position) < footprint + o.cylinder.radius).map((o) => o.id));
  const key = new Set();
  nodes.forEach((n, i) => {
    const near = nodes.map((m, j) => [distance(n, m), j]).sort((a, b) => a[0] - b[0]).slice(1, 6);
    for (const [, j] of near) key.add(`${Math.min(i, j)} ${Math.max(i, j)}`);
  });
  const edges = [...key].map((k) => k.split(' ').map(Number));
  const cost = (a, b) => collisions[a].length * 0.2 + distance(nodes[a], nodes[b]);
  const path = cheapest(nodes.length, edges, cost);

  // Clusters: connected nodes with the same collisions; n_s is 0 and n_g is 1.
  const cluster = nodes.map((_, i) => i);
  const root = (i) => (cluster[i] === i ? i : (cluster[i] = root(cluster[i])));
  for (const [a, b] of edges) if (collisions[a].join() === collisions[b].join()) {
    const [x, y] = [root(a), root(b)].sort((p, q) => p - q);
    cluster[y] = x;
  }
  const members = new Map();
  nodes.forEach((_, i) => members.set(root(i), [...(members.get(root(i)) ?? []), i]));
  const order = [...new Set([root(0), root(1), ...members.keys()])];
  const graphNodes = order.map((r) => {
    const group = members.get(r);
    const mean = [0, 1].map((k) => group.reduce((sum, i) => sum + nodes[i][k], 0) / group.length);
    return { collisions: collisions[r], roadmap_nodes: group.length, position: mean };
  });
  const graphKeys = new Set();
  for (const [a, b] of edges) {
    const [x, y] = [order.indexOf(root(a)), order.indexOf(root(b))].sort((p, q) => p - q);
    if (x !== y) graphKeys.add(`${x} ${y}`);
  }
  // One node as a failed feasibility check leaves it: o3 could not be taken while o8 stood.
  const blocker = scene.objects.find((o) => o.id === 'o8');
  graphNodes.push({ collisions: ['o8'], roadmap_nodes: 0, position: blocker.position.slice(0, 2), blocks: 'o3' });
  const graphEdges = [...graphKeys].map((k) => k.split(' ').map(Number));
  const graphPath = path.map((i) => order.indexOf(root(i))).filter((n, i, all) => n !== all[i - 1]);
  const passes = graphPath.findIndex((n) => graphNodes[n].collisions.includes('o3'));
  if (passes > 0) {
    graphEdges.push([graphPath[passes - 1], graphNodes.length - 1], [graphNodes.length - 1, graphPath[passes]]);
    graphPath.splice(passes, 0, graphNodes.length - 1);
  }
  return {
    roadmap: { footprint_radius: footprint, nodes, edges, collisions, path },
    retrieval_graph: { nodes: graphNodes, edges: graphEdges, path: graphPath },
  };
}
