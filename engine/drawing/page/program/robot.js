// The robot: a body with wheels, a mast and the laser on it, as large as such robots are, as boxes.

const kRobotBoxes = [  // centre, half extents, colour
  [[0, 0, 0.16], [0.24, 0.17, 0.07], [0.35, 0.55, 0.72]],
  [[0.1, 0, 0.24], [0.1, 0.12, 0.012], [0.22, 0.26, 0.31]],
  [[0.13, 0.19, 0.09], [0.08, 0.025, 0.08], [0.13, 0.14, 0.16]],
  [[0.13, -0.19, 0.09], [0.08, 0.025, 0.08], [0.13, 0.14, 0.16]],
  [[-0.13, 0.19, 0.09], [0.08, 0.025, 0.08], [0.13, 0.14, 0.16]],
  [[-0.13, -0.19, 0.09], [0.08, 0.025, 0.08], [0.13, 0.14, 0.16]],
  [[0.245, 0, 0.17], [0.01, 0.1, 0.03], [0.95, 0.66, 0.16]],
];
const kLaserColour = [0.85, 0.55, 0.0];
const kFaces = [0, 1, 2].flatMap((axis) => [-1, 1].map((side) => [axis, side]));

/// Six faces of two triangles: place, normal, colour of each corner.
function boxVertices([centre, half, colour]) {
  const out = [];
  for (const [axis, side] of kFaces) {
    const normal = [0, 0, 0];
    normal[axis] = side;
    const [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
    for (const [su, sv] of [[-1, -1], [1, -1], [1, 1], [-1, -1], [1, 1], [-1, 1]]) {
      const at = [...centre];
      at[axis] += side * half[axis];
      at[u] += su * half[u];
      at[v] += sv * half[v];
      out.push(...at, ...normal, ...colour);
    }
  }
  return out;
}

class Robot {
  /// laserHeight: of the mount, where it is known.
  constructor(gl, laserHeight) {
    this.gl = gl;
    const top = Math.max(laserHeight ?? 0.4, 0.3);
    const boxes = [...kRobotBoxes, [[0, 0, (0.23 + top) / 2], [0.025, 0.025, (top - 0.23) / 2], [0.3, 0.33, 0.37]],
                   [[0.01, 0, top], [0.06, 0.06, 0.045], kLaserColour]];
    const vertices = new Float32Array(boxes.flatMap(boxVertices));
    this.count = vertices.length / 9;
    this.array = vertexArray(gl, bufferOf(gl, vertices),
                             [0, 1, 2].map((location) => [location, 3, gl.FLOAT, false, 36, 12 * location]));
    this.program = programOf(gl, kBodyVertex, kBodyFragment);
  }

  /// From afar it is drawn larger, so that it is found; nothing hides it, as the part behind others shines through.
  draw(matrix, pose, height, factor) {
    const gl = this.gl;
    gl.bindVertexArray(this.array);
    drawHiddenAndSeen(gl, (isHidden) => {
      if (!isHidden) gl.disable(gl.STENCIL_TEST);  // its own boxes hide each other by depth
      this.program.use({clip_from_page: matrix, pose: [pose.x, pose.y, height, pose.heading], factor,
                        opacity: isHidden ? 0.4 : 1});
      gl.drawArrays(gl.TRIANGLES, 0, this.count);
    });
  }
}
