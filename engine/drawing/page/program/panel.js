// The panel at the side: colours, layers, camera, facts; made of what the page holds.

function group(title, ...children) {
  return element('div', {className: 'group', role: 'group', 'aria-label': title}, element('h2', {textContent: title}), ...children);
}

/// One that is not needed beside the linkage alone.
function cloudGroup(...of) {
  const made = group(...of);
  made.classList.add('of-cloud');
  return made;
}

function checkbox(label, layer, note = '') {
  const box = element('input', {type: 'checkbox', checked: view.layers[layer], id: 'layer-' + layer});
  box.addEventListener('change', () => {
    view.layers[layer] = box.checked;
    view.changed('layers');
  });
  return element('label', {className: 'check'}, box, element('span', {textContent: label}), element('span', {textContent: note}));
}

/// A slider with its name and what it says.
function slider(label, id, {min, max, step, value}, textOf, apply) {
  const input = element('input', {type: 'range', id, min, max, step});
  input.value = value;
  const output = element('output', {});
  output.setAttribute('for', id);
  const show = () => {
    output.textContent = textOf(Number(input.value));
    input.setAttribute('aria-valuetext', output.textContent);
  };
  input.addEventListener('input', () => {
    apply(Number(input.value));
    show();
  });
  show();
  const row = element('div', {className: 'row'}, element('label', {textContent: label, htmlFor: id}), input, output);
  return {row, input, show};
}

class Panel {
  constructor(cloudView) {
    this.cloudView = cloudView;
    this.chosenMaps = new Set();  // quantities
    this.root = byId('panel');
    if (cloudView) {
      if (cloudView.points) this.root.append(this.colours());
      this.root.append(this.layers(), this.camera());
      view.watchers.push(() => this.refresh());
    }
    this.facts();
    this.refresh();
  }

  /// Choices of quantity, colour map and scale.
  colours() {
    const keys = this.cloudView.points.quantities();
    for (const key of keys) {
      const {low, high, least, most} = description.cloud[key];
      view.scale[key] = high > low ? [key === 'distance' ? Math.min(least, 0) : low, high] : [least, most];
    }
    this.suitMaps(keys);
    theme.watchers.push(() => {
      this.suitMaps(keys);
      view.changed('colours');
    });
    view.quantity = keys[0] ?? 'plain';
    const choices = [...keys.map((key) => [key, kQuantities[key].name]), ['plain', 'One colour']];
    this.quantity = this.select('Colour by', 'quantity', choices, (key) => { view.quantity = key; });
    this.map = this.select('Colours', 'colour-map', colourMaps.map((map, k) => [k, map.name]),
                           (k) => {
                             view.colourMap[view.quantity] = Number(k);
                             this.chosenMaps.add(view.quantity);
                           });
    this.low = this.scaleSlider('From', 'scale-low', 0);
    this.high = this.scaleSlider('To', 'scale-high', 1);
    return cloudGroup('Colours', this.quantity.row, this.map.row, this.low.row, this.high.row);
  }

  /// Dark and light grounds have maps of their own, unless the user has chosen one.
  suitMaps(keys) {
    for (const key of keys) {
      if (!this.chosenMaps.has(key)) view.colourMap[key] = defaultMap();
    }
  }

  select(label, id, choices, apply) {
    const input = element('select', {id}, ...choices.map(([value, text]) => element('option', {value, textContent: text})));
    input.addEventListener('change', () => {
      apply(input.value);
      view.changed('colours');
    });
    return {input, row: element('div', {className: 'row is-wide'}, element('label', {textContent: label, htmlFor: id}), input)};
  }

  /// One end of the scale as a share of the quantity's range; the ends never cross.
  scaleSlider(label, id, end) {
    const textOf = () => {
      if (!(view.quantity in kQuantities)) return '';
      const {unit} = kQuantities[view.quantity];
      const value = shownScale(view.quantity)[end];
      return fixed(value, Math.abs(value) < 100 && unit !== '' ? 2 : 0) + (unit === '°' ? '°' : unit && ' ' + unit);
    };
    return slider(label, id, {min: 0, max: 1, step: 0.002, value: end}, textOf, (share) => {
      const {least, most} = description.cloud[view.quantity];
      const scale = view.scale[view.quantity];
      const value = mix(least, most, share);
      scale[end] = end === 0 ? Math.min(value, scale[1]) : Math.max(value, scale[0]);
      view.changed('scale');
    });
  }

