// Puts the page together. `window.gdtslam` is for tests and for the browser's console.

const page = {ready: false, errors: [], description, view, picks, theme};
window.gdtslam = page;
window.addEventListener('error', (event) => page.errors.push(String(event.message)));
window.addEventListener('unhandledrejection', (event) => page.errors.push(String(event.reason)));

function showMessage(text) {
  byId('message').textContent = text;
  byId('message').hidden = false;
}

/// Whether the processor does the work of a graphics processor, so that less must do.
function drawsInSoftware() {
  const gl = element('canvas').getContext('webgl2');
  const about = gl && gl.getExtension('WEBGL_debug_renderer_info');
  const renderer = about ? gl.getParameter(about.UNMASKED_RENDERER_WEBGL) : '';
  gl?.getExtension('WEBGL_lose_context')?.loseContext();
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(renderer);
}

/// WebGL 2, or a message that says what to do.
function makeCloudView() {
  const canvas = byId('scene');
  const isSoftware = drawsInSoftware();
  const gl = canvas.getContext('webgl2', {antialias: !isSoftware, alpha: false, stencil: true,
                                          powerPreference: 'high-performance'});
  if (!gl) {
    showMessage('This browser shows no WebGL 2, which the cloud is drawn with. Switch on hardware acceleration in its settings, or ' +
                'open the page in a current Firefox, Chrome, Edge or Safari.');
    return null;
  }
  canvas.addEventListener('webglcontextlost', (event) => {
    event.preventDefault();
    showMessage('The graphics driver was reset. The picture comes back as soon as the driver does.');
  });
  const cloudView = new CloudView(canvas, gl, isSoftware);
  canvas.addEventListener('webglcontextrestored', () => location.reload());
  return cloudView;
}

/// Decodes the points element by element, so that the page answers meanwhile.
async function loadPoints(cloudView) {
  const points = cloudView.points;
  while (points && points.takeNext()) {
    byId('loading').textContent = `${grouped(points.loaded)} of ${grouped(points.about.count)} points`;
    cloudView.moved();
    await new Promise((resolve) => setTimeout(resolve));
  }
  byId('loading').textContent = '';
}

function showStage(stage) {
  byId('main').dataset.stage = stage;
  byId('cloud-stage').hidden = stage === 'linkage';
  byId('linkage-stage').hidden = stage === 'cloud';
  byId('panel').hidden = stage === 'linkage' && description.facts.length === 0 && !description.live;
  byId('timeline').hidden = stage === 'linkage' || !(page.timeline || page.drive);
  for (const button of byId('stages').children) button.setAttribute('aria-pressed', String(button.dataset.stage === stage));
}

function togglePanel() {
  const isHidden = document.body.classList.toggle('is-bare');
  byId('panel-toggle').setAttribute('aria-expanded', String(!isHidden));
}

function toggleFullScreen() {
  if (document.fullscreenElement) document.exitFullscreen();
  else document.documentElement.requestFullscreen().catch(() => showBriefly('This browser does not allow full screen here.'));
}

function showBriefly(text) {
  byId('loading').textContent = text;
  setTimeout(() => { byId('loading').textContent = ''; }, 2500);
}

function save() {
  if (!page.cloudView || byId('cloud-stage').hidden) {
    savePicture(byId('mechanism'));
    return;
  }
  page.cloudView.draw(1);  // in this same turn, while the picture is still there
  savePicture(page.cloudView.canvas, page.overlay.canvas);
}

/// Buttons of the top, and the keys that do the same.
function connectTop() {
  const openHelp = () => byId('help').showModal();
  const actions = {save, theme: () => theme.toggle(), full: toggleFullScreen, 'help-open': openHelp, 'panel-toggle': togglePanel};
  for (const [id, action] of Object.entries(actions)) byId(id).addEventListener('click', action);
  for (const button of byId('stages').children) button.addEventListener('click', () => showStage(button.dataset.stage));
  return {s: save, t: actions.theme, Enter: toggleFullScreen, '?': openHelp, h: togglePanel};
}

async function start() {
  document.documentElement.classList.toggle('is-flat', Boolean(!description.cloud && (description.map || description.live)));
  theme.follow();
  byId('title').textContent = description.title;
  byId('subtitle').textContent = description.subtitle;
  byId('subtitle').hidden = description.subtitle === '';
  if (description.atlas) {
    showAtlas(description.atlas);
    return;
  }
  const pageKeys = connectTop();
  const hasScene = Boolean(description.cloud || description.path || description.map || description.live);
  byId('stages').hidden = !(hasScene && description.linkage);
  showStage(hasScene ? 'cloud' : 'linkage');
  if (description.linkage) page.linkageView = new LinkageView(new Linkage(description.linkage));
  fillHelp({scene: hasScene, points: Boolean(description.cloud), time: timeSpan.extent > 0}, Boolean(description.linkage));
  page.cloudView = hasScene ? makeCloudView() : null;
  page.panel = new Panel(page.cloudView);
  let cloudActions = {};
  if (page.cloudView) {
    page.camera = page.cloudView.camera;
    page.overlay = new Overlay(byId('overlay'), page.cloudView);
    page.pointer = new PointerControl(byId('scene'), page.cloudView);
    if (timeSpan.extent > 0) page.timeline = new Timeline(page.cloudView);
    picks.watchers.push(showReadout);
    cloudActions = cloudKeys(page.cloudView, page.panel, page.timeline);
  }
  listenToKeys(pageKeys, page.cloudView, cloudActions, page.linkageView);
  showStage(hasScene ? 'cloud' : 'linkage');
  if (!page.cloudView) return;
  if (description.live) page.drive = new Drive(page.cloudView, page.panel);
  await loadPoints(page.cloudView);
  page.pointsShown = () => pointsShown(page.cloudView);
  view.changed();
}

start().then(() => { page.ready = true; }, (error) => {
  page.errors.push(String(error));
  showMessage(`The page could not be shown: ${error.message}`);
  throw error;
});
