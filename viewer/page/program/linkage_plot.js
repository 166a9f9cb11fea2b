// Plots of the linkage's elevation and transmission angle on canvases of two dimensions.

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
    context.font = `${size}px system-ui, "Segoe UI", "Noto Sans", "DejaVu Sans", Arial, sans-serif`;
    [this.left, this.right, this.top, this.bottom] = [3 * size, width - 1.4 * size, 2.2 * size, height - 3.2 * size];
    this.drawFrame(context, size, width);
    this.drawCurve(context);
    for (const dead of this.curve.key === 'elevation' ? this.linkage.about.dead_points : []) {
      disc(context, this.at(dead.step, degrees(dead.elevation)), 5, inkOf('text'), inkOf('card'));
    }
    if (!pose) return;
    const mark = this.at(step, degrees(pose[this.curve.key]));
    stroke(context, [[mark[0], this.bottom], [mark[0], this.top]], inkOf('quiet'), 1);
    disc(context, mark, 6.5, inkOf(this.curve.ink), inkOf('card'));
  }

  drawFrame(context, size, width) {
    if (this.curve.poor) this.drawPoor(context, size);
    context.textBaseline = 'middle';
    context.fillStyle = inkOf('quiet');
    context.textAlign = 'right';
    for (let value = this.least; value <= this.most + 1e-6; value += this.step) {
      const y = this.at(0, value)[1];
      stroke(context, [[this.left, y], [this.right, y]], inkOf('grid'), 1);
      context.fillText(`${fixed(value, 0)}°`, this.left - 7, y);
    }
    context.textAlign = 'center';
    for (let turn = 0; turn <= 360; turn += width > 26 * size ? 45 : 90) {
      const x = this.at(turn / 360 * this.linkage.about.steps, this.least)[0];
      stroke(context, [[x, this.bottom], [x, this.bottom + 4]], inkOf('quiet'), 1);
      context.fillText(`${turn}°`, x, this.bottom + size);
    }
    context.fillText('crank angle θ input', (this.left + this.right) / 2, this.bottom + 2.3 * size);
    context.fillStyle = inkOf(this.curve.inkOfTitle);
    context.textAlign = 'left';
    context.fillText(this.curve.title, this.left, 0.9 * size);
  }

  /// Below this a linkage passes its force on badly.
  drawPoor(context, size) {
    const y = this.at(0, this.curve.poor)[1];
    context.save();
    context.globalAlpha = 0.1;
    context.fillStyle = inkOf('crank');
    context.fillRect(this.left, y, this.right - this.left, this.bottom - y);
    context.restore();
    stroke(context, [[this.left, y], [this.right, y]], inkOf('crank'), 1.2, [5, 4]);
    context.fillStyle = inkOf('crank');
    context.textAlign = 'right';
    context.textBaseline = 'middle';
    context.fillText(`poor below ${this.curve.poor}°`, this.right, 0.9 * size);
  }

  drawCurve(context) {
    const {steps} = this.linkage.about;
    let stretch = [];
    let before = null;
    const flush = () => {
      if (stretch.length > 1) stroke(context, stretch, inkOf(this.curve.ink), 2.5);
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
