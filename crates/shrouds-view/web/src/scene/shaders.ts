// Positions are made here, from where the grid edge begins, where it goes and δ.

/** Vertices of a surface or of lines on it. `place` is in lattice coordinates. */
const place = /* glsl */ `
in vec3 outside;
in vec3 along;
in float delta;
in float before;
uniform float glide;
uniform bool midpoints;
vec3 placed() {
  float at = midpoints ? 0.5 : mix(before, delta, glide);
  return outside + at * along;
}
`;

/** Whether a place is cut away. */
const cut = /* glsl */ `
uniform vec4 plane;
in vec3 vPlace;
void clip() {
  if (dot(plane.xyz, vPlace) > plane.w) discard;
}
`;

/** Of interfaces between several labels: the places of both labels in their palette. */
const sidesOut = /* glsl */ `
#ifdef LABELLED
in vec2 sides;
flat out vec2 vSides;
#endif
`;

/** The colour of the label behind a triangle, or where that one is hidden of the one before it; no triangle where
 * both are. Triangles face the second label. */
const sidesIn = /* glsl */ `
#ifdef LABELLED
uniform sampler2D palette;
flat in vec2 vSides;
vec4 label(float number) {
  return texelFetch(palette, ivec2(int(number + 0.5), 0), 0);
}
vec3 side() {
  vec4 behind = label(gl_FrontFacing ? vSides.x : vSides.y);
  vec4 before = label(gl_FrontFacing ? vSides.y : vSides.x);
  if (max(behind.a, before.a) < 0.5) discard;
  return behind.a > 0.5 ? behind.rgb : before.rgb;
}
#endif
`;

export const surfaceVertex = /* glsl */ `
${place}
${sidesOut}
in vec3 direction;
in float scalar;
out vec3 vPlace;
out vec3 vView;
out vec3 vDirection;
out float vScalar;
void main() {
  vPlace = placed();
  vec4 view = modelViewMatrix * vec4(vPlace, 1.0);
  vView = view.xyz;
  vDirection = normalMatrix * direction;
  vScalar = scalar;
#ifdef LABELLED
  vSides = sides;
#endif
  gl_Position = projectionMatrix * view;
}
`;

/** Ambient and diffuse light as in the pictures of \`shrouds render\`; colours are sRGB. */
export const surfaceFragment = /* glsl */ `
${cut}
${sidesIn}
in vec3 vView;
in vec3 vDirection;
in float vScalar;
uniform bool smoothly;
uniform bool coloured;
uniform bool midpoints;
uniform vec3 front;
uniform vec3 back;
uniform vec2 range;
uniform sampler2D colours;
out vec4 colour;
void main() {
  clip();
  vec3 seen = normalize(cross(dFdx(vView), dFdy(vView)));
  vec3 normal = seen;
  // Normals and colours are those of the shroud, not of midpoints.
  if (smoothly && !midpoints && dot(vDirection, vDirection) > 0.0) {
    normal = normalize(vDirection) * (gl_FrontFacing ? 1.0 : -1.0);
  }
  float share = clamp((vScalar - range.x) / (range.y - range.x), 0.0, 1.0);
  vec3 outer = coloured && !midpoints ? texture(colours, vec2(share * 255.0 / 256.0 + 0.5 / 256.0, 0.5)).rgb : front;
#ifdef LABELLED
  vec3 base = pow(side(), vec3(2.2));
#else
  vec3 base = pow(gl_FrontFacing ? outer : back, vec3(2.2));
#endif
  float light = 0.2 + 0.8 * max(dot(normal, normalize(vec3(-0.8, 1.0, 2.2))), 0.0);
  colour = vec4(pow(base * light, vec3(1.0 / 2.2)), 1.0);
}
`;

/** Slightly nearer to the eye than the surface, so that it does not hide its own lines. */
export const lineVertex = /* glsl */ `
${place}
uniform float nearer;
out vec3 vPlace;
void main() {
  vPlace = placed();
  gl_Position = projectionMatrix * modelViewMatrix * vec4(vPlace, 1.0);
  gl_Position.z -= nearer * gl_Position.w;
}
`;

export const plainLineVertex = /* glsl */ `
uniform float nearer;
out vec3 vPlace;
void main() {
  vPlace = position;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  gl_Position.z -= nearer * gl_Position.w;
}
`;

export const lineFragment = /* glsl */ `
${cut}
uniform vec3 ink;
out vec4 colour;
void main() {
  clip();
  colour = vec4(ink, 1.0);
}
`;

export const pointVertex = /* glsl */ `
in float inside;
uniform float step;
// Pixels of the device in one of the page, and in the height of a pane.
uniform vec2 pixels;
out float vInside;
out vec3 vPlace;
void main() {
  vInside = inside;
  vPlace = position;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  // A quarter of a voxel across, but neither too small to see nor in the way.
  float size = 0.125 * step * projectionMatrix[1][1] * pixels.y / gl_Position.w;
  gl_PointSize = clamp(size, 2.5 * pixels.x, 12.0 * pixels.x);
}
`;

/** Inside points are discs, outside points rings: told apart without colours too. */
export const pointFragment = /* glsl */ `
${cut}
in float vInside;
uniform vec3 inner;
uniform vec3 outer;
out vec4 colour;
void main() {
  clip();
  float radius = 2.0 * length(gl_PointCoord - 0.5);
  if (radius > 1.0 || (vInside < 0.5 && radius < 0.55)) discard;
  colour = vec4(vInside > 0.5 ? inner : outer, 1.0);
}
`;

/** The place under one pixel, in lattice coordinates. */
export const pickFragment = /* glsl */ `
${cut}
${sidesIn}
out vec4 colour;
void main() {
  clip();
#ifdef LABELLED
  side();
#endif
  colour = vec4(vPlace, 1.0);
}
`;
