// Triangles, normals and feature edges of the shapes that robots and scenes are made of. A shape is
// {kind, pose, size | radius, height | uri, scale, colour}; a batch collects many into one buffer.

const AROUND = 40;
const CREASE = Math.cos((32 * Math.PI) / 180);

/** The shapes of a scene's fixture or object, each with its pose in the body. */
function shapesOfBody(body) {
  const one = (keys, pose) => {
    if (keys.box) return [{ kind: 'box', pose, size: keys.box.size }];
    if (keys.cylinder) return [{ kind: 'cylinder', pose, ...keys.cylinder }];
    if (keys.sphere) return [{ kind: 'sphere', pose, ...keys.sphere }];
    if (keys.capsule) return [{ kind: 'capsule', pose, ...keys.capsule }];
    if (keys.points) return [{ kind: 'points', pose, uri: keys.points.file, radius: keys.points.radius }];
    if (keys.mesh) {
      const scale = keys.mesh.scale ?? 1;
      return [{ kind: 'mesh', pose, uri: keys.mesh.file, scale: Array.isArray(scale) ? scale : [scale, scale, scale] }];
    }
    return [];
  };
  if (body.compound) return body.compound.flatMap((part) => one(part, poseFromKeys(part)));
  return one(body, IDENTITY);
}

/** A surface of revolution about z from a profile of [radius, z, normal radius, normal z]. */
function revolved(profile) {
  const positions = [], normals = [], triangles = [];
  profile.forEach(([r, z, nr, nz]) => {
    for (let i = 0; i <= AROUND; i++) {
      const [c, s] = [Math.cos((2 * Math.PI * i) / AROUND), Math.sin((2 * Math.PI * i) / AROUND)];
      positions.push(r * c, r * s, z);
      normals.push(nr * c, nr * s, nz);
    }
  });
  const width = AROUND + 1;
  for (let k = 0; k + 1 < profile.length; k++) {
    if (profile[k].joinless) continue;
    for (let i = 0; i < AROUND; i++) {
      const a = k * width + i;
      triangles.push(a, a + 1, a + width, a + 1, a + width + 1, a + width);
    }
  }
  return { positions, normals, triangles, edges: [] };
}

function ring(radius, z) {
  const edges = [];
  for (let i = 0; i < AROUND; i++)
    for (const k of [i, i + 1]) edges.push(radius * Math.cos((2 * Math.PI * k) / AROUND), radius * Math.sin((2 * Math.PI * k) / AROUND), z);
  return edges;
}

function cylinderMesh({ radius, height }) {
  const h = height / 2;
  const seam = (row) => Object.assign(row, { joinless: true });
  const mesh = revolved([
    [0, -h, 0, -1], seam([radius, -h, 0, -1]), [radius, -h, 1, 0], seam([radius, h, 1, 0]), [radius, h, 0, 1], [0, h, 0, 1],
  ]);
  mesh.edges = [...ring(radius, -h), ...ring(radius, h)];
  return mesh;
}

/** A sphere, or with a `height` a capsule: that height is the cylindrical part's. */
function capsuleMesh({ radius, height = 0 }) {
  const profile = [];
  const arc = 12;
  for (const [from, z] of [[-Math.PI / 2, -height / 2], [0, height / 2]])
    for (let i = 0; i <= arc; i++) {
      const a = from + ((Math.PI / 2) * i) / arc;
      profile.push([radius * Math.cos(a), z + radius * Math.sin(a), Math.cos(a), Math.sin(a)]);
    }
  return revolved(profile);
}

