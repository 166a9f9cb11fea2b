// The eye that turns about a target: yaw and pitch say from where it looks (yaw from +x counter-clockwise, pitch above
// the horizon), in radians. Page's frame: the map's, moved by the origin of the description.

const kFieldOfView = 0.7;             // of the smaller side of the picture
const kTurnPerPixel = Math.PI / 600;  // 100 pixels turn by 30 degrees
const kLeastDistance_m = 0.05;        // of the eye from its target
const kPresets = {
  top: {name: 'Top', yaw: -Math.PI / 2, pitch: Math.PI / 2},
  iso: {name: 'Iso', yaw: -2.2, pitch: 0.66},
  front: {name: 'Front', yaw: -Math.PI / 2, pitch: 0.04},
  side: {name: 'Side', yaw: 0, pitch: 0.04},
};

const isSameView = (a, b) => a.yaw === b.yaw && a.pitch === b.pitch && a.distance === b.distance &&
    a.target.every((value, axis) => value === b.target[axis]);

/// A map without a cloud is looked at as one looks at a map.
const kFirstPreset = description.cloud ? kPresets.iso : kPresets.top;

class Camera {
  /// least, most: what is looked at; reach: how far from its middle anything is drawn.
  constructor(least, most, reach = 0) {
    this.setBounds(least, most, reach);
    this.target = scaled(add(least, most), 0.5);
    [this.yaw, this.pitch, this.distance] = [kFirstPreset.yaw, kFirstPreset.pitch, 3 * this.radius];
    [this.width, this.height] = [1, 1];
  }

  setBounds(least, most, reach) {
    [this.least, this.most, this.reach] = [least, most, reach];
    this.radius = Math.max(norm(sub(most, least)) / 2, 0.05);
  }

  axes() {
    const [cy, sy, cp, sp] = [Math.cos(this.yaw), Math.sin(this.yaw), Math.cos(this.pitch), Math.sin(this.pitch)];
    return {right: [-sy, cy, 0], up: [-sp * cy, -sp * sy, cp], back: [cp * cy, cp * sy, sp]};
  }

  eye() { return add(this.target, scaled(this.axes().back, this.distance)); }

  /// Half of what is seen 1 m ahead, across and upright.
  slopes() {
    const smaller = Math.tan(kFieldOfView / 2);
    const side = Math.min(this.width, this.height);
    return [smaller * this.width / side, smaller * this.height / side];
  }

  /// Distances before the eye between which all that is drawn lies, with grid and robot; the target, too, however near it is.
  planes() {
    const away = norm(sub(this.eye(), scaled(add(this.least, this.most), 0.5)));
    const reach = Math.max(2.2 * this.radius, 1.05 * this.reach);
    const far = away + reach;
    return [Math.max(away - reach, Math.min(Math.max(far * 2e-4, 0.02), this.distance / 10)), far];
  }

  matrix() {
    const {right, up, back} = this.axes();
    const [near, far] = this.planes();
    const projection = perspective(2 * Math.atan(this.slopes()[1]), this.width / this.height, near, far);
    return product(projection, viewMatrix(this.eye(), right, up, back));
  }

  /// CSS pixels from the upper left corner and distance before the eye; nothing behind it.
  pixelOf(point) {
    const {right, up, back} = this.axes();
    const away = sub(point, this.eye());
    const depth = -dot(away, back);
    if (depth < 1e-4) return null;
    const [sx, sy] = this.slopes();
    return [this.width * (0.5 + dot(away, right) / (depth * sx * 2)),
            this.height * (0.5 - dot(away, up) / (depth * sy * 2)), depth];
  }

  /// The point at a pixel, as far before the eye as `depth` says.
  pointAt(x, y, depth) {
    const {right, up, back} = this.axes();
    const [sx, sy] = this.slopes();
    const across = add(scaled(right, (2 * x / this.width - 1) * sx), scaled(up, (1 - 2 * y / this.height) * sy));
    return add(this.eye(), scaled(sub(across, back), depth));
  }

  pixelsPerMetre(depth) { return this.height / (2 * depth * this.slopes()[1]); }

  turn(dx, dy) {
    this.yaw = wrapped(this.yaw - dx * kTurnPerPixel);
    this.pitch = clamp(this.pitch + dy * kTurnPerPixel, -Math.PI / 2, Math.PI / 2);
  }

  pan(dx, dy) {
    const {right, up} = this.axes();
    const metres = 1 / this.pixelsPerMetre(this.distance);
    this.moveTarget(add(this.target, add(scaled(right, -dx * metres), scaled(up, dy * metres))));
  }

  /// Keeps the target near what there is to see, so that nobody gets lost.
  moveTarget(target) {
    const slack = 2 * this.radius;
    this.target = target.map((value, axis) => clamp(value, this.least[axis] - slack, this.most[axis] + slack));
  }

  /// Nearer (factor < 1) or farther; what is at `anchor` stays where it is in the picture.
  zoom(factor, anchor = this.target) {
    const distance = clamp(this.distance * factor, kLeastDistance_m, 12 * this.radius);
    const applied = distance / this.distance;
    this.distance = distance;
    this.moveTarget(add(anchor, scaled(sub(this.target, anchor), applied)));
  }

  /// Target and distance from which the whole box is seen in a direction, with a margin.
  fitting(yaw, pitch) {
    const trial = Object.assign(new Camera(this.least, this.most), {yaw, pitch, width: this.width, height: this.height});
    const {right, up, back} = trial.axes();
    const slopes = trial.slopes().map((slope) => slope * 0.92);
    const corners = cornersOf(this.least, this.most);
    for (let round = 0; round < 6; ++round) {
      const places = corners.map((corner) => sub(corner, trial.target));
      trial.distance = Math.max(kLeastDistance_m, ...places.map((away) => dot(away, back) +
          Math.max(Math.abs(dot(away, right)) / slopes[0], Math.abs(dot(away, up)) / slopes[1])));
      // What is near looks larger, so the middle of the box is not the middle of the picture.
      for (const axis of [right, up]) {
        const seen = places.map((away) => dot(away, axis) / (trial.distance - dot(away, back)));
        trial.target = add(trial.target, scaled(axis, (Math.min(...seen) + Math.max(...seen)) / 2 * trial.distance));
      }
    }
    return {target: trial.target, yaw, pitch, distance: trial.distance};
  }

  state() { return {target: this.target, yaw: this.yaw, pitch: this.pitch, distance: this.distance}; }

  /// A share of the way between two states, the short way round.
  between(from, to, share) {
    this.yaw = wrapped(from.yaw + wrapped(to.yaw - from.yaw) * share);
    this.pitch = mix(from.pitch, to.pitch, share);
    this.distance = from.distance * Math.pow(to.distance / from.distance, share);
    this.target = from.target.map((value, axis) => mix(value, to.target[axis], share));
  }
}
