// Words and marks over the scene: colour bar, scale bar, axes, picked points. The same on the screen and in pictures
// that are saved.

class Overlay {
  constructor(canvas, cloudView) {
    [this.canvas, this.cloudView] = [canvas, cloudView];
    this.context = canvas.getContext('2d');
    cloudView.afterFrame.push(() => this.draw());
    picks.watchers.push(() => this.draw());
  }

  draw() {
    const {canvas, context} = this;
    const camera = this.cloudView.camera;
    const ratio = this.cloudView.canvas.height / camera.height;
    canvas.width = this.cloudView.canvas.width;
    canvas.height = this.cloudView.canvas.height;
    this.size = camera.width > 2000 ? 18 : 13;  // of letters
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.font = `${this.size}px system-ui, "Segoe UI", "Noto Sans", "DejaVu Sans", Arial, sans-serif`;
    context.textBaseline = 'middle';
    const hasBar = view.quantity in kQuantities && view.layers.cloud && this.cloudView.points;
    const barWidth = clamp(camera.width * 0.36, 160, 1.2 * 26 * this.size);
    if (hasBar) this.drawColourBar(18, camera.height - 3.4 * this.size, barWidth);
    if (!this.cloudView.points && this.cloudView.path && view.layers.path && timeSpan.extent > 0) {
      this.drawTimeBar(18, camera.height - 3.4 * this.size, barWidth);
    }
    this.drawAxes(camera.width - 4 * this.size, camera.height - 4.4 * this.size);
    if (camera.width > barWidth + 22 * this.size) this.drawScaleBar(camera.width - 8.5 * this.size, camera.height - 2.2 * this.size);
    this.drawPicks();
  }

  /// Letters with a rim of the background, so that they can be read over points.
  words(text, x, y, align = 'left', colour = 'text') {
    const context = this.context;
    context.textAlign = align;
    context.lineJoin = 'round';
    context.lineWidth = 4;
    context.strokeStyle = cssOf(colourOf('scene'));
    context.strokeText(text, x, y);
    context.fillStyle = hexColour(colour);
    context.fillText(text, x, y);
  }

  line(colour, width, ...points) {
    this.context.strokeStyle = hexColour(colour);
    this.context.lineWidth = width;
    this.context.beginPath();
    for (const [x, y] of points) this.context.lineTo(x, y);
    this.context.stroke();
  }

  drawColourBar(x, y, width) {
    const map = colourMaps[view.colourMap[view.quantity]];
    this.drawBar(x, y, width, kQuantities[view.quantity], shownScale(view.quantity), (share) => cssOfMap(map, share));
  }

  /// Of a path that is coloured by time.
  drawTimeBar(x, y, width) {
    const colours = kTimeStops.map(colourOf);
    const at = (share) => {
      const leg = Math.min(Math.floor(share * 4), 3);
      return cssOf([0, 1, 2].map((part) => mix(colours[leg][part], colours[leg + 1][part], share * 4 - leg)));
    };
    this.drawBar(x, y, width, kQuantities.time, [0, timeSpan.extent], at);
  }

  drawBar(x, y, width, quantity, [low, high], colourAt) {
    const context = this.context;
    context.fillStyle = cssOf(colourOf('scene'), 0.72);
    context.beginPath();
    context.roundRect(x - 10, y - 1.9 * this.size, width + 20, 4.7 * this.size, 8);
    context.fill();
    this.words(quantity.unit ? `${quantity.name} (${quantity.unit})` : quantity.name, x, y - 0.95 * this.size);
    for (let k = 0; k < width; ++k) {
      context.fillStyle = colourAt(k / (width - 1));
      context.fillRect(x + k, y, 1.2, this.size * 0.9);
    }
    // Where both ends are one large value, its digits must still tell the ticks apart.
    const extent = Math.max(high - low, 1e-9 * Math.max(1, Math.abs(high)));
    const step = roundStep(extent * 4.2 * this.size / width);
    const first = Math.ceil(low / step - 1e-6);
    for (let tick = 0; (first + tick) * step <= high + 1e-6 * step; ++tick) {
      const k = first + tick;
      const at = x + clamp((k * step - low) / Math.max(high - low, 1e-12), 0, 1) * width;
      context.fillStyle = hexColour('text');
      context.fillRect(Math.round(at) - 0.5, y + this.size * 0.9, 1, 4);
      const text = fixed(k * step, decimalsOf(step));
      const half = context.measureText(text).width / 2;
      this.words(text, clamp(at, x + half - 6, x + width - half + 6), y + 2 * this.size, 'center');
    }
  }

