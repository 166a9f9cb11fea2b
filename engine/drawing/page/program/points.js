// The cloud's points, as they lie in memory and on the graphics processor: 12 bytes each (viewer/scene/cloud/page.cpp).

const kQuantities = {
  height: {name: 'Height', unit: 'm', factor: 1},
  elevation: {name: 'Elevation', unit: '°', factor: 180 / Math.PI},
  time: {name: 'Time', unit: 's', factor: 1},
  scan: {name: 'Scan', unit: '', factor: 1},
  distance: {name: 'Distance', unit: 'm', factor: 1},
};

class Points {
  constructor(about) {
    this.about = about;
    this.least = about.least;
    this.extent = sub(about.most, about.least);
    this.elements = [];
    this.loaded = 0;
    // A point is as wide as points lie apart, taken as spread over the sides of the middle box.
    const [x, y, z] = sub(about.middle_most, about.middle_least).map((side) => Math.max(side, 0.01));
    this.spacing = clamp(1.6 * Math.sqrt(2 * (x * y + y * z + z * x) / about.count), 0.002, (x + y + z) / 60);
  }

  /// Decodes the next element; false when there is none.
  takeNext() {
    if (this.elements.length >= this.about.elements) return false;
    const bytes = takeBytes('points-' + this.elements.length);
    this.elements.push({bytes, words: new Uint16Array(bytes.buffer, 0, bytes.length / 2), count: bytes.length / 12});
    this.loaded += bytes.length / 12;
    return true;
  }

  upload(gl, part) {
    const buffer = bufferOf(gl, part.bytes);
    part.array = vertexArray(gl, buffer, [[0, 3, gl.UNSIGNED_SHORT, true, 12, 0], [1, 1, gl.UNSIGNED_SHORT, true, 12, 6],
                                          [2, 4, gl.UNSIGNED_BYTE, true, 12, 8]]);
  }

  /// Draws the given share of the points; any beginning of them is spread evenly over the log.
  draw(gl, share) {
    let left = Math.ceil(this.loaded * share);
    for (const part of this.elements) {
      if (left <= 0) break;
      if (!part.array) this.upload(gl, part);
      gl.bindVertexArray(part.array);
      gl.drawArrays(gl.POINTS, 0, Math.min(part.count, left));
      left -= part.count;
    }
    gl.bindVertexArray(null);
  }

  /// What the vertex shader draws: not later than `until` (share of the cloud's times), levels shown.
  isShown(part, k, until, levels) {
    const level = part.bytes[12 * k + 11];
    return part.words[6 * k + 3] <= until && !(level === 1 && !levels.floor) && !(level === 2 && !levels.ceiling);
  }

  countShown(until, levels) {
    const limit = until * 65535;
    let count = 0;
    for (const part of this.elements) {
      for (let k = 0; k < part.count; ++k) count += this.isShown(part, k, limit, levels) ? 1 : 0;
    }
    return count;
  }

  /// Of a point: place in the page's frame and what was measured.
  at(part, k) {
    const {bytes, words} = part;
    const position = [0, 1, 2].map((axis) => words[6 * k + axis] / 65535 * this.extent[axis]);
    const value = (quantity, share) => {
      const range = this.about[quantity];
      return range && mix(range.least, range.most, share);
    };
    return {position, height: position[2] + this.least[2], time: value('time', words[6 * k + 3] / 65535),
            elevation: value('elevation', bytes[12 * k + 8] / 255), scan: value('scan', bytes[12 * k + 9] / 255),
            distance: value('distance', bytes[12 * k + 10] / 255)};
  }

  /// Quantities that differ from point to point.
  quantities() {
    return Object.keys(kQuantities).filter((key) => this.about[key] && this.about[key].most > this.about[key].least);
  }
}
