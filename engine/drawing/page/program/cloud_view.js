// Draws the cloud and what lies about it, when something has changed. Points go into a picture with depth, which is
// shaded onto the screen with its depths; the rest is drawn over that with smooth edges.

const kLeastShare = 0.02;
const kRobotReach_m = 0.5;
const kEmptyReach_m = 12;  // of the bounds where nothing is known yet
const kSlowFrame_ms = 45;  // a frame that takes longer while the camera moves draws fewer points next time

class CloudView {
  constructor(canvas, gl, isSoftware) {
    [this.canvas, this.gl] = [canvas, gl];
    this.points = description.cloud ? new Points(description.cloud) : null;
    this.takeLayers();
    this.camera = new Camera(this.least, this.most, this.reach());
    this.share = 1;        // of the points, while the camera moves
    if (this.points) this.share = clamp((isSoftware ? 120e3 : 3e6) / this.points.about.count, kLeastShare, 1);
    this.frames = 0;
    this.movedAt = -Infinity;
    this.afterFrame = [];
    this.prepare();
    view.watchers.push(() => this.request());
    theme.watchers.push(() => { this.readColours(); this.request(); });
    new ResizeObserver(() => this.resize()).observe(canvas);
  }

  /// Path and map of the description, and the bounds.
  takeLayers() {
    this.path = description.path ? new Path(description.path) : null;
    this.setBounds();
  }

  /// The bounds that the camera fits into the picture: cloud without stray points, map, path.
  setBounds() {
    let [least, most] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
    const include = (point) => {
      least = least.map((value, axis) => Math.min(value, point[axis]));
      most = most.map((value, axis) => Math.max(value, point[axis]));
    };
    const origin = description.origin;
    const {cloud, map} = description;
    this.floor = (cloud && cloud.floor ? cloud.floor.height : 0) - origin[2];
    if (cloud) {
      include(sub(cloud.middle_least, origin));
      include(sub(cloud.middle_most, origin));
    } else if (map) {
      this.boxOfMap().forEach(include);
    }
    for (let k = 0; this.path && k < this.path.about.count; ++k) {
      include([this.path.poses[4 * k], this.path.poses[4 * k + 1], this.floor]);
    }
    if (!(least[0] <= most[0])) [least, most] = [[-kEmptyReach_m, -kEmptyReach_m, 0], [kEmptyReach_m, kEmptyReach_m, 0]];
    if (this.path && Math.max(...sub(most, least)) < 2 * kRobotReach_m) {  // the robot stood, and is larger than its path
      const middle = scaled(add(least, most), 0.5);
      include(add(middle, [kRobotReach_m, kRobotReach_m, 0]));
      include(sub(middle, [kRobotReach_m, kRobotReach_m, 0]));
    }
    [this.least, this.most] = [least, most];
  }

  /// Least and most corner of the map.
  boxOfMap() {
    const {map, origin} = description;
    const [x, y] = [map.x - origin[0], map.y - origin[1]];
    return [[x, y, this.floor], [x + map.width * map.resolution, y + map.height * map.resolution, this.floor]];
  }

  /// How far from the middle of the bounds anything lies that is drawn: stray points of the cloud and the map beside it, too.
  reach() {
    const {cloud, map, origin} = description;
    const corners = cornersOf(this.least, this.most);
    if (cloud) corners.push(...cornersOf(sub(cloud.least, origin), sub(cloud.most, origin)));
    if (map) corners.push(...cornersOf(...this.boxOfMap()));
    const middle = scaled(add(this.least, this.most), 0.5);
    return Math.max(...corners.map((corner) => norm(sub(corner, middle))));
  }

