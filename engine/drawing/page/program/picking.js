// Points under the cursor: searched among all that are shown, on the host, which takes some 10 ns a point.

const kPickRadius_px = 9;

/// The point that is seen nearest to the pixel: of those within the radius the one nearest to the eye, points farther
/// from the pixel counting as somewhat farther away.
function pickPoint(cloudView, x, y, radius = kPickRadius_px) {
  const {points, camera} = cloudView;
  if (!points || !view.layers.cloud) return null;
  const m = camera.matrix();
  const scale = points.extent.map((extent) => extent / 65535);
  const limit = cloudShareOf(shownTime()) * 65535;
  let best = null;
  let bestCost = Infinity;
  for (const part of points.elements) {
    const {words, count} = part;
    for (let k = 0; k < count; ++k) {
      const [px, py, pz] = [words[6 * k] * scale[0], words[6 * k + 1] * scale[1], words[6 * k + 2] * scale[2]];
      const w = m[3] * px + m[7] * py + m[11] * pz + m[15];
      if (w <= 0 || w > bestCost) continue;
      const dx = (0.5 + 0.5 * (m[0] * px + m[4] * py + m[8] * pz + m[12]) / w) * camera.width - x;
      if (dx > radius || dx < -radius) continue;
      const dy = (0.5 - 0.5 * (m[1] * px + m[5] * py + m[9] * pz + m[13]) / w) * camera.height - y;
      const away = (dx * dx + dy * dy) / (radius * radius);
      const cost = w * (1 + 0.05 * away);
      if (away > 1 || cost >= bestCost || !points.isShown(part, k, limit, view.layers)) continue;
      best = {part, k};
      bestCost = cost;
    }
  }
  return best && points.at(best.part, best.k);
}

/// Where a view ray meets the ground, for pages without a cloud and for zooming towards nothing.
function groundAt(cloudView, x, y) {
  const camera = cloudView.camera;
  const eye = camera.eye();
  const ray = sub(camera.pointAt(x, y, 1), eye);
  if (Math.abs(ray[2]) < 1e-6) return null;
  const along = (cloudView.floor - eye[2]) / ray[2];
  return along > 0 && along < 8 * camera.radius ? add(eye, scaled(ray, along)) : null;
}

/// Decimals that places of points have, whose sides are 16 bits, and quantities in their unit: time is 16 bits, others 8.
const placeDecimals = () => knownDecimals(Math.max(...sub(description.cloud.most, description.cloud.least)) / 65535, 3);
function decimalsOfQuantity(quantity, most) {
  const range = description.cloud[quantity];
  return knownDecimals((range.most - range.least) * kQuantities[quantity].factor / (quantity === 'time' ? 65535 : 255), most);
}

/// One point that was picked, two while measuring; shown beside the scene and in the overlay.
const picks = {
  points: [],
  isMeasuring: false,
  watchers: [],
  set(points) {
    this.points = points;
    for (const watcher of this.watchers) watcher();
  },
  take(point) {
    if (!point) this.set([]);
    else this.set(this.isMeasuring && this.points.length === 1 ? [...this.points, point] : [point]);
  },
  distance() { return this.points.length === 2 ? norm(sub(this.points[1].position, this.points[0].position)) : null; },
  lengthText() { return `${this.distance().toFixed(placeDecimals())} m`; },
};

/// The largest distance is also that of all points which were farther than was searched.
function distanceText(distance) {
  const {least, most} = description.cloud.distance;
  const decimals = decimalsOfQuantity('distance', 3);
  if (distance < most - (most - least) / 510) return `${distance.toFixed(decimals)} m`;
  const unit = Math.pow(10, -decimals);
  return `at least ${(Math.floor(most / unit + 1e-4) * unit).toFixed(decimals)} m`;
}

/// Name and value of what is known of a point.
function rowsOf(point) {
  const at = add(point.position, description.origin);
  const about = description.cloud;
  const rows = ['x', 'y', 'z'].map((name, axis) => [name, fixed(at[axis], placeDecimals()) + ' m']);
  const has = (quantity) => about[quantity] && about[quantity].most > about[quantity].least;
  if (has('time')) rows.push(['time', fixed(point.time - cloudBegin, decimalsOfQuantity('time', 2)) + ' s']);
  if (has('elevation')) rows.push(['elevation', fixed(degrees(point.elevation), decimalsOfQuantity('elevation', 1)) + '°']);
  if (has('distance')) rows.push(['distance', distanceText(point.distance)]);
  return rows;
}

function showReadout() {
  const box = byId('readout');
  box.hidden = picks.points.length === 0 && !picks.isMeasuring;
  box.replaceChildren();
  if (picks.isMeasuring && picks.points.length < 2) {
    box.append(element('div', {textContent: picks.points.length ? 'Click the second point.' : 'Click the first point.'}));
  }
  if (picks.points.length === 1) {
    const rows = rowsOf(picks.points[0]).map(([name, value]) => element('tr', {}, element('th', {textContent: name}),
                                                                       element('td', {textContent: value})));
    box.append(element('table', {}, ...rows));
  }
  if (picks.points.length === 2) {
    const [dx, dy, dz] = sub(picks.points[1].position, picks.points[0].position)
        .map((value) => fixed(value, placeDecimals()));
    box.append(element('p', {textContent: `Distance ${picks.lengthText()}`}));
    box.append(element('div', {textContent: `x ${dx}, y ${dy}, z ${dz} m`}));
  }
}
