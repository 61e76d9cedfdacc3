// Programs of the graphics processor. Places are metres from the corner of the box.

const HEAD = `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp usampler2D;
`;

const COMMON = `
uniform mat4 view, projection;
uniform sampler2D colours;   // 256 entries, by the value of a field
uniform vec4 plain;          // one colour for all, where its last entry is not 0
vec3 colourOf(int value) {
  return plain.a > 0.0 ? plain.rgb : texelFetch(colours, ivec2(value, 0), 0).rgb;
}
`;

const LIGHT = `
uniform float flatness;      // 1: colours as they are
uniform float roundness;     // how much each particle is shaded as a ball
vec3 lit(vec3 colour, vec3 normal, float strength) {
  float light = 0.5 + 0.5 * dot(normal, normalize(vec3(-0.45, 0.55, 0.70)));
  return colour * mix(1.0, 0.42 + 0.63 * light, strength * (1.0 - flatness));
}
`;

// Walls between the viewer and what moves are not drawn.
const PARTICLE_VERTEX = `${HEAD}
layout(location = 0) in vec2 corner;
layout(location = 1) in vec4 place;  // shares of the box; of the largest radius
layout(location = 2) in uint value;
${COMMON}
uniform vec3 size, back, low, high;
uniform vec3 cuts;           // 1 for the axes along which walls are cut
uniform float largest;
out vec2 at;
out vec3 centre;
flat out float radius;
flat out vec3 colour;
bool isBefore(vec3 p) {
  for (int k = 0; k < 3; k++) {
    if (cuts[k] == 0.0 || abs(back[k]) < 0.2) continue;
    if (back[k] > 0.0 ? p[k] > high[k] : p[k] < low[k]) return true;
  }
  return false;
}
void main() {
  vec3 p = place.xyz * size;
  radius = place.w * largest;
  at = corner;
  colour = colourOf(int(value));
  centre = (view * vec4(p, 1.0)).xyz;
  gl_Position = projection * vec4(centre + vec3(corner * radius, 0.0), 1.0);
  if (isBefore(p)) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
}`;

const PARTICLE_FRAGMENT = `${HEAD}
uniform mat4 projection;
${LIGHT}
in vec2 at;
in vec3 centre;
flat in float radius;
flat in vec3 colour;
out vec4 pixel;
void main() {
  float r2 = dot(at, at);
  if (r2 > 1.0) discard;
  vec3 normal = vec3(at, sqrt(1.0 - r2));
  vec4 clip = projection * vec4(centre + radius * normal * (1.0 - flatness), 1.0);
  gl_FragDepth = 0.5 + 0.5 * clip.z / clip.w;
  pixel = vec4(lit(colour, normal, roundness), 1.0);
}`;

// Rigid balls: a great circle on each shows how it turns. Flat ones have a radius drawn.
const BALL_VERTEX = `${HEAD}
layout(location = 0) in vec2 corner;
layout(location = 1) in vec4 ball;   // centre and radius, m
layout(location = 2) in uint value;
layout(location = 3) in vec4 turn;   // quaternion w, x, y, z
${COMMON}
out vec2 at;
out vec3 centre;
flat out float radius;
flat out vec3 colour;
flat out vec4 quaternion;
void main() {
  radius = ball.w;
  at = corner;
  quaternion = turn;
  colour = colourOf(int(value));
  centre = (view * vec4(ball.xyz, 1.0)).xyz;
  gl_Position = projection * vec4(centre + vec3(corner * radius, 0.0), 1.0);
}`;

const BALL_FRAGMENT = `${HEAD}
uniform mat4 view, projection;
${LIGHT}
in vec2 at;
in vec3 centre;
flat in float radius;
flat in vec3 colour;
flat in vec4 quaternion;
out vec4 pixel;
vec3 turnedBack(vec3 v) {
  vec3 q = -quaternion.yzw;
  return v + 2.0 * cross(q, cross(q, v) + quaternion.x * v);
}
void main() {
  float r2 = dot(at, at);
  if (r2 > 1.0) discard;
  vec3 normal = vec3(at, sqrt(1.0 - r2));
  vec3 own = turnedBack(transpose(mat3(view)) * mix(normal, vec3(at, 0.0), flatness));
  bool marked = flatness > 0.5 ? (own.x > 0.0 && abs(own.y) < 0.09) || r2 > 0.82 : abs(own.z) < 0.05;
  vec4 clip = projection * vec4(centre + radius * normal * (1.0 - flatness), 1.0);
  gl_FragDepth = 0.5 + 0.5 * clip.z / clip.w - 1e-6;
  pixel = vec4(lit(marked ? 0.62 * colour : colour, normal, 1.0), 1.0);
}`;

