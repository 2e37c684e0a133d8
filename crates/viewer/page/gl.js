// A small WebGL 2 renderer: solids with one light and its shadow, see-through bodies sorted from
// back to front, feature edges, contact shadows, the ground, point clouds.

const SHADOW_SIZE = 2048;

/** The renderer, or null where the browser offers no WebGL 2. */
function createRenderer(canvas) {
  const gl = canvas.getContext('webgl2', { antialias: true, alpha: true, premultipliedAlpha: true });
  if (!gl) return null;
  const programs = Object.fromEntries(Object.entries(SHADERS).map(([name, [vertex, fragment]]) => [name, linked(gl, vertex, fragment)]));
  const square = upload({ positions: [-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0], triangles: [0, 1, 2, 0, 2, 3], edges: [] });
  const shadow = shadowTarget(gl);

  /** Buffers for a batch: filled triangles, and edges as separate lines. */
  function upload(batch) {
    const fill = batch.triangles?.length ? vertexArray({ position: batch.positions, normal: batch.normals, colour: batch.colours }, batch.triangles) : null;
    const edges = batch.edges?.length ? vertexArray({ position: batch.edges }) : null;
    return {
      fill, fillCount: batch.triangles?.length ?? 0,
      edges, edgeCount: (batch.edges?.length ?? 0) / 3,
    };
  }

  function vertexArray(attributes, indices) {
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    for (const [name, values] of Object.entries(attributes)) {
      if (!values) continue;
      const location = LOCATIONS[name];
      gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(values), gl.STATIC_DRAW);
      gl.enableVertexAttribArray(location);
      gl.vertexAttribPointer(location, 3, gl.FLOAT, false, 0, 0);
    }
    if (indices) {
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, new Uint32Array(indices), gl.STATIC_DRAW);
    }
    gl.bindVertexArray(null);
    return array;
  }

  function use(name, uniforms) {
    const program = programs[name];
    gl.useProgram(program.handle);
    set(program, uniforms);
    return program;
  }

  function set(program, uniforms) {
    for (const [name, value] of Object.entries(uniforms)) {
      const location = program.uniforms[name];
      if (!location) continue;
      if (typeof value === 'number') name === 'shadowMap' ? gl.uniform1i(location, value) : gl.uniform1f(location, value);
      else if (value.length === 3) gl.uniform3fv(location, value);
      else if (value.length === 4) gl.uniform4fv(location, value);
      else gl.uniformMatrix4fv(location, false, value);
    }
  }

  function fill(item) {
    gl.bindVertexArray(item.drawable.fill);
    gl.drawElements(gl.TRIANGLES, item.drawable.fillCount, gl.UNSIGNED_INT, 0);
  }

  function drawShadows(items, lightMatrix) {
    gl.bindFramebuffer(gl.FRAMEBUFFER, shadow.framebuffer);
    gl.viewport(0, 0, SHADOW_SIZE, SHADOW_SIZE);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1.5, 2);
    const program = use('depth', { lightMatrix });
    for (const item of items) {
      if (!item.drawable.fill || item.alpha < 1) continue;
      set(program, { model: item.matrix });
      fill(item);
    }
    gl.disable(gl.POLYGON_OFFSET_FILL);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  }

  function drawSolids(items, frame, shared) {
    const program = use('solid', { ...shared, eye: frame.eye });
    for (const item of items) {
      if (!item.drawable.fill || item.alpha <= 0) continue;
      set(program, { model: item.matrix, tint: item.tint, alpha: item.alpha });
      fill(item);
    }
  }

  function drawEdges(items, viewProjection) {
    const program = use('line', { viewProjection, lift: 0.00002 });
    for (const item of items) {
      if (!item.drawable.edges || !item.stroke) continue;
      set(program, { model: item.matrix, stroke: item.stroke });
      gl.bindVertexArray(item.drawable.edges);
      gl.drawArrays(gl.LINES, 0, item.drawable.edgeCount);
    }
  }

  function drawBlobs(blobs, viewProjection) {
    const program = use('blob', { viewProjection });
    gl.bindVertexArray(square.fill);
    for (const blob of blobs) {
      set(program, { centre: blob.centre, reach: blob.radius, strength: blob.strength });
      gl.drawElements(gl.TRIANGLES, square.fillCount, gl.UNSIGNED_INT, 0);
    }
  }

  function drawPoints(clouds, frame) {
    const program = use('points', { viewProjection: frame.viewProjection, toLight: frame.light.toLight });
    for (const cloud of clouds) {
      set(program, { model: cloud.matrix, tint: cloud.tint, size: cloud.radius * frame.pixelsPerRadian * 2 });
      gl.bindVertexArray(cloud.array);
      gl.drawArrays(gl.POINTS, 0, cloud.count);
    }
  }

  /**
   * One picture. `frame`: viewProjection, eye, light {matrix, toLight, sky, bounce, sun}, ground
   * {centre, reach, stroke, shade}, items [{drawable, matrix, tint, alpha, stroke, centre}], blobs,
   * clouds, pixelsPerRadian.
   */
  function render(frame) {
    const { viewProjection, light } = frame;
    gl.enable(gl.DEPTH_TEST);
    gl.disable(gl.BLEND);
    gl.depthMask(true);
    drawShadows(frame.items, light.matrix);

    gl.viewport(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, shadow.texture);
    const shared = {
      viewProjection, lightMatrix: light.matrix, shadowMap: 0, shadowTexel: 1 / SHADOW_SIZE,
      toLight: light.toLight, sky: light.sky, bounce: light.bounce, sun: light.sun,
    };
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.depthMask(false);
    use('ground', { ...shared, ...frame.ground });
    gl.bindVertexArray(square.fill);
    gl.drawElements(gl.TRIANGLES, square.fillCount, gl.UNSIGNED_INT, 0);

    gl.depthMask(true);
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1, 1);
    drawSolids(frame.items.filter((i) => i.alpha >= 1), frame, shared);
    gl.disable(gl.POLYGON_OFFSET_FILL);
    drawPoints(frame.clouds, frame);
    gl.depthMask(false);
    drawBlobs(frame.blobs, viewProjection);
    drawEdges(frame.items.filter((i) => i.alpha >= 1 || i.alpha <= 0), viewProjection);

    const distance = (item) => norm(subtract(item.centre, frame.eye));
    const through = frame.items.filter((i) => i.alpha > 0 && i.alpha < 1).sort((a, b) => distance(b) - distance(a));
    drawSolids(through, frame, shared);
    drawEdges(through, viewProjection);
    gl.depthMask(true);
    gl.bindVertexArray(null);
  }

  return {
    upload,
    render,
    uploadPoints: (positions) => ({ array: vertexArray({ position: positions }), count: positions.length / 3 }),
  };
}

const LOCATIONS = { position: 0, normal: 1, colour: 2 };

function linked(gl, vertex, fragment) {
  const handle = gl.createProgram();
  for (const [type, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(handle, shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
  }
  for (const [name, location] of Object.entries(LOCATIONS)) gl.bindAttribLocation(handle, location, name);
  gl.linkProgram(handle);
  if (!gl.getProgramParameter(handle, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(handle));
  const uniforms = {};
  for (let i = 0; i < gl.getProgramParameter(handle, gl.ACTIVE_UNIFORMS); i++) {
    const { name } = gl.getActiveUniform(handle, i);
    uniforms[name] = gl.getUniformLocation(handle, name);
  }
  return { handle, uniforms };
}

function shadowTarget(gl) {
  const texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.texStorage2D(gl.TEXTURE_2D, 1, gl.DEPTH_COMPONENT24, SHADOW_SIZE, SHADOW_SIZE);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_COMPARE_MODE, gl.COMPARE_REF_TO_TEXTURE);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_COMPARE_FUNC, gl.LEQUAL);
  const framebuffer = gl.createFramebuffer();
  gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, texture, 0);
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  return { texture, framebuffer };
}
