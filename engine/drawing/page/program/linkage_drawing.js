// Draws the linkage, its elevation and its transmission angle on canvases of two dimensions.

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

function polygon(context, points, colour) {
  context.fillStyle = colour;
  context.beginPath();
  points.forEach((p, k) => (k ? context.lineTo(...p) : context.moveTo(...p)));
  context.fill();
}

/// How the next words are written, by their middle height.
function lettering(context, size, align, weight = 400) {
  context.font = `${weight} ${size}px system-ui, "Segoe UI", "Noto Sans", "DejaVu Sans", Arial, sans-serif`;
  context.textAlign = align;
  context.textBaseline = 'middle';
}

const kHalfFan = 0.09;  // rad, as wide as the fan is drawn

class MechanismDrawing {
  constructor(canvas, linkage) {
    [this.canvas, this.linkage] = [canvas, linkage];
    const {beam, least, most, dead_points: deadPoints} = linkage.about;
    [this.beam, this.least, this.most, this.deadPoints] = [beam, least, most, deadPoints];
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
    this.written = [];  // middles and half sizes of words
    this.fit(width, height - this.drawLegend(context, width, height));
    this.drawSweep(context);
    this.drawPaths(context);
    if (!pose) return;
    this.drawLaser(context, pose);
    const [crankPivot, rockerPivot] = [this.at([0, 0]), this.at(this.linkage.rockerPivot)];
    const [a, b] = [this.at(pose.a), this.at(pose.b)];
    stroke(context, [crankPivot, rockerPivot], hexColour('ground'), 0.8 * this.unit, [], 0.55);
    for (const [from, to, name] of [[rockerPivot, b, 'rocker'], [a, b, 'coupler'], [crankPivot, a, 'crank']]) {
      stroke(context, [from, to], hexColour(name), 1.9 * this.unit);
    }
    for (const pivot of [crankPivot, rockerPivot]) this.drawPivot(context, pivot);
    for (const joint of [a, b]) disc(context, joint, 1.2 * this.unit, hexColour('card'), hexColour('ground'), 0.5 * this.unit);
    disc(context, this.at(pose.middle), 0.8 * this.unit, hexColour('curve'));
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
    stroke(context, circle, hexColour('crank'), 1.5, [2, 5], 0.7);
    stroke(context, arc, hexColour('rocker'), 1.5, [2, 5], 0.7);
    stroke(context, curve, hexColour('curve'), 2);
    // Where the rocker turns back, on its arc.
    for (const dead of this.deadPoints) {
      disc(context, this.at(this.linkage.beamEnd(dead, this.linkage.about.rocker)), 0.9 * this.unit, hexColour('text'));
    }
  }

  /// Letters with a rim of the background; nothing where other words stand already, or beyond the canvas.
  words(context, text, at, colour) {
    const half = [0.5 * context.measureText(text).width + 2, 0.55 * this.size];
    const isOver = this.written.some(([other, size]) => Math.abs(at[0] - other[0]) < half[0] + size[0] &&
                                                        Math.abs(at[1] - other[1]) < half[1] + size[1]);
    const isBeyond = at[0] - half[0] < 0 || at[0] + half[0] > this.canvas.clientWidth || at[1] - half[1] < 0;
    if (isOver || isBeyond) return;
    this.written.push([at, half]);
    context.lineWidth = 5;
    context.strokeStyle = cssOf(colourOf('scene'));
    context.strokeText(text, ...at);
    context.fillStyle = colour;
    context.fillText(text, ...at);
  }

