// The programs that run on the graphics card. Colours come in as sRGB and are lit in linear light;
// output is premultiplied, so that the page's own background shows through.

const LIGHTING = `
  uniform highp sampler2DShadow shadowMap;
  uniform vec3 toLight, sky, bounce, sun;
  uniform float shadowTexel;
  float lit(vec4 inLight, float slope) {
    vec3 p = inLight.xyz / inLight.w * 0.5 + 0.5;
    if (any(lessThan(p, vec3(0.0))) || any(greaterThan(p, vec3(1.0)))) return 1.0;
    p.z -= 0.0009 + 0.0016 * slope;
    float sum = 0.0;
    for (int i = -1; i <= 1; i++)
      for (int j = -1; j <= 1; j++) sum += texture(shadowMap, p + vec3(vec2(i, j) * shadowTexel * 1.4, 0.0));
    return sum / 9.0;
  }`;

const SHADERS = {
  solid: [`#version 300 es
    in vec3 position, normal, colour;
    uniform mat4 model, viewProjection, lightMatrix;
    out vec3 atWorld, facing, paint;
    out vec4 inLight;
    void main() {
      vec4 world = model * vec4(position, 1.0);
      atWorld = world.xyz;
      facing = mat3(model) * normal;
      paint = colour;
      inLight = lightMatrix * vec4(world.xyz + normalize(facing) * 0.003, 1.0);
      gl_Position = viewProjection * world;
    }`, `#version 300 es
    precision highp float;
    in vec3 atWorld, facing, paint;
    in vec4 inLight;
    uniform vec3 tint, eye;
    uniform float alpha;
    out vec4 pixel;
    ${LIGHTING}
    void main() {
      vec3 n = normalize(facing);
      vec3 toEye = normalize(eye - atWorld);
      if (dot(n, toEye) < 0.0) n = -n;
      float facingLight = max(dot(n, toLight), 0.0);
      float light = facingLight * lit(inLight, 1.0 - facingLight);
      vec3 base = pow(paint * tint, vec3(2.2));
      vec3 c = base * (mix(bounce, sky, n.z * 0.5 + 0.5) + sun * light);
      c += sun * 0.05 * light * pow(max(dot(n, normalize(toLight + toEye)), 0.0), 36.0);
      c += sky * 0.05 * pow(1.0 - max(dot(n, toEye), 0.0), 3.0);
      pixel = vec4(pow(c, vec3(1.0 / 2.2)) * alpha, alpha);
    }`],

  depth: [`#version 300 es
    in vec3 position;
    uniform mat4 model, lightMatrix;
    void main() { gl_Position = lightMatrix * model * vec4(position, 1.0); }`, `#version 300 es
    precision mediump float;
    void main() {}`],

  line: [`#version 300 es
    in vec3 position;
    uniform mat4 model, viewProjection;
    uniform float lift;
    void main() {
      gl_Position = viewProjection * model * vec4(position, 1.0);
      gl_Position.z -= lift * gl_Position.w;
    }`, `#version 300 es
    precision mediump float;
    uniform vec4 stroke;
    out vec4 pixel;
    void main() { pixel = vec4(stroke.rgb * stroke.a, stroke.a); }`],

  ground: [`#version 300 es
    in vec3 position;
    uniform mat4 viewProjection, lightMatrix;
    uniform vec3 centre;
    uniform float reach;
    out vec3 atWorld;
    out vec4 inLight;
    void main() {
      atWorld = vec3(centre.xy + position.xy * reach, 0.0);
      inLight = lightMatrix * vec4(atWorld, 1.0);
      gl_Position = viewProjection * vec4(atWorld, 1.0);
    }`, `#version 300 es
    precision highp float;
    in vec3 atWorld;
    in vec4 inLight;
    uniform vec3 centre;
    uniform float reach;
    uniform vec4 stroke, shade;
    out vec4 pixel;
    ${LIGHTING}
    float grid(float spacing) {
      vec2 cell = atWorld.xy / spacing;
      vec2 width = max(fwidth(cell), vec2(1e-6));
      vec2 line = abs(fract(cell - 0.5) - 0.5) / width;
      return (1.0 - min(min(line.x, line.y), 1.0)) * (1.0 - smoothstep(0.1, 0.5, max(width.x, width.y)));
    }
    void main() {
      float fade = 1.0 - smoothstep(0.35, 1.0, length(atWorld.xy - centre.xy) / reach);
      float line = max(grid(1.0), 0.45 * grid(0.25)) * stroke.a * fade;
      float dark = (1.0 - lit(inLight, 0.0)) * shade.a * fade;
      vec4 under = vec4(shade.rgb * dark, dark);
      pixel = vec4(stroke.rgb * line, line) + under * (1.0 - line);
    }`],

  blob: [`#version 300 es
    in vec3 position;
    uniform mat4 viewProjection;
    uniform vec3 centre;
    uniform float reach;
    out vec2 at;
    void main() {
      at = position.xy;
      gl_Position = viewProjection * vec4(centre + vec3(position.xy * reach, 0.0), 1.0);
    }`, `#version 300 es
    precision mediump float;
    in vec2 at;
    uniform float strength;
    out vec4 pixel;
    void main() { pixel = vec4(0.0, 0.0, 0.0, strength * (1.0 - smoothstep(0.45, 1.0, length(at)))); }`],

  points: [`#version 300 es
    in vec3 position;
    uniform mat4 model, viewProjection;
    uniform float size;
    void main() {
      gl_Position = viewProjection * model * vec4(position, 1.0);
      gl_PointSize = clamp(size / gl_Position.w, 1.5, 64.0);
    }`, `#version 300 es
    precision mediump float;
    uniform vec3 tint, toLight;
    out vec4 pixel;
    void main() {
      vec2 p = gl_PointCoord * 2.0 - 1.0;
      if (dot(p, p) > 1.0) discard;
      pixel = vec4(tint * (0.7 + 0.3 * sqrt(1.0 - dot(p, p)) - 0.15 * p.y), 1.0);
    }`],
};