  layers() {
    const {cloud, map, path, live} = description;
    const boxes = [];
    if (cloud) boxes.push(checkbox('Cloud', 'cloud', grouped(cloud.count)));
    if (cloud && cloud.floor) boxes.push(checkbox('Floor', 'floor', grouped(cloud.floor.points)));
    if (cloud && cloud.ceiling) boxes.push(checkbox('Ceiling', 'ceiling', grouped(cloud.ceiling.points)));
    if (path) boxes.push(checkbox('Path', 'path', path.length >= 0.05 ? `${path.length.toFixed(1)} m` : ''), checkbox('Robot', 'robot'));
    if (live) boxes.push(...[['Path', 'path'], ['Robot', 'robot'], ['Scan', 'scan'], ['Map', 'map']].map((box) => checkbox(...box)));
    if (map) boxes.push(checkbox('Map', 'map', `${grouped(map.width)} × ${grouped(map.height)}`));
    boxes.push(checkbox('Grid', 'grid', live ? '' : `${this.cloudView.grid.step} m`));
    this.shown = element('div', {className: 'note', id: 'shown'});
    return cloudGroup('Layers', ...boxes, ...(cloud ? [this.shown] : []));
  }

  camera() {
    const buttons = Object.entries(kPresets).map(([key, {name}]) => {
      const button = element('button', {type: 'button', textContent: name, id: 'preset-' + key});
      button.addEventListener('click', () => this.cloudView.flyTo(this.cloudView.fitted(kPresets[key])));
      return button;
    });
    const fit = element('button', {type: 'button', textContent: 'Fit', id: 'preset-fit', title: 'All in the picture (F)'});
    fit.addEventListener('click', () => this.cloudView.fit());
    const children = [element('div', {className: 'segments'}, ...buttons, fit)];
    if (this.cloudView.points) {
      this.size = slider('Points', 'point-size', {min: -2, max: 3, step: 0.05, value: 0},
                         (power) => `× ${Math.pow(2, power).toFixed(2)}`,
                         (power) => { view.pointFactor = Math.pow(2, power); view.changed('points'); });
      this.shading = slider('Shading', 'shading', {min: 0, max: 2, step: 0.02, value: view.shading},
                            (value) => `${Math.round(100 * value)} %`,
                            (value) => { view.shading = value; view.changed('shading'); });
      this.measure = element('button', {type: 'button', id: 'measure', textContent: 'Measure a distance', title: 'M'});
      this.measure.setAttribute('aria-pressed', 'false');
      this.measure.addEventListener('click', () => this.toggleMeasuring());
      children.push(this.size.row, this.shading.row, this.measure);
    }
    return cloudGroup('View', ...children);
  }

  toggleMeasuring() {
    picks.isMeasuring = !picks.isMeasuring;
    picks.set([]);
    this.measure.setAttribute('aria-pressed', String(picks.isMeasuring));
    this.measure.textContent = picks.isMeasuring ? 'End measuring' : 'Measure a distance';
    this.cloudView.canvas.classList.toggle('is-measuring', picks.isMeasuring);
  }

  facts() {
    const facts = [...description.facts];
    const {cloud} = description;
    if (cloud && cloud.of > cloud.count) facts.push(['Stray points left out', grouped(cloud.of - cloud.count)]);
    if (facts.length === 0 && !description.live) return;
    this.list = element('dl', {className: 'facts'});
    this.root.append(group('Facts', this.list));
    this.showFacts(facts);
  }

  /// Names and values; a third word is the class of a value that stands out.
  showFacts(facts) {
    this.list.replaceChildren(...facts.flatMap(([name, value, className = '']) =>
        [element('dt', {textContent: name}), element('dd', {textContent: value, className})]));
  }

  /// What depends on choices: the scale's ends, the colour map, how many points are shown.
  refresh() {
    if (!this.cloudView || !this.cloudView.points) return;
    const key = view.quantity;
    const hasScale = key in kQuantities;
    for (const part of [this.map, this.low, this.high]) part.row.hidden = !hasScale;
    this.quantity.input.value = key;
    if (hasScale) {
      this.map.input.value = String(view.colourMap[key]);
      const {least, most} = description.cloud[key];
      view.scale[key].forEach((value, end) => { [this.low, this.high][end].input.value = (value - least) / (most - least); });
      this.low.show();
      this.high.show();
    }
    this.countSoon();
  }

  /// Counting takes a pass over all points, so it waits until things rest.
  countSoon() {
    clearTimeout(this.counting);
    this.counting = setTimeout(() => {
      this.shown.textContent = `${grouped(pointsShown(this.cloudView))} points shown`;
    }, 120);
  }
}

function pointsShown(cloudView) {
  if (!cloudView.points || !view.layers.cloud) return 0;
  return cloudView.points.countShown(cloudShareOf(shownTime()), view.layers);
}