  /// The bars and their lengths along the lower edge, in as many lines as they need; answers the height.
  drawLegend(context, width, height) {
    const size = clamp(width / 55, 12, 22);
    lettering(context, size, 'left');
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
      stroke(context, [[x + 0.3 * size, y], [x + 1.8 * size, y]], hexColour(name), 0.4 * size);
      context.fillStyle = hexColour('text');
      context.fillText(text, x + 2.6 * size, y);
    });
    return lines * 1.8 * size;
  }

  /// A part of the disc about the rocker's pivot, the short way: a crank-rocker swings by less than 180 degrees.
  drawSector(context, from, to, opacity) {
    const by = wrapped(to - from);
    const pivot = this.at(this.linkage.rockerPivot);
    context.save();
    context.globalAlpha = opacity;
    context.fillStyle = hexColour('laser');
    context.beginPath();
    context.moveTo(...pivot);
    context.arc(...pivot, this.beam * this.scale, -from, -(from + by), by > 0);
    context.fill();
    context.restore();
  }

  /// All that the laser sees in one turn, and where it begins and ends.
  drawSweep(context) {
    if (this.deadPoints.length === 0) return;
    const pivot = this.at(this.linkage.rockerPivot);
    this.drawSector(context, ...this.deadPoints.map((dead) => dead.elevation), 0.09);
    lettering(context, this.size, 'center', 600);
    for (const dead of this.deadPoints) {
      const out = (away) => this.at(this.linkage.beamEnd(dead, this.beam + away / this.scale));
      stroke(context, [pivot, out(0)], hexColour('laser'), 1.5, [7, 6]);
      this.words(context, `${fixed(degrees(dead.elevation), 1)}°`, out(1.9 * this.size), hexColour('laser-text'));
    }
  }

  /// The laser sits on the rocker's axis and looks along the rocker; its fan is seen from the edge.
  drawLaser(context, pose) {
    const arrow = 2.2 * this.unit;
    const on = (away, aside = 0) => {
      const [x, y] = this.at(this.linkage.beamEnd(pose, this.beam + away / this.scale));
      return [x + aside * Math.sin(pose.elevation), y + aside * Math.cos(pose.elevation)];
    };
    this.drawSector(context, pose.elevation + kHalfFan, pose.elevation - kHalfFan, 0.3);
    stroke(context, [this.at(this.linkage.rockerPivot), on(-arrow)], hexColour('laser'), 2.5);
    polygon(context, [on(0), on(-arrow, 0.5 * arrow), on(-arrow, -0.5 * arrow)], hexColour('laser'));
  }

  drawPivot(context, [x, y]) {
    const u = this.unit;
    polygon(context, [[x, y], [x - 2 * u, y + 3.2 * u], [x + 2 * u, y + 3.2 * u]], hexColour('ground'));
    disc(context, [x, y], 1.2 * u, hexColour('card'), hexColour('ground'), 0.5 * u);
  }

  /// Each bar's name beside its middle, away from the loop.
  drawNames(context, crankPivot, rockerPivot, a, b) {
    const {size} = this;
    lettering(context, size, 'center', 600);
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
      this.words(context, name, at, hexColour(name));
    }
  }
}

/// Column of the table, words and colours; `least`, `most`, `step` and `poor` in degrees.
const kElevationCurve = {column: 6, key: 'elevation', title: 'Elevation θ*', ink: 'laser', inkOfTitle: 'laser-text'};
const kTransmissionCurve = {column: 7, key: 'transmission', title: 'Transmission angle µ', ink: 'coupler', inkOfTitle: 'coupler',
                            least: 0, most: 90, step: 30, poor: 40};

/// A quantity over the crank's angle, with dead points and a mark that runs along.
class PlotDrawing {
  constructor(canvas, linkage, curve) {
    [this.canvas, this.linkage, this.curve] = [canvas, linkage, curve];
    const rows = Array.from({length: linkage.about.steps}, (_, k) => linkage.row(k)).filter((row) => row);
    const values = rows.map((row) => degrees(row[curve.column]));
    const [least, most] = [curve.least ?? Math.min(...values), curve.most ?? Math.max(...values)];
    this.step = curve.step ?? [5, 10, 15, 30, 45, 90].find((step) => (most - least) / step <= 6) ?? 90;
    [this.least, this.most] = [Math.floor(least / this.step + 0.05) * this.step, Math.ceil(most / this.step - 0.15) * this.step];
    if (this.most <= this.least) this.most = this.least + this.step;
  }

