// The programs of the graphics processor (GLSL ES 3.00); Program puts the version and the precisions before them.

const kPointVertex = `layout(location = 0) in vec3 a_share;       // of the cloud's box
layout(location = 1) in float a_time;       // share of its times
layout(location = 2) in vec4 a_attributes;  // elevation, scan, distance as shares; level code / 255
uniform mat4 u_clip_from_page;
uniform vec3 u_extent;
uniform float u_until;
uniform vec2 u_with_levels;   // floor, ceiling: 1 when shown
uniform vec2 u_of_place;       // weights of height and time in the share of the colour map
uniform vec4 u_of_attributes;  // of elevation, scan, distance and of 1
uniform bool u_is_plain;
uniform sampler2D u_colours;
uniform vec3 u_plain;
uniform vec3 u_point;         // pixels of a point 1 m away, least and most pixels
out vec3 v_colour;
flat out float v_is_round;

void main() {
  int level = int(a_attributes.w * 255.0 + 0.5);
  bool is_hidden = a_time > u_until || (level == 1 && u_with_levels.x < 0.5) || (level == 2 && u_with_levels.y < 0.5);
  if (is_hidden) {
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    gl_PointSize = 1.0;
    return;
  }
  gl_Position = u_clip_from_page * vec4(a_share * u_extent, 1.0);
  gl_PointSize = clamp(u_point.x / gl_Position.w, u_point.y, u_point.z);
  v_is_round = gl_PointSize > 3.5 ? 1.0 : 0.0;
  if (u_is_plain) {
    v_colour = u_plain;
  } else {
    float share = dot(vec2(a_share.z, a_time), u_of_place) + dot(vec4(a_attributes.xyz, 1.0), u_of_attributes);
    v_colour = texelFetch(u_colours, ivec2(clamp(share, 0.0, 1.0) * 255.0 + 0.5, 0), 0).rgb;
  }
}`;

const kPointFragment = `in vec3 v_colour;
flat in float v_is_round;
out vec4 colour;
void main() {
  vec2 away = 2.0 * gl_PointCoord - 1.0;
  if (v_is_round > 0.5 && dot(away, away) > 1.0) discard;
  colour = vec4(v_colour, 1.0);
}`;

// Eye-dome lighting [Boucheny2009]: a pixel is darkened by how far its neighbours lie before it, in the logarithm of
// the depth, so that the shading does not depend on the scale. One triangle covers the screen.
const kScreenVertex = `void main() {
  gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);
}`;

const kShadeFragment = `uniform sampler2D u_colour;
uniform highp sampler2D u_depth;
uniform vec2 u_planes;     // near, far
uniform float u_strength;  // 0: no shading
uniform int u_radius;      // pixels
uniform vec3 u_background;
out vec4 colour;
float log_depth(float depth) {
  return log2(2.0 * u_planes.x * u_planes.y / (u_planes.y + u_planes.x - (2.0 * depth - 1.0) * (u_planes.y - u_planes.x)));
}
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  float depth = texelFetch(u_depth, at, 0).r;
  gl_FragDepth = depth;
  if (depth >= 1.0) {
    colour = vec4(u_background, 1.0);
    return;
  }
  float here = log_depth(depth);
  float nearer = 0.0;
  ivec2 last = textureSize(u_depth, 0) - 1;
  for (int k = 0; k < 8; ++k) {
    ivec2 step = ivec2(k < 3 ? -1 : k < 5 ? 0 : 1, k == 0 || k == 3 || k == 5 ? -1 : k == 1 || k == 6 ? 0 : 1) * u_radius;
    float other = texelFetch(u_depth, clamp(at + step, ivec2(0), last), 0).r;
    if (other < 1.0) nearer += clamp(here - log_depth(other), 0.0, 0.25);
  }
  float light = 0.3 + 0.7 * exp(-u_strength * nearer / 8.0);
  colour = vec4(texelFetch(u_colour, at, 0).rgb * light, 1.0);
}`;

const kFlatVertex = `layout(location = 0) in vec3 a_at;
uniform mat4 u_clip_from_page;
uniform float u_size;  // pixels of a point
void main() {
  gl_Position = u_clip_from_page * vec4(a_at, 1.0);
  gl_PointSize = u_size;
}`;

const kFlatFragment = `uniform vec4 u_colour;
out vec4 colour;
void main() { colour = u_colour; }`;

