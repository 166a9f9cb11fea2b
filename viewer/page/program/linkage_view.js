// Plays the linkage: turns the crank, lets one drag it, shows the numbers.

const kTurn_s = 4;  // of the crank, at speed 1

class LinkageView {
  constructor(linkage) {
    this.linkage = linkage;
    this.mechanism = new MechanismDrawing(byId('mechanism'), linkage);
    this.plots = [new PlotDrawing(byId('plot'), linkage, kElevationCurve),
                  new PlotDrawing(byId('transmission-plot'), linkage, kTransmissionCurve)];
    this.step = this.firstStep();
    this.direction = linkage.about.direction;  // as the motor turns
    this.isPlaying = true;
    this.makeValues();
    this.listen();
    theme.watchers.push(() => this.draw());
    for (const canvas of this.canvases()) new ResizeObserver(() => this.draw()).observe(canvas);
    requestAnimationFrame((now) => this.advance(now));
  }

  canvases() { return [this.mechanism, ...this.plots].map((drawing) => drawing.canvas); }

  /// The begin of the lift, else the first that closes.
  firstStep() {
    const {dead_points: deadPoints, steps} = this.linkage.about;
    if (deadPoints.length > 0) return deadPoints[0].step % steps;
    for (let k = 0; k < this.linkage.about.steps; ++k) {
      if (this.linkage.at(k + 0.5)) return k;
    }
    return 0;
  }

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
    const show = () => { byId('crank-speed-value').textContent = `${(15 * this.speed()).toFixed(1)} rpm`; };
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
