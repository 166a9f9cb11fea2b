// Mouse and fingers over the scene: left button or one finger turns, right button, shift or two fingers move, wheel or
// pinch zooms towards the cursor; a click picks a point, a double click makes it the centre.

const kClick_px = 4;  // a press that moves less is a click

class PointerControl {
  constructor(canvas, cloudView) {
    [this.canvas, this.cloudView] = [canvas, cloudView];
    this.pointers = new Map();
    canvas.addEventListener('pointerdown', (event) => this.down(event));
    canvas.addEventListener('pointermove', (event) => this.move(event));
    for (const name of ['pointerup', 'pointercancel']) canvas.addEventListener(name, (event) => this.up(event));
    canvas.addEventListener('wheel', (event) => this.wheel(event), {passive: false});
    canvas.addEventListener('dblclick', (event) => this.centre(event));
    canvas.addEventListener('contextmenu', (event) => event.preventDefault());
  }

  at(event) {
    const box = this.canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  down(event) {
    try {
      this.canvas.setPointerCapture(event.pointerId);
    } catch { /* a pointer that is gone already cannot be captured, and needs not */ }
    this.pointers.set(event.pointerId, this.at(event));
    this.path_px = this.pointers.size > 1 ? Infinity : 0;
    this.canvas.classList.add('is-moving');
    this.cloudView.flight = null;
  }

  move(event) {
    const before = this.pointers.get(event.pointerId);
    if (!before) return;
    const now = this.at(event);
    const [dx, dy] = [now[0] - before[0], now[1] - before[1]];
    if (this.pointers.size === 2) {
      this.pinch(event.pointerId, before, now);
    } else if (event.buttons & 2 || event.buttons & 4 || event.shiftKey) {
      this.cloudView.camera.pan(dx, dy);
      stopFollowing();
    } else {
      this.cloudView.camera.turn(dx, dy);
    }
    this.path_px += Math.abs(dx) + Math.abs(dy);
    this.pointers.set(event.pointerId, now);
    this.cloudView.moved();
  }

  /// Two fingers: their middle moves the scene, their distance zooms.
  pinch(id, before, now) {
    const other = [...this.pointers].find(([key]) => key !== id)[1];
    const apart = (a, b) => Math.max(Math.hypot(a[0] - b[0], a[1] - b[1]), 1);
    const camera = this.cloudView.camera;
    camera.pan((now[0] - before[0]) / 2, (now[1] - before[1]) / 2);
    const middle = [(now[0] + other[0]) / 2, (now[1] + other[1]) / 2];
    camera.zoom(apart(before, other) / apart(now, other), camera.pointAt(...middle, camera.distance));
  }

  up(event) {
    if (!this.pointers.delete(event.pointerId)) return;
    if (this.pointers.size === 0) this.canvas.classList.remove('is-moving');
    if (event.type === 'pointerup' && event.button === 0 && this.path_px < kClick_px) {
      picks.take(pickPoint(this.cloudView, ...this.at(event)));
    }
    this.cloudView.moved();
  }

  /// What is under the cursor stays there; it is looked up once for a turn of the wheel.
  wheel(event) {
    event.preventDefault();
    const camera = this.cloudView.camera;
    const [x, y] = this.at(event);
    const isNew = performance.now() - (this.wheeledAt ?? -Infinity) > 300 || Math.hypot(x - this.wheelAt[0], y - this.wheelAt[1]) > 4;
    if (isNew) {
      const picked = pickPoint(this.cloudView, x, y, 14);
      this.anchor = picked ? picked.position : groundAt(this.cloudView, x, y) ?? camera.pointAt(x, y, camera.distance);
      this.wheelAt = [x, y];
    }
    this.wheeledAt = performance.now();
    const pixels = event.deltaY * (event.deltaMode === 1 ? 33 : event.deltaMode === 2 ? 400 : 1);
    camera.zoom(Math.exp(clamp(pixels, -240, 240) * 0.0016), this.anchor);
    this.cloudView.moved();
  }

  centre(event) {
    const [x, y] = this.at(event);
    const picked = pickPoint(this.cloudView, x, y);
    const target = picked ? picked.position : groundAt(this.cloudView, x, y);
    if (target) this.cloudView.flyTo({...this.cloudView.camera.state(), target});
  }
}
