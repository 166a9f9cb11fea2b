// Draws the linkage and the plot of its elevation on canvases of two dimensions.

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

class MechanismDrawing {
  constructor(canvas, linkage) {
    [this.canvas, this.linkage] = [canvas, linkage];
    const {crank, coupler, rocker, ground} = linkage.about;
    this.beam = 1.15 * Math.max(rocker, crank + coupler - ground, 0.5 * (crank + ground)) + 0.35 * rocker;
    [this.least, this.most] = linkage.bounds(this.beam);
    for (const axis of [0, 1]) {
      this.least[axis] = Math.min(this.least[axis], -crank);
      this.most[axis] = Math.max(this.most[axis], crank);
    }
  }

  /// Pixels from metres, all positions in the middle of the canvas.
  fit(width, height) {
    const margin = clamp(0.09 * Math.min(width, height), 18, 64);
    const [w, h] = [0, 1].map((axis) => this.most[axis] - this.least[axis]);
    this.scale = Math.max(Math.min((width - 2 * margin) / w, (height - 2 * margin) / h), 1);
    this.origin = [width / 2 - this.scale * (this.least[0] + this.most[0]) / 2,
                   height / 2 + this.scale * (this.least[1] + this.most[1]) / 2];
  }
  at(p) { return [this.origin[0] + this.scale * p[0], this.origin[1] - this.scale * p[1]]; }
  metresAt(x, y) { return [(x - this.origin[0]) / this.scale, (this.origin[1] - y) / this.scale]; }

  draw(pose) {
    const {context, width, height} = sharpContext(this.canvas);
    this.fit(width, height);
    this.unit = clamp(Math.min(width, height) / 100, 2.4, 12);
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
  }

  /// The laser sits on the rocker's axis and looks along the rocker.
  drawLaser(context, pose) {
    const pivot = this.at(this.linkage.rockerPivot);
    const end = this.at(this.linkage.beamEnd(pose, this.beam));
    const level = this.at([this.linkage.rockerPivot[0] + this.beam, this.linkage.rockerPivot[1]]);
    stroke(context, [pivot, level], inkOf('quiet'), 1, [3, 5]);
    context.save();
    context.globalAlpha = 0.16;
    context.fillStyle = inkOf('laser');
    context.beginPath();
    context.moveTo(...pivot);
    context.arc(...pivot, this.beam * this.scale * 0.45, 0, -pose.elevation, pose.elevation > 0);
    context.fill();
    context.restore();
    stroke(context, [pivot, end], inkOf('laser'), 2.5);
    const away = [end[0] - pivot[0], end[1] - pivot[1]].map((value) => value / (this.beam * this.scale));
    const [x, y] = end;
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
    const size = clamp(2.4 * this.unit, 12, 22);
    context.font = `600 ${size}px system-ui, "Segoe UI", "Noto Sans", "DejaVu Sans", Arial, sans-serif`;
    context.textAlign = 'center';
    context.textBaseline = 'middle';
    const centre = [0, 1].map((axis) => (crankPivot[axis] + rockerPivot[axis] + a[axis] + b[axis]) / 4);
    for (const [from, to, name] of [[crankPivot, a, 'crank'], [a, b, 'coupler'], [rockerPivot, b, 'rocker']]) {
      const middle = [0, 1].map((axis) => (from[axis] + to[axis]) / 2);
      let normal = [from[1] - to[1], to[0] - from[0]];
      const length = Math.max(Math.hypot(...normal), 1);
      const isInward = normal[0] * (middle[0] - centre[0]) + normal[1] * (middle[1] - centre[1]) < 0;
      normal = normal.map((value) => (isInward ? -value : value) / length);
      const half = context.measureText(name).width / 2;
      const away = half * Math.abs(normal[0]) + 0.5 * size * Math.abs(normal[1]) + 1.9 * this.unit;
      const at = [0, 1].map((axis) => middle[axis] + away * normal[axis]);
      context.lineWidth = 5;
      context.strokeStyle = cssOf(colourOf('scene'));
      context.strokeText(name, ...at);
      context.fillStyle = inkOf(name);
      context.fillText(name, ...at);
    }
  }
}