  /// A round number of metres, as long as it is seen at the target.
  drawScaleBar(right, y) {
    const camera = this.cloudView.camera;
    const perMetre = camera.pixelsPerMetre(camera.distance);
    const length = roundStep(6 * this.size / perMetre);
    const width = length * perMetre;
    this.line('text', 2, [right - width, y - 5], [right - width, y], [right, y], [right, y - 5]);
    const text = length >= 1 ? `${length} m` : length >= 0.01 ? `${Math.round(100 * length)} cm` : `${(1000 * length).toPrecision(1)} mm`;
    this.words(text, right - width / 2, y - 1.1 * this.size, 'center');
  }

  drawAxes(x, y) {
    const {right, up, back} = this.cloudView.camera.axes();
    const arm = 2.1 * this.size;
    const arms = ['x', 'y', 'z'].map((name, axis) => ({name, colour: ['crank', 'rocker', 'coupler'][axis],
                                                       dx: right[axis] * arm, dy: -up[axis] * arm, near: back[axis]}));
    arms.sort((a, b) => a.near - b.near);
    for (const {name, colour, dx, dy} of arms) {
      this.context.lineCap = 'round';
      this.line(colour, 2.5, [x, y], [x + dx, y + dy]);
      if (Math.hypot(dx, dy) > 0.35 * arm) this.words(name, x + dx * 1.3, y + dy * 1.3, 'center', colour);
    }
  }

  drawPicks() {
    const context = this.context;
    const seen = picks.points.map((point) => this.cloudView.camera.pixelOf(point.position));
    if (seen.length === 2 && seen[0] && seen[1]) {
      this.line('laser', 2, ...seen);
      const middle = [0, 1].map((axis) => (seen[0][axis] + seen[1][axis]) / 2);
      this.words(picks.lengthText(), middle[0], middle[1] - this.size, 'center', 'laser-text');
    }
    context.strokeStyle = hexColour('laser');
    context.lineWidth = 2;
    for (const at of seen) {
      if (!at) continue;
      context.beginPath();
      context.arc(at[0], at[1], 6, 0, 2 * Math.PI);
      context.stroke();
    }
  }
}

const cssOf = (colour, opacity = 1) => `rgb(${colour.map((part) => Math.round(255 * part)).join(' ')} / ${opacity})`;
/// The chosen scale in the unit that is shown; times count from the begin of the log.
function shownScale(quantity) {
  const {factor} = kQuantities[quantity];
  return view.scale[quantity].map((value) => (quantity === 'time' ? value - cloudBegin : value) * factor);
}

/// Canvases of one size over each other as PNG, on the ground that they have on the page.
function savePicture(...canvases) {
  const picture = element('canvas', {width: canvases[0].width, height: canvases[0].height});
  const context = picture.getContext('2d');
  context.fillStyle = cssOf(colourOf('scene'));
  context.fillRect(0, 0, picture.width, picture.height);
  for (const canvas of canvases) context.drawImage(canvas, 0, 0);
  picture.toBlob((blob) => {
    const url = URL.createObjectURL(blob);
    element('a', {href: url, download: 'gdtslam.png'}).click();
    setTimeout(() => URL.revokeObjectURL(url), 10000);
  });
}
