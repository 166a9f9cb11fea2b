// Draws the linkage on a canvas of two dimensions.

const inkOf = (name) => hexColour(name);

/// A canvas that is as sharp as the screen; its context counts in CSS pixels.
function sharpContext(canvas) {
  const ratio = Math.min(devicePixelRatio || 1, 3);
  const [width, height] = [Math.max(canvas.clientWidth, 1), Math.max(canvas.clientHeight, 1)];
  if (canvas.width !== Math.round(width * ratio)) canvas.width = Math.round(width * ratio);
  if (canvas.height !== Math.round(height * ratio)) canvas.height = Math.round(height * ratio);
  const context = canvas.getContext('2d');
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  context.lineCap = 'round';
  context.lineJoin = 'round';
  return {context, width, height};
}

function stroke(context, points, colour, width, dashes = [], opacity = 1) {
  context.save();
  context.globalAlpha = opacity;
  context.strokeStyle = colour;
  context.lineWidth = width;
  context.setLineDash(dashes);
  context.beginPath();
  points.forEach((p, k) => (k ? context.lineTo(...p) : context.moveTo(...p)));
  context.stroke();
  context.restore();
}

function disc(context, [x, y], radius, fill, edge, width = 2) {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context.fillStyle = fill;
  context.fill();
  if (!edge) return;
  context.strokeStyle = edge;
  context.lineWidth = width;
  context.stroke();
}

const kHalfFan = 0.09;  // rad, as wide as the fan is drawn

class MechanismDrawing {
  constructor(canvas, linkage) {
    [this.canvas, this.linkage] = [canvas, linkage];
    const {crank, coupler, rocker, ground} = linkage.about;
    this.beam = 1.15 * Math.max(rocker, crank + coupler - ground, 0.5 * (crank + ground)) + 0.35 * rocker;
    [this.least, this.most] = linkage.bounds(this.beam);
    this.sweep = this.sweepOf();
    for (const axis of [0, 1]) {
      this.least[axis] = Math.min(this.least[axis], -crank);
      this.most[axis] = Math.max(this.most[axis], crank);
    }
  }

  /// Least and most elevation, where the rocker's end goes back.
  sweepOf() {
    const dead = this.linkage.about.dead_points.map((point) => point.elevation);
    return dead.length === 2 && dead[1] !== dead[0] ? dead : null;
  }

  /// Pixels from metres, all positions in the middle of the canvas.
  fit(width, height) {
    const margin = clamp(0.09 * Math.min(width, height), 3.8 * this.size, 80);
    const [w, h] = [0, 1].map((axis) => this.most[axis] - this.least[axis]);
    this.scale = Math.max(Math.min((width - 2 * margin) / w, (height - 2 * margin) / h), 1);
    this.origin = [width / 2 - this.scale * (this.least[0] + this.most[0]) / 2,
                   height / 2 + this.scale * (this.least[1] + this.most[1]) / 2];
  }
  at(p) { return [this.origin[0] + this.scale * p[0], this.origin[1] - this.scale * p[1]]; }
  metresAt(x, y) { return [(x - this.origin[0]) / this.scale, (this.origin[1] - y) / this.scale]; }

  draw(pose) {
    const {context, width, height} = sharpContext(this.canvas);
    this.unit = clamp(Math.min(width, height) / 100, 2.4, 12);
    this.size = clamp(2.2 * this.unit, 12, 22);  // of letters
    this.fit(width, height - this.drawLegend(context, width, height));
    this.drawSweep(context);
    this.drawPaths(context);
    if (!pose) return;
    this.drawLaser(context, pose);
    const [crankPivot, rockerPivot] = [this.at([0, 0]), this.at(this.linkage.rockerPivot)];
    const [a, b] = [this.at(pose.a), this.at(pose.b)];
    stroke(context, [crankPivot, rockerPivot], inkOf('ground'), 0.8 * this.unit, [], 0.55);
    for (const [from, to, name] of [[rockerPivot, b, 'rocker'], [a, b, 'coupler'], [crankPivot, a, 'crank']]) {
      stroke(context, [from, to], inkOf(name), 1.9 * this.unit);
    }
    for (const pivot of [crankPivot, rockerPivot]) this.drawPivot(context, pivot);
    for (const joint of [a, b]) disc(context, joint, 1.2 * this.unit, inkOf('card'), inkOf('ground'), 0.5 * this.unit);
    disc(context, this.at(pose.middle), 0.8 * this.unit, inkOf('curve'));
    this.drawNames(context, crankPivot, rockerPivot, a, b);
  }

