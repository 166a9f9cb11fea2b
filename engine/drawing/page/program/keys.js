// Keys, and the help that lists them.

const kHelp = [  // keys, what they do, and what the page must show for it
  ['Left drag, one finger', 'Turn', 'scene'], ['Right drag, Shift and drag, two fingers', 'Move', 'scene'],
  ['Wheel, pinch', 'Zoom towards the cursor', 'scene'], ['Click', 'Read a point', 'points'],
  ['Double click', 'Make a point the centre', 'scene'], ['Arrows', 'Turn; with Shift, move', 'scene'], ['+  −', 'Zoom', 'scene'],
  ['1  2  3  4', 'Top, iso, front, side', 'scene'], ['F', 'Fit into the picture', 'scene'], ['Space', 'Play or pause', 'time'],
  ['M', 'Measure a distance', 'points'], ['C', 'Next colour', 'points'], ['L', 'Floor and ceiling on or off', 'points'],
  ['[  ]', 'Smaller or larger points', 'points'], ['S', 'Save the picture as PNG'], ['T', 'Dark or light'],
  ['H', 'Panel on or off'], ['Enter', 'Full screen'], ['Esc', 'End measuring', 'points'], ['?', 'This help'],
];
const kLinkageHelp = [['Drag the crank or the mark', 'Turn the crank'], ['Left, right', 'Turn the crank by 1°'],
                      ['Space', 'Play or pause']];

/// shown: whether the page shows a scene, points and time.
function fillHelp(shown, hasLinkage) {
  const table = (rows) => element('table', {}, ...rows.map(([keys, what]) => element('tr', {},
      element('th', {textContent: keys, scope: 'row'}), element('td', {textContent: what}))));
  const rows = kHelp.filter(([, , need]) => !need || shown[need]);
  if (!shown.scene) {
    byId('help-body').append(table([...kLinkageHelp, ...rows]));
    return;
  }
  byId('help-body').append(table(rows));
  if (hasLinkage) byId('help-body').append(element('h2', {textContent: 'Linkage'}), table(kLinkageHelp));
}

/// Keys that move the camera; false for others.
function cameraKey(cloudView, event) {
  const camera = cloudView.camera;
  const arrows = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]};
  if (event.key in arrows) {
    const [dx, dy] = arrows[event.key].map((sign) => sign * 30);
    if (event.shiftKey) stopFollowing();
    if (event.shiftKey) camera.pan(-dx, -dy);
    else camera.turn(dx, dy);
  } else if (event.key === '+' || event.key === '=') {
    camera.zoom(0.85);
  } else if (event.key === '-') {
    camera.zoom(1 / 0.85);
  } else {
    return false;
  }
  cloudView.flight = null;
  cloudView.moved();
  return true;
}

/// What each other key does where a cloud is shown.
function cloudKeys(cloudView, panel, timeline) {
  const nextColour = () => {
    const keys = [...cloudView.points.quantities(), 'plain'];
    view.quantity = keys[(keys.indexOf(view.quantity) + 1) % keys.length];
    view.changed('colours');
  };
  const toggleLevels = () => {
    const isOn = !(view.layers.floor && view.layers.ceiling);
    for (const layer of ['floor', 'ceiling']) {
      view.layers[layer] = isOn;
      const box = byId('layer-' + layer);
      if (box) box.checked = isOn;
    }
    view.changed('layers');
  };
  const resize = (step) => {
    panel.size.input.value = Number(panel.size.input.value) + step;
    panel.size.input.dispatchEvent(new Event('input'));
  };
  const fly = (preset) => () => cloudView.flyTo(cloudView.fitted(preset));
  const keys = {1: fly(kPresets.top), 2: fly(kPresets.iso), 3: fly(kPresets.front), 4: fly(kPresets.side),
                f: () => cloudView.fit()};
  if (timeline) keys[' '] = () => timeline.toggle();
  if (cloudView.points) {
    Object.assign(keys, {c: nextColour, l: toggleLevels, m: () => panel.toggleMeasuring(), '[': () => resize(-0.25),
                         ']': () => resize(0.25),
                         Escape: () => (picks.isMeasuring ? panel.toggleMeasuring() : picks.set([]))});
  }
  return keys;
}

/// Keys belong to whatever control has the focus first.
function isForControl(event) {
  const tag = event.target.tagName;
  return event.ctrlKey || event.metaKey || event.altKey || byId('help').open || tag === 'SELECT' ||
      (tag === 'INPUT' && !(event.target.type === 'checkbox' && event.key !== ' ')) ||
      (tag === 'BUTTON' && (event.key === ' ' || event.key === 'Enter'));
}

function listenToKeys(pageKeys, cloudView, cloudActions, linkageView) {
  document.addEventListener('keydown', (event) => {
    if (isForControl(event)) return;
    const isLinkage = linkageView && (!cloudView || event.target.id === 'mechanism' || byId('cloud-stage').hidden);
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    let isDone = true;
    if (isLinkage && linkageView.key(event)) isDone = true;
    else if (!isLinkage && cloudView && cameraKey(cloudView, event)) isDone = true;
    else if (!isLinkage && cloudActions[key]) cloudActions[key]();
    else if (pageKeys[key]) pageKeys[key]();
    else isDone = false;
    if (isDone) event.preventDefault();
  });
}
