// The four-bar linkage as the program has computed it: joints and elevation at even steps of the crank's angle
// theta_input, which the ground bar is the zero of. x forward, z up, metres, from the crank's pivot.

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

  /// What all positions together cover, with the laser's line of this length.
  bounds(beam) {
    let [least, most] = [[0, 0], [0, 0]];
    const include = (p) => {
      least = least.map((value, axis) => Math.min(value, p[axis]));
      most = most.map((value, axis) => Math.max(value, p[axis]));
    };
    include(this.rockerPivot);
    for (let k = 0; k < this.about.steps; ++k) {
      const pose = this.row(k) && this.at(k);
      if (!pose) continue;
      include(pose.a);
      include(pose.b);
      include(this.beamEnd(pose, beam));
    }
    return [least, most];
  }

  beamEnd(pose, length) {
    return [this.rockerPivot[0] + length * Math.cos(pose.elevation), this.rockerPivot[1] + length * Math.sin(pose.elevation)];
  }
}