  drawPaths(context) {
    const steps = this.linkage.about.steps;
    const curve = [];
    const arc = [];
    for (let k = 0; k <= steps; ++k) {
      const pose = this.linkage.at(k % steps);
      if (!pose) continue;
      curve.push(this.at(pose.middle));
      arc.push(this.at(pose.b));
    }
    const circle = Array.from({length: 91}, (_, k) => this.at([this.linkage.about.crank * Math.cos(k * Math.PI / 45),
                                                              this.linkage.about.crank * Math.sin(k * Math.PI / 45)]));
    stroke(context, circle, inkOf('crank'), 1.5, [2, 5], 0.7);
    stroke(context, arc, inkOf('rocker'), 1.5, [2, 5], 0.7);
    stroke(context, curve, inkOf('curve'), 2);
    this.drawDeadPoints(context);
  }

  font(context, weight, size = this.size) {
    context.font = `${weight} ${size}px system-ui, "Segoe UI", "Noto Sans", "DejaVu Sans", Arial, sans-serif`;
  }

  /// Letters with a rim of the background.
  words(context, text, at, colour) {
    context.lineWidth = 5;
    context.strokeStyle = cssOf(colourOf('scene'));
    context.strokeText(text, ...at);
    context.fillStyle = colour;
    context.fillText(text, ...at);
  }

  /// The bars and their lengths along the lower edge, in as many lines as they need; answers the height.
  drawLegend(context, width, height) {
    const size = clamp(width / 55, 12, 22);
    this.font(context, 400, size);
    context.textAlign = 'left';
    context.textBaseline = 'middle';
    const items = ['crank', 'coupler', 'rocker', 'ground'].map((name) => {
      const text = `${name} ${Number((100 * this.linkage.about[name]).toFixed(2))} cm`;
      return {name, text, width: context.measureText(text).width + 3.6 * size};
    });
    const item = Math.max(...items.map((one) => one.width));
    const columns = [4, 2, 1].find((count) => count * item <= width - 2 * size) ?? 1;
    const lines = items.length / columns;
    items.forEach(({name, text}, k) => {
      const x = (width - columns * item) / 2 + (k % columns) * item;
      const y = height - (lines - Math.floor(k / columns) - 0.2) * 1.8 * size;
      stroke(context, [[x + 0.3 * size, y], [x + 1.8 * size, y]], inkOf(name), 0.4 * size);
      context.fillStyle = inkOf('text');
      context.fillText(text, x + 2.6 * size, y);
    });
    return lines * 1.8 * size;
  }

  /// All that the laser sees in one turn, and where it begins and ends.
  drawSweep(context) {
    if (!this.sweep) return;
    const pivot = this.at(this.linkage.rockerPivot);
    const radius = this.beam * this.scale;
    const [from, to] = this.sweep;
    context.save();
    context.globalAlpha = 0.09;
    context.fillStyle = inkOf('laser');
    context.beginPath();
    context.moveTo(...pivot);
    context.arc(...pivot, radius, -from, -to, to > from);
    context.fill();
    context.restore();
    this.font(context, 600);
    context.textAlign = 'center';
    context.textBaseline = 'middle';
    for (const elevation of this.sweep) {
      const along = [Math.cos(elevation), -Math.sin(elevation)];
      const out = (share) => along.map((part, axis) => pivot[axis] + share * part);
      stroke(context, [pivot, out(radius)], inkOf('laser'), 1.5, [7, 6]);
      this.words(context, `${fixed(degrees(elevation), 1)}°`, out(radius + 1.9 * this.size), inkOf('laser-text'));
    }
  }