const kMapVertex = `uniform mat4 u_clip_from_page;
uniform vec3 u_corner;
uniform vec2 u_size;
out vec2 v_share;
void main() {
  v_share = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  gl_Position = u_clip_from_page * vec4(u_corner + vec3(v_share * u_size, 0.0), 1.0);
}`;

const kMapFragment = `in vec2 v_share;
uniform sampler2D u_cells;  // red: share that is occupied, green: share that is known
uniform vec3 u_free;
uniform vec3 u_occupied;
out vec4 colour;
void main() {
  vec4 cell = texture(u_cells, v_share);
  if (cell.g < 0.02) discard;
  colour = vec4(mix(u_free, u_occupied, cell.r / max(cell.g, 0.01)), cell.g);
}`;

// A stretch of the path: four corners, as wide on the screen as is asked.
const kPathVertex = `layout(location = 0) in vec4 a_from;  // x, y, heading, time
layout(location = 1) in vec4 a_to;
uniform mat4 u_clip_from_page;
uniform float u_height;
uniform vec2 u_pixels;  // of the picture
uniform float u_width;  // pixels
out float v_time;
void main() {
  vec4 from = u_clip_from_page * vec4(a_from.xy, u_height, 1.0);
  vec4 to = u_clip_from_page * vec4(a_to.xy, u_height, 1.0);
  int corner = gl_VertexID % 6;  // 0 1 2, 1 2 3 of a strip
  corner = corner < 3 ? corner : corner - 2;
  bool is_end = corner > 1;
  vec2 along = (to.xy / max(to.w, 1e-4) - from.xy / max(from.w, 1e-4)) * u_pixels;
  along = dot(along, along) > 1e-8 ? normalize(along) : vec2(1.0, 0.0);
  float side = (corner & 1) == 1 ? 0.5 : -0.5;
  vec4 at = is_end ? to : from;
  vec2 shift = (vec2(-along.y, along.x) * side + along * (is_end ? 0.25 : -0.25)) * u_width * 2.0 / u_pixels;
  gl_Position = from.w < 1e-3 || to.w < 1e-3 ? vec4(2.0, 2.0, 2.0, 1.0) : at + vec4(shift * at.w, 0.0, 0.0);
  v_time = is_end ? a_to.w : a_from.w;
}`;

const kPathFragment = `in float v_time;
uniform float u_until;
uniform float u_length;  // of the log; 0: the path has one colour
uniform vec4 u_colour;
uniform vec3 u_stop0, u_stop1, u_stop2, u_stop3, u_stop4;  // of the time, evenly spaced
out vec4 colour;
vec3 of_time(float share) {
  float at = 4.0 * clamp(share, 0.0, 1.0);
  vec3 early = mix(mix(u_stop0, u_stop1, clamp(at, 0.0, 1.0)), u_stop2, clamp(at - 1.0, 0.0, 1.0));
  return mix(mix(early, u_stop3, clamp(at - 2.0, 0.0, 1.0)), u_stop4, clamp(at - 3.0, 0.0, 1.0));
}
void main() {
  colour = u_length > 0.0 ? vec4(of_time(v_time / u_length), u_colour.a) : u_colour;
  if (v_time > u_until) colour.a *= 0.25;
}`;

const kBodyVertex = `layout(location = 0) in vec3 a_at;
layout(location = 1) in vec3 a_normal;
layout(location = 2) in vec3 a_colour;
uniform mat4 u_clip_from_page;
uniform vec4 u_pose;   // x, y, height, heading
uniform float u_factor;
out vec3 v_colour;
void main() {
  float c = cos(u_pose.w);
  float s = sin(u_pose.w);
  vec3 at = a_at * u_factor;
  vec3 normal = vec3(c * a_normal.x - s * a_normal.y, s * a_normal.x + c * a_normal.y, a_normal.z);
  gl_Position = u_clip_from_page * vec4(u_pose.xyz + vec3(c * at.x - s * at.y, s * at.x + c * at.y, at.z), 1.0);
  v_colour = a_colour * (0.62 + 0.38 * max(dot(normal, normalize(vec3(0.3, 0.5, 0.8))), 0.0) + 0.08 * normal.x);
}`;

const kBodyFragment = `in vec3 v_colour;
uniform float u_opacity;
out vec4 colour;
void main() { colour = vec4(v_colour, u_opacity); }`;