function boxMesh({ size }) {
  const [x, y, z] = size.map((v) => v / 2);
  const mesh = { positions: [], normals: [], triangles: [], edges: [] };
  for (const axis of [0, 1, 2])
    for (const sign of [-1, 1]) {
      const base = mesh.positions.length / 3;
      const [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
      for (const [su, sv] of [[-1, -1], [1, -1], [1, 1], [-1, 1]]) {
        const p = [0, 0, 0], n = [0, 0, 0];
        p[axis] = sign; p[u] = su; p[v] = sv; n[axis] = sign;
        mesh.positions.push(p[0] * x, p[1] * y, p[2] * z);
        mesh.normals.push(...n);
      }
      const quad = sign > 0 ? [0, 1, 2, 0, 2, 3] : [0, 2, 1, 0, 3, 2];
      mesh.triangles.push(...quad.map((i) => base + i));
    }
  for (const axis of [0, 1, 2])
    for (const [su, sv] of [[-1, -1], [1, -1], [1, 1], [-1, 1]])
      for (const sign of [-1, 1]) {
        const p = [0, 0, 0];
        p[axis] = sign; p[(axis + 1) % 3] = su; p[(axis + 2) % 3] = sv;
        mesh.edges.push(p[0] * x, p[1] * y, p[2] * z);
      }
  return mesh;
}

/** Any triangles: normals smooth but at creases, feature edges where faces meet at an angle. */
function triangleMesh(vertices, faces, scale) {
  const points = vertices.map((v) => v.map((c, i) => c * scale[i]));
  const welded = new Map();
  const id = points.map((p) => {
    const key = p.map((c) => Math.round(c * 1e5)).join();
    if (!welded.has(key)) welded.set(key, welded.size);
    return welded.get(key);
  });
  const flip = scale[0] * scale[1] * scale[2] < 0;
  const areas = faces.map(([a, b, c]) => {
    const n = cross(subtract(points[b], points[a]), subtract(points[c], points[a]));
    return flip ? scaled(n, -1) : n;
  });
  const units = areas.map(normalized);
  const around = new Map();
  const sides = new Map();
  faces.forEach((face, f) => face.forEach((v, k) => {
    around.set(id[v], [...(around.get(id[v]) ?? []), f]);
    const w = face[(k + 1) % 3];
    const key = id[v] < id[w] ? `${id[v]} ${id[w]}` : `${id[w]} ${id[v]}`;
    const side = sides.get(key) ?? { ends: [v, w], faces: [] };
    side.faces.push(f);
    sides.set(key, side);
  }));
  const mesh = { positions: [], normals: [], triangles: [], edges: [] };
  faces.forEach((face, f) => face.forEach((v) => {
    let n = [0, 0, 0];
    for (const g of around.get(id[v])) if (dot(units[f], units[g]) > CREASE) n = add(n, areas[g]);
    mesh.triangles.push(mesh.positions.length / 3);
    mesh.positions.push(...points[v]);
    mesh.normals.push(...normalized(n));
  }));
  for (const { ends, faces: [a, b] } of sides.values())
    if (b === undefined || dot(units[a], units[b]) < CREASE) mesh.edges.push(...points[ends[0]], ...points[ends[1]]);
  return mesh;
}

/** Meshes are embedded as integers: coordinate = origin + step · integer. */
function unpackedMesh(packed) {
  const vertices = [];
  for (let i = 0; i < packed.vertices.length; i += 3)
    vertices.push([0, 1, 2].map((k) => packed.origin[k] + packed.step * packed.vertices[i + k]));
  const faces = [];
  for (let i = 0; i < packed.triangles.length; i += 3) faces.push(packed.triangles.slice(i, i + 3));
  return { vertices, faces };
}

function meshOf(shape, meshes) {
  switch (shape.kind) {
    case 'box': return boxMesh(shape);
    case 'cylinder': return cylinderMesh(shape);
    case 'sphere': case 'capsule': return capsuleMesh(shape);
    case 'mesh': {
      const known = meshes.get(shape.uri);
      return known ? triangleMesh(known.vertices, known.faces, shape.scale) : null;
    }
    default: return null;
  }
}

/** Many shapes in one buffer, in the frame of what they belong to. */
function batchOf(shapes, meshes, colour = [1, 1, 1]) {
  const batch = { positions: [], normals: [], colours: [], triangles: [], edges: [], missing: [] };
  for (const shape of shapes) {
    const mesh = meshOf(shape, meshes);
    if (!mesh) {
      if (shape.kind === 'mesh') batch.missing.push(shape.uri);
      continue;
    }
    const base = batch.positions.length / 3;
    for (let i = 0; i < mesh.positions.length; i += 3) {
      batch.positions.push(...add(shape.pose.position, quatRotate(shape.pose.quaternion, mesh.positions.slice(i, i + 3))));
      batch.normals.push(...quatRotate(shape.pose.quaternion, mesh.normals.slice(i, i + 3)));
      batch.colours.push(...(shape.colour ?? colour));
    }
    for (const index of mesh.triangles) batch.triangles.push(base + index);
    for (let i = 0; i < mesh.edges.length; i += 3)
      batch.edges.push(...add(shape.pose.position, quatRotate(shape.pose.quaternion, mesh.edges.slice(i, i + 3))));
  }
  return batch;
}

/** Lowest and highest corner of a list of coordinates. */
function boundsOf(positions) {
  const min = [Infinity, Infinity, Infinity], max = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < positions.length; i += 3)
    for (let k = 0; k < 3; k++) {
      min[k] = Math.min(min[k], positions[i + k]);
      max[k] = Math.max(max[k], positions[i + k]);
    }
  return { min, max };
}
