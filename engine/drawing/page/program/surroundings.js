// Surroundings of the cloud: grid, map, path and the scan of a drive, each with its buffers.

/// Lines or points of one colour; places in the page's frame.
class FlatShape {
  constructor(gl, mode, places) {
    [this.gl, this.mode, this.count] = [gl, mode, places.length / 3];
    this.array = vertexArray(gl, bufferOf(gl, new Float32Array(places)), [[0, 3, gl.FLOAT, false, 12, 0]]);
    this.program = programOf(gl, kFlatVertex, kFlatFragment);
  }

  draw(matrix, colour, size = 1) {
    this.program.use({clip_from_page: matrix, colour, size});
    this.gl.bindVertexArray(this.array);
    this.gl.drawArrays(this.mode, 0, this.count);
  }
}

/// Lines on the floor at round coordinates of the map; `step` is how far they are apart.
function makeGrid(gl, least, most, height) {
  const side = Math.max(most[0] - least[0], most[1] - least[1], 0.5);
  const step = roundStep(side / 12);
  const origin = description.origin;
  const range = (axis) => [Math.floor((least[axis] + origin[axis]) / step) - 1, Math.ceil((most[axis] + origin[axis]) / step) + 1];
  const [[x0, x1], [y0, y1]] = [range(0), range(1)];
  const at = (k, axis) => k * step - origin[axis];
  const lines = [];
  for (let k = x0; k <= x1; ++k) lines.push(at(k, 0), at(y0, 1), height, at(k, 0), at(y1, 1), height);
  for (let k = y0; k <= y1; ++k) lines.push(at(x0, 0), at(k, 1), height, at(x1, 0), at(k, 1), height);
  return Object.assign(new FlatShape(gl, gl.LINES, lines), {step});
}

class MapPicture {
  constructor(gl, about, height) {
    this.gl = gl;
    const packed = takeBytes('map');
    const cells = new Uint8Array(about.width * about.height * 2);
    for (let k = 0; k < about.width * about.height; ++k) {
      const state = packed[k >> 2] >> 2 * (k & 3) & 3;  // 0 unknown, 1 free, 2 occupied
      cells[2 * k] = state === 2 ? 255 : 0;
      cells[2 * k + 1] = state === 0 ? 0 : 255;
    }
    this.texture = makeTexture(gl, gl.LINEAR);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RG8, about.width, about.height, 0, gl.RG, gl.UNSIGNED_BYTE, cells);
    gl.generateMipmap(gl.TEXTURE_2D);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR_MIPMAP_LINEAR);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
    this.corner = [about.x - description.origin[0], about.y - description.origin[1], height];
    this.size = [about.width * about.resolution, about.height * about.resolution];
    this.program = programOf(gl, kMapVertex, kMapFragment);
    this.array = gl.createVertexArray();
  }

  draw(matrix, free, occupied) {
    const gl = this.gl;
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    this.program.use({clip_from_page: matrix, corner: this.corner, size: this.size, cells: 0, free, occupied});
    gl.bindVertexArray(this.array);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
  }
}

const kStretch_m = 0.02;  // shorter ones are joined

/// Draws twice, first what others hide, then what is seen, no pixel of either twice.
function drawHiddenAndSeen(gl, draw) {
  gl.enable(gl.STENCIL_TEST);
  gl.stencilFunc(gl.EQUAL, 0, 255);
  gl.stencilOp(gl.KEEP, gl.KEEP, gl.INCR);
  for (const isHidden of [true, false]) {
    gl.clear(gl.STENCIL_BUFFER_BIT);
    gl.depthFunc(isHidden ? gl.GREATER : gl.LEQUAL);
    gl.depthMask(!isHidden);
    draw(isHidden);
  }
  gl.depthFunc(gl.LEQUAL);
  gl.depthMask(true);
  gl.disable(gl.STENCIL_TEST);
}

class Path {
  /// Poses: x, y, heading and time since the first, page's frame. No line leads to where another drive begins.
  constructor(about, poses = floatsOf(takeBytes('path'))) {
    this.about = about;
    this.begins = new Set(about.drives);
    this.poses = poses;
  }

  upload(gl) {
    this.gl = gl;
    this.program = programOf(gl, kPathVertex, kPathFragment);
    const corners = this.corners();
    this.vertices = corners.length / 8;
    this.array = vertexArray(gl, bufferOf(gl, corners), [[0, 4, gl.FLOAT, false, 32, 0], [1, 4, gl.FLOAT, false, 32, 16]]);
  }

  /// Two triangles for each stretch between poses that lie apart; each corner knows both ends. (One instance for each
  /// stretch would be less to hold, but software renderers take a millisecond for every instance.)
  corners() {
    const pose = (k) => this.poses.subarray(4 * k, 4 * k + 4);
    const stretches = [];
    for (let from = 0, k = 1; k < this.about.count; ++k) {
      const [a, b] = [pose(from), pose(k)];
      const isEnd = k === this.about.count - 1 || this.begins.has(k + 1);
      if (this.begins.has(k)) from = k;
      else if (isEnd || Math.hypot(b[0] - a[0], b[1] - a[1]) > kStretch_m) {
        stretches.push([a, b]);
        from = k;
      }
    }
    const corners = new Float32Array(48 * stretches.length);
    stretches.forEach(([a, b], k) => {
      for (let corner = 0; corner < 6; ++corner) {
        corners.set(a, 48 * k + 8 * corner);
        corners.set(b, 48 * k + 8 * corner + 4);
      }
    });
    return corners;
  }

  /// Where the robot was, between the poses before and after; until another drive begins, at the end of the one before.
  poseAt(stamp) {
    const time = clamp(stamp - this.about.first, 0, this.poses[4 * (this.about.count - 1) + 3]);
    let [low, high] = [0, this.about.count - 1];
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (this.poses[4 * middle + 3] <= time) low = middle;
      else high = middle;
    }
    const [a, b] = [this.poses.subarray(4 * low, 4 * low + 4), this.poses.subarray(4 * high, 4 * high + 4)];
    const passed = b[3] > a[3] ? clamp((time - a[3]) / (b[3] - a[3]), 0, 1) : 1;
    const share = this.begins.has(high) ? Math.floor(passed) : passed;
    return {x: mix(a[0], b[0], share), y: mix(a[1], b[1], share), heading: a[2] + wrapped(b[2] - a[2]) * share};
  }

  /// Twice: as it is hidden by the cloud, and faintly where it is.
  /// `stops`: five colours of the time, or nothing, and the path has one.
  draw(matrix, pixels, height, colour, until, stops = null) {
    const gl = this.gl;
    if (this.about.count < 2) return;
    gl.bindVertexArray(this.array);
    const common = {clip_from_page: matrix, height, pixels, width: (stops ? 2.4 : 3.5) * pixelRatio(),
                    until: until - this.about.first + 1e-3, length: stops ? this.about.last - this.about.first : 0};
    (stops ?? []).forEach((stop, k) => { common['stop' + k] = stop; });
    drawHiddenAndSeen(gl, (isHidden) => {
      this.program.use({...common, colour: [...colour, isHidden ? 0.35 : 1]});
      gl.drawArrays(gl.TRIANGLES, 0, this.vertices);
    });
  }
}