  /// All that lives on the graphics processor; again where its context was lost.
  prepare() {
    const gl = this.gl;
    this.pointProgram = programOf(gl, kPointVertex, kPointFragment);
    this.shadeProgram = programOf(gl, kScreenVertex, kShadeFragment);
    this.picture = new DepthPicture(gl);
    this.screenArray = gl.createVertexArray();
    this.mapTexture = makeTexture(gl, gl.LINEAR);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGB8, 256, 1);
    this.mapLoaded = -1;
    this.robot = new Robot(gl, description.linkage ? description.linkage.height : undefined);
    this.upload();
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
  }

  upload() {
    const gl = this.gl;
    this.grid = makeGrid(gl, this.least, this.most, this.floor - 0.03);
    if (description.map) this.map = new MapPicture(gl, description.map, this.floor - 0.02);
    this.path?.upload(gl);
  }

  /// Another path and map have come with the description; the camera stays.
  takeAgain() {
    for (const part of [this.grid, this.map, this.path]) release(this.gl, part);
    this.takeLayers();
    this.upload();
    this.camera.setBounds(this.least, this.most, this.reach());
    this.request();
  }

  readColours() {
    for (const name of ['scene', 'plain', 'quiet', 'card', 'crank', 'laser', 'free', 'wall', ...kTimeStops]) this['colour_' + name] = colourOf(name);
  }

  resize() {
    const ratio = pixelRatio();
    this.camera.width = Math.max(this.canvas.clientWidth, 1);
    this.camera.height = Math.max(this.canvas.clientHeight, 1);
    this.canvas.width = Math.round(this.camera.width * ratio);
    this.canvas.height = Math.round(this.camera.height * ratio);
    this.isSized = this.canvas.clientWidth > 0;
    if (this.isSized && this.isUntouched()) {
      this.camera.between(this.camera.state(), this.fitted(kFirstPreset), 1);
      this.shown = this.camera.state();
    }
    this.draw();
  }

  /// Whether the camera still shows what the page chose: whoever has looked elsewhere keeps that view in any size.
  isUntouched() { return !this.shown || (!this.flight && isSameView(this.shown, this.camera.state())); }

  fitted(preset) { return this.camera.fitting(preset.yaw, preset.pitch); }

  /// Draws at the browser's next frame.
  request() {
    if (this.isRequested) return;
    this.isRequested = true;
    requestAnimationFrame((now) => this.step(now));
  }

  /// The camera has moved: fewer points where the machine is slow, all of them when it stands again.
  moved() {
    this.movedAt = performance.now();
    this.request();
  }

  step(now) {
    this.isRequested = false;
    if (this.flight) this.advanceFlight(now);
    const isMoving = performance.now() - this.movedAt < 160;
    const wasMoving = this.lastMoving;
    this.lastMoving = isMoving;
    if (isMoving && wasMoving) this.adapt(now - this.lastStep);
    this.lastStep = now;
    this.draw(isMoving ? this.share : 1);
    if (isMoving || this.flight) this.request();
  }

  /// The browser waits for the graphics processor, so the time between two frames says how slow it is.
  adapt(frame_ms) {
    if (frame_ms > kSlowFrame_ms) this.share = Math.max(this.share * Math.max(kSlowFrame_ms / frame_ms, 0.3), kLeastShare);
    else if (frame_ms < 0.5 * kSlowFrame_ms) this.share = Math.min(this.share * 1.15, 1);
  }

  flyTo(state) {
    this.flight = {from: this.camera.state(), to: state, begin: performance.now(), lasts_ms: prefersStill() ? 1 : 350};
    this.moved();
  }

  fit() {
    stopFollowing();
    this.flyTo(this.fitted(this.camera));
  }

  advanceFlight(now) {
    const share = clamp((now - this.flight.begin) / this.flight.lasts_ms, 0, 1);
    this.camera.between(this.flight.from, this.flight.to, share * share * (3 - 2 * share));
    if (share >= 1) this.flight = null;
    else this.movedAt = performance.now();
  }

  draw(share = 1) {
    if (!this.isSized || this.gl.isContextLost()) return;
    if (!this.colour_scene) this.readColours();
    const matrix = this.camera.matrix();
    this.drawPoints(matrix, share);
    this.shade();
    this.drawSurroundings(matrix);
    ++this.frames;
    for (const watcher of this.afterFrame) watcher();
  }

  drawPoints(matrix, share) {
    const {gl, points} = this;
    gl.disable(gl.BLEND);
    this.picture.begin(this.canvas.width, this.canvas.height);
    if (!points || !view.layers.cloud || points.loaded === 0) return;
    const ratio = this.canvas.height / this.camera.height;
    const pixels = this.camera.pixelsPerMetre(1) * ratio * points.spacing * view.pointFactor / Math.sqrt(share);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.mapTexture);
    const hasScale = view.quantity in kQuantities;
    if (hasScale) this.loadColourMap(view.colourMap[view.quantity]);
    this.pointProgram.use({
      clip_from_page: matrix, extent: points.extent, until: cloudShareOf(shownTime()),
      with_levels: [view.layers.floor ? 1 : 0, view.layers.ceiling ? 1 : 0], ...this.weightsOf(view.quantity),
      is_plain: hasScale ? 0 : 1, colours: 0, plain: this.colour_plain,
      point: [pixels, 1.25 * ratio * Math.sqrt(view.pointFactor), 40 * ratio],
    });
    points.draw(gl, share);
  }

  /// From shares of the quantity's whole range to shares of the chosen scale.
  weightsOf(quantity) {
    if (!(quantity in kQuantities)) return {};
    const {least, most} = description.cloud[quantity];
    const [low, high] = view.scale[quantity];
    const extent = Math.max(high - low, 1e-9 * (most - least), 1e-12);
    const weight = (name) => (name === quantity ? (most - least) / extent : 0);
    return {of_place: [weight('height'), weight('time')],
            of_attributes: [weight('elevation'), weight('scan'), weight('distance'), (least - low) / extent]};
  }

  loadColourMap(index) {
    if (this.mapLoaded === index) return;
    const gl = this.gl;
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, 256, 1, gl.RGB, gl.UNSIGNED_BYTE, colourMaps[index].bytes);
    this.mapLoaded = index;
  }

  shade() {
    const gl = this.gl;
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.viewport(0, 0, this.canvas.width, this.canvas.height);
    gl.depthFunc(gl.ALWAYS);
    this.picture.bindTextures();
    this.shadeProgram.use({colour: 0, depth: 1, planes: this.camera.planes(), strength: 90 * view.shading,
                           radius: Math.max(1, Math.round(this.canvas.height / this.camera.height)),
                           background: this.colour_scene});
    gl.bindVertexArray(this.screenArray);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.depthFunc(gl.LEQUAL);
  }

  drawSurroundings(matrix) {
    const gl = this.gl;
    const pixels = [this.canvas.width, this.canvas.height];
    gl.enable(gl.BLEND);
    if (view.layers.grid) this.grid.draw(matrix, [...this.colour_quiet, 0.28]);
    if (this.map && view.layers.map) {
      this.map.draw(matrix, this.colour_free, this.colour_wall);
    }
    // Beside a cloud, whose points have colours of their own, one colour is told apart better.
    const stops = this.points ? null : kTimeStops.map((name) => this['colour_' + name]);
    if (view.layers.path) {
      this.path?.draw(matrix, pixels, this.floor + 0.03, this.colour_crank, shownTime(), stops);
      this.trail?.draw(matrix, pixels, this.floor + 0.03, this.colour_crank, 2, stops);
    }
    if (view.layers.scan) this.scan?.draw(matrix, [...this.colour_laser, 1], 3 * pixelRatio());
    const pose = description.live ? this.pose : this.path?.poseAt(shownTime());
    if (view.layers.robot && pose) {
      const seen = this.camera.pixelOf([pose.x, pose.y, this.floor]);
      const factor = seen ? clamp(22 / (0.5 * this.camera.pixelsPerMetre(seen[2])), 1, 8) : 1;
      this.robot.draw(matrix, pose, this.floor, factor);
    }
  }
}
