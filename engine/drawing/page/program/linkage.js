// The four-bar linkage as the program has computed it: joints and elevation at even steps of the crank's angle
// theta_input, which the ground bar is the zero of. x forward, z up, metres, from the crank's pivot. And its view,
// which turns the crank, lets one drag it and shows the numbers.

class Linkage {
  constructor(about) {
    this.about = about;
    this.table = floatsOf(takeBytes('linkage'));
    this.rockerPivot = about.rocker_pivot;
  }

  /// The eight numbers of a whole step, or null where the loop does not close.
  row(step) {
    const k = ((step % this.about.steps) + this.about.steps) % this.about.steps;
    const row = this.table.subarray(8 * k, 8 * k + 8);
    return Number.isNaN(row[2]) ? null : row;
  }

  /// Between two steps straight lines: at most 1e-4 of a bar's length off.
  at(step) {
    const low = Math.floor(step);
    const share = step - low;
    const a = this.row(low);
    const b = share > 0 ? this.row(low + 1) : a;
    if (!a || !b) return null;
    const values = Array.from(a, (value, k) => mix(value, b[k], share));
    return {a: values.slice(0, 2), b: values.slice(2, 4), middle: values.slice(4, 6),
            elevation: wrapped(a[6] + wrapped(b[6] - a[6]) * share), transmission: values[7],
            input: 2 * Math.PI * step / this.about.steps};
  }

  /// The step at which the crank points in a direction (of the drawing, from +x).
  stepOfDirection(angle) {
    const {sign, offset, steps} = this.about;
    const turned = sign * (angle - offset) / (2 * Math.PI);
    return (turned - Math.floor(turned)) * steps;
  }

  beamEnd(pose, length) {
    return [this.rockerPivot[0] + length * Math.cos(pose.elevation), this.rockerPivot[1] + length * Math.sin(pose.elevation)];
  }
}

const kTurn_s = 4;  // of the crank, at speed 1

class LinkageView {
  constructor(linkage) {
    this.linkage = linkage;
    this.mechanism = new MechanismDrawing(byId('mechanism'), linkage);
    this.plots = [new PlotDrawing(byId('plot'), linkage, kElevationCurve),
                  new PlotDrawing(byId('transmission-plot'), linkage, kTransmissionCurve)];
    this.step = linkage.about.first;
    this.direction = linkage.about.direction;  // as the motor turns
    this.makeValues();
    this.listen();
    theme.watchers.push(() => this.draw());
    for (const canvas of this.canvases()) new ResizeObserver(() => this.draw()).observe(canvas);
    this.toggle(!prefersStill());
  }

  canvases() { return [this.mechanism, ...this.plots].map((drawing) => drawing.canvas); }

  makeValues() {
    this.values = {};
    const names = {input: 'Crank θ input', elevation: 'Elevation θ*', transmission: 'Transmission angle'};
    for (const [key, name] of Object.entries(names)) {
      this.values[key] = element('dd', {id: 'value-' + key});
      byId('linkage-values').append(element('div', {}, element('dt', {textContent: name}), this.values[key]));
    }
  }

  listen() {
    byId('crank-play').addEventListener('click', () => this.toggle());
    const speed = byId('crank-speed');
    const show = () => {
      const text = `${(15 * this.speed()).toFixed(1)} rpm`;
      byId('crank-speed-value').textContent = text;
      speed.setAttribute('aria-valuetext', text);
    };
    speed.addEventListener('input', show);
    show();
    for (const canvas of this.canvases()) {
      canvas.addEventListener('pointerdown', (event) => {
        canvas.setPointerCapture(event.pointerId);
        this.dragged = canvas;
        this.drag(event);
      });
      canvas.addEventListener('pointermove', (event) => { if (this.dragged === canvas) this.drag(event); });
      for (const name of ['pointerup', 'pointercancel']) canvas.addEventListener(name, () => { this.dragged = null; });
    }
  }

  speed() { return Math.pow(2, Number(byId('crank-speed').value)); }

  toggle(isPlaying = !this.isPlaying) {
    this.isPlaying = isPlaying;
    byId('crank-play').textContent = isPlaying ? 'Pause' : 'Play';
    if (!isPlaying) return;
    this.last = undefined;
    requestAnimationFrame((now) => this.advance(now));
  }

  /// The crank follows the cursor; playing goes on where it is released.
  drag(event) {
    const box = this.dragged.getBoundingClientRect();
    const [x, y] = [event.clientX - box.left, event.clientY - box.top];
    const plot = this.plots.find((one) => one.canvas === this.dragged);
    if (plot) {
      this.moveTo(plot.stepAt(x));
    } else {
      const [mx, my] = this.mechanism.metresAt(x, y);
      if (Math.hypot(mx, my) > 1e-6) this.moveTo(this.linkage.stepOfDirection(Math.atan2(my, mx)));
    }
  }

  /// Only to where the loop closes.
  moveTo(step) {
    const {steps} = this.linkage.about;
    const turned = ((step % steps) + steps) % steps;
    if (!this.linkage.at(turned)) return false;
    this.step = turned;
    this.draw();
    return true;
  }

  advance(now) {
    if (!this.isPlaying) return;
    const passed_s = Math.min((now - (this.last ?? now)) / 1000, 0.1);
    this.last = now;
    const isSeen = this.mechanism.canvas.clientWidth > 0;
    if (isSeen && !this.dragged) {
      const by = passed_s / kTurn_s * this.speed() * this.linkage.about.steps;
      if (!this.moveTo(this.step + this.direction * by)) this.direction = -this.direction;
    }
    requestAnimationFrame((later) => this.advance(later));
  }

  draw() {
    if (this.mechanism.canvas.clientWidth === 0) return;
    const pose = this.linkage.at(this.step);
    this.mechanism.draw(pose);
    for (const plot of this.plots) plot.draw(this.step, pose);
    for (const [key, place] of Object.entries(this.values)) {
      place.textContent = pose ? `${fixed(degrees(pose[key]), 1)}°` : '';
    }
  }

  /// True for keys that it takes.
  key(event) {
    const degree = this.linkage.about.steps / 360;
    if (event.key === ' ') this.toggle();
    else if (event.key === 'ArrowRight' || event.key === 'ArrowUp') this.stepBy(degree);
    else if (event.key === 'ArrowLeft' || event.key === 'ArrowDown') this.stepBy(-degree);
    else return false;
    return true;
  }

  stepBy(steps) {
    this.toggle(false);
    this.moveTo(this.step + steps);
  }
}