/// Elevation over the crank's angle, with dead points and a mark that runs along.
class PlotDrawing {
  constructor(canvas, linkage) {
    [this.canvas, this.linkage] = [canvas, linkage];
    const rows = Array.from({length: linkage.about.steps}, (_, k) => linkage.row(k)).filter((row) => row);
    const elevations = rows.map((row) => degrees(row[6]));
    const [least, most] = [Math.min(...elevations), Math.max(...elevations)];
    this.step = [5, 10, 15, 30, 45, 90].find((step) => (most - least) / step <= 6) ?? 90;
    [this.least, this.most] = [Math.floor(least / this.step + 0.01) * this.step, Math.ceil(most / this.step - 0.01) * this.step];
    if (this.most <= this.least) this.most = this.least + this.step;
  }

  at(step, elevation_deg) {
    const share = (elevation_deg - this.least) / (this.most - this.least);
    return [mix(this.left, this.right, step / this.linkage.about.steps), mix(this.bottom, this.top, share)];
  }
  stepAt(x) { return clamp((x - this.left) / (this.right - this.left), 0, 1) * this.linkage.about.steps; }

  draw(step, pose) {
    const {context, width, height} = sharpContext(this.canvas);
    const size = width > 700 ? 16 : 12.5;
    context.font = `${size}px system-ui, "Segoe UI", "Noto Sans", "DejaVu Sans", Arial, sans-serif`;
    [this.left, this.right, this.top, this.bottom] = [3.6 * size, width - 1.2 * size, 2 * size, height - 3.2 * size];
    this.drawFrame(context, size);
    this.drawCurve(context);
    for (const dead of this.linkage.about.dead_points) {
      disc(context, this.at(dead.step, degrees(dead.elevation)), 4, inkOf('card'), inkOf('ground'));
    }
    if (!pose) return;
    const mark = this.at(step, degrees(pose.elevation));
    stroke(context, [[mark[0], this.bottom], mark], inkOf('laser'), 1.5, [3, 4]);
    disc(context, mark, 6, inkOf('laser'), inkOf('card'));
  }

  drawFrame(context, size) {
    context.textBaseline = 'middle';
    context.fillStyle = inkOf('quiet');
    context.textAlign = 'right';
    for (let value = this.least; value <= this.most + 1e-6; value += this.step) {
      const y = this.at(0, value)[1];
      stroke(context, [[this.left, y], [this.right, y]], inkOf('grid'), 1);
      context.fillText(`${fixed(value, 0)}°`, this.left - 7, y);
    }
    context.textAlign = 'center';
    for (let turn = 0; turn <= 360; turn += 90) {
      const x = this.at(turn / 360 * this.linkage.about.steps, this.least)[0];
      stroke(context, [[x, this.top], [x, this.bottom]], inkOf('grid'), 1);
      context.fillText(`${turn}°`, x, this.bottom + size);
    }
    context.fillText('crank angle θ input in degrees', (this.left + this.right) / 2, this.bottom + 2.3 * size);
    context.fillStyle = inkOf('laser-text');
    context.textAlign = 'left';
    context.fillText('Elevation θ*', this.left, 0.8 * size);
  }

  drawCurve(context) {
    const {steps} = this.linkage.about;
    let stretch = [];
    let before = null;
    const flush = () => {
      if (stretch.length > 1) stroke(context, stretch, inkOf('laser'), 2.5);
      stretch = [];
    };
    for (let k = 0; k <= steps; ++k) {
      const row = this.linkage.row(k);
      if (!row || (before && Math.abs(row[6] - before[6]) > Math.PI)) flush();
      if (row) stretch.push(this.at(k, degrees(row[6])));
      before = row;
    }
    flush();
  }
}