const SOLID_VERTEX = `${HEAD}
layout(location = 0) in vec3 corner;  // m, in the axes of the body
layout(location = 1) in vec3 normal;
${COMMON}
uniform mat3 turn;
uniform vec3 shift;
uniform int value;
out vec3 facing;
flat out vec3 colour;
void main() {
  colour = colourOf(value);
  facing = mat3(view) * (turn * normal);
  gl_Position = projection * view * vec4(turn * corner + shift, 1.0);
}`;

const SOLID_FRAGMENT = `${HEAD}
${LIGHT}
in vec3 facing;
flat in vec3 colour;
out vec4 pixel;
void main() {
  vec3 normal = normalize(facing);
  pixel = vec4(lit(colour, normal.z < 0.0 ? -normal : normal, 1.0), 1.0);
}`;

// The terrain is a grid of heights; the normal comes from the neighbours of a node.
const TERRAIN_VERTEX = `${HEAD}
uniform mat4 view, projection;
uniform usampler2D heights;      // 16 bits; 65535: no data
uniform ivec2 shape;             // columns, rows
uniform vec3 origin, spacing;    // m; the third: of the lowest height, and the range
uniform bool upright;            // heights are along y: the ground of a 2-D run as it is cut
out vec3 facing;
out float height;
float heightAt(ivec2 node) {
  return float(texelFetch(heights, clamp(node, ivec2(0), shape - 1), 0).r) / 65534.0 * spacing.z;
}
void main() {
  ivec2 node = ivec2(gl_VertexID % shape.x, gl_VertexID / shape.x);
  float dx = heightAt(node + ivec2(1, 0)) - heightAt(node - ivec2(1, 0));
  float dy = heightAt(node + ivec2(0, 1)) - heightAt(node - ivec2(0, 1));
  facing = normalize(vec3(-dx / (2.0 * spacing.x), -dy / (2.0 * spacing.y), 1.0));
  if (upright) facing = vec3(0.0, 0.0, 1.0);
  vec2 place = vec2(node) * spacing.xy;
  vec3 p = origin + (upright ? vec3(place.x, heightAt(node), 0.0) : vec3(place, heightAt(node)));
  height = upright ? p.y : p.z;
  gl_Position = projection * view * vec4(p, 1.0);
}`;

const TERRAIN_FRAGMENT = `${HEAD}
uniform vec3 soil;
uniform float interval, base;    // m, of contours; height of the corner of the box
uniform bool upright;
in vec3 facing;
in float height;
out vec4 pixel;
float line(float every) {
  float h = (height + base) / every;
  float width = max(fwidth(h), 1e-6);
  return (1.0 - smoothstep(0.5, 1.3, abs(fract(h - 0.5) - 0.5) / width)) * (1.0 - smoothstep(0.15, 0.4, width));
}
void main() {
  float light = dot(normalize(facing), normalize(vec3(-0.5, 0.5, 0.7)));
  vec3 colour = soil * (0.62 + 0.48 * max(light, 0.0));
  if (!upright) colour *= 1.0 - max(0.14 * line(interval), 0.26 * line(5.0 * interval));
  pixel = vec4(colour, 1.0);
}`;

// Darkens what is behind its neighbours on the screen: shapes stand out without any shadow.
// Eye-dome lighting: Boucheny 2009, Visualisation scientifique interactive de grands volumes.
const SCREEN_VERTEX = `${HEAD}
void main() {
  gl_Position = vec4(vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0), 0.0, 1.0);
}`;

const SCREEN_FRAGMENT = `${HEAD}
uniform sampler2D picture, depths;
uniform vec3 background;
uniform float near, far, strength, opacity;
uniform int reach;               // pixels
out vec4 pixel;
float distanceAt(ivec2 at) {
  float d = texelFetch(depths, clamp(at, ivec2(0), textureSize(depths, 0) - 1), 0).r;
  return log2(near * far / (far - d * (far - near)));
}
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 found = texelFetch(picture, at, 0);
  float here = distanceAt(at), behind = 0.0;
  for (int k = 0; k < 8; k++) {
    float angle = 0.7854 * float(k);
    ivec2 step = ivec2(round(float(reach) * vec2(cos(angle), sin(angle))));
    behind += clamp(here - distanceAt(at + step), 0.0, 0.06);
  }
  pixel = vec4(mix(background, found.rgb * exp(-strength * behind / 8.0), found.a), opacity);
}`;