  at(step, value_deg) {
    const share = (value_deg - this.least) / (this.most - this.least);
    return [mix(this.left, this.right, step / this.linkage.about.steps), mix(this.bottom, this.top, share)];
  }
  stepAt(x) { return clamp((x - this.left) / (this.right - this.left), 0, 1) * this.linkage.about.steps; }

  draw(step, pose) {
    const {context, width, height} = sharpContext(this.canvas);
    if (this.canvas.clientWidth === 0) return;
    const size = width > 700 ? 16 : 12.5;
    [this.left, this.right, this.top, this.bottom] = [3 * size, width - 1.4 * size, 2.2 * size, height - 3.2 * size];
    this.drawFrame(context, size, width);
    this.drawCurve(context);
    for (const dead of this.curve.key === 'elevation' ? this.linkage.about.dead_points : []) {
      disc(context, this.at(dead.step, degrees(dead.elevation)), 5, hexColour('text'), hexColour('card'));
    }
    if (!pose) return;
    const mark = this.at(step, degrees(pose[this.curve.key]));
    stroke(context, [[mark[0], this.bottom], [mark[0], this.top]], hexColour('quiet'), 1);
    disc(context, mark, 6.5, hexColour(this.curve.ink), hexColour('card'));
  }

  drawFrame(context, size, width) {
    lettering(context, size, 'right');
    if (this.curve.poor) this.drawPoor(context, size);
    context.fillStyle = hexColour('quiet');
    for (let value = this.least; value <= this.most + 1e-6; value += this.step) {
      const y = this.at(0, value)[1];
      stroke(context, [[this.left, y], [this.right, y]], hexColour('grid'), 1);
      context.fillText(`${fixed(value, 0)}°`, this.left - 7, y);
    }
    context.textAlign = 'center';
    for (let turn = 0; turn <= 360; turn += width > 26 * size ? 45 : 90) {
      const x = this.at(turn / 360 * this.linkage.about.steps, this.least)[0];
      stroke(context, [[x, this.bottom], [x, this.bottom + 4]], hexColour('quiet'), 1);
      context.fillText(`${turn}°`, x, this.bottom + size);
    }
    context.fillText('Crank angle θ input (°)', (this.left + this.right) / 2, this.bottom + 2.3 * size);
    context.fillStyle = hexColour(this.curve.inkOfTitle);
    context.textAlign = 'left';
    context.fillText(this.curve.title, this.left, 0.9 * size);
  }

  /// Below this a linkage passes its force on badly.
  drawPoor(context, size) {
    const y = this.at(0, this.curve.poor)[1];
    context.save();
    context.globalAlpha = 0.1;
    context.fillStyle = hexColour('crank');
    context.fillRect(this.left, y, this.right - this.left, this.bottom - y);
    context.restore();
    stroke(context, [[this.left, y], [this.right, y]], hexColour('crank'), 1.2, [5, 4]);
    context.fillStyle = hexColour('crank');
    const words = `poor below ${this.curve.poor}°`;
    const isBeside = context.measureText(words).width + context.measureText(this.curve.title).width + size <= this.right - this.left;
    if (isBeside) context.fillText(words, this.right, 0.9 * size);
    else context.fillText(words, this.right - 0.4 * size, this.bottom - 0.8 * size);
  }

  drawCurve(context) {
    const {steps} = this.linkage.about;
    let stretch = [];
    let before = null;
    const flush = () => {
      if (stretch.length > 1) stroke(context, stretch, hexColour(this.curve.ink), 2.5);
      stretch = [];
    };
    for (let k = 0; k <= steps; ++k) {
      const row = this.linkage.row(k);
      if (!row || (before && Math.abs(row[this.curve.column] - before[this.curve.column]) > Math.PI)) flush();
      if (row) stretch.push(this.at(k, degrees(row[this.curve.column])));
      before = row;
    }
    flush();
  }
}