  /// Where the rocker turns back, on its arc.
  drawDeadPoints(context) {
    for (const {elevation} of this.linkage.about.dead_points) {
      const [x, y] = this.linkage.rockerPivot;
      const {rocker} = this.linkage.about;
      disc(context, this.at([x + rocker * Math.cos(elevation), y + rocker * Math.sin(elevation)]), 0.9 * this.unit, inkOf('text'));
    }
  }

  /// The laser sits on the rocker's axis and looks along the rocker; its fan is seen from the edge.
  drawLaser(context, pose) {
    const pivot = this.at(this.linkage.rockerPivot);
    const end = this.at(this.linkage.beamEnd(pose, this.beam));
    context.save();
    context.globalAlpha = 0.3;
    context.fillStyle = inkOf('laser');
    context.beginPath();
    context.moveTo(...pivot);
    context.arc(...pivot, this.beam * this.scale, -pose.elevation - kHalfFan, -pose.elevation + kHalfFan);
    context.fill();
    context.restore();
    const away = [end[0] - pivot[0], end[1] - pivot[1]].map((value) => value / (this.beam * this.scale));
    const [x, y] = end.map((value, axis) => value - 2.2 * this.unit * away[axis]);
    stroke(context, [pivot, [x, y]], inkOf('laser'), 2.5);
    const [u, v] = [away.map((part) => part * 2.2 * this.unit), [-away[1] * 1.1 * this.unit, away[0] * 1.1 * this.unit]];
    context.fillStyle = inkOf('laser');
    context.beginPath();
    context.moveTo(x + u[0], y + u[1]);
    context.lineTo(x + v[0], y + v[1]);
    context.lineTo(x - v[0], y - v[1]);
    context.fill();
  }

  drawPivot(context, [x, y]) {
    const u = this.unit;
    context.fillStyle = inkOf('ground');
    context.beginPath();
    context.moveTo(x, y);
    context.lineTo(x - 2 * u, y + 3.2 * u);
    context.lineTo(x + 2 * u, y + 3.2 * u);
    context.fill();
    disc(context, [x, y], 1.2 * u, inkOf('card'), inkOf('ground'), 0.5 * u);
  }

  /// Each bar's name beside its middle, away from the loop.
  drawNames(context, crankPivot, rockerPivot, a, b) {
    const {size} = this;
    this.font(context, 600);
    context.textAlign = 'center';
    context.textBaseline = 'middle';
    const centre = [0, 1].map((axis) => (crankPivot[axis] + rockerPivot[axis] + a[axis] + b[axis]) / 4);
    const bars = [[crankPivot, rockerPivot, 'ground'], [crankPivot, a, 'crank'], [a, b, 'coupler'], [rockerPivot, b, 'rocker']];
    for (const [from, to, name] of bars) {
      const middle = [0, 1].map((axis) => (from[axis] + to[axis]) / 2);
      let normal = [from[1] - to[1], to[0] - from[0]];
      const length = Math.max(Math.hypot(...normal), 1);
      const isInward = normal[0] * (middle[0] - centre[0]) + normal[1] * (middle[1] - centre[1]) < 0;
      normal = normal.map((value) => (isInward ? -value : value) / length);
      const half = context.measureText(name).width / 2;
      const away = half * Math.abs(normal[0]) + 0.5 * size * Math.abs(normal[1]) + 1.9 * this.unit;
      const at = [0, 1].map((axis) => middle[axis] + away * normal[axis]);
      this.words(context, name, at, inkOf(name));
    }
  }
}
