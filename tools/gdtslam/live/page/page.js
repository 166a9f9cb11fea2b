"use strict";
const canvas = document.getElementById("view");
const context = canvas.getContext("2d");
const state = document.getElementById("state");
const figures = document.getElementById("figures");
const follow = document.getElementById("follow");
const kMostScale = 400;   // pixels a metre
const kLeastScale = 0.5;
const kFirstScale = 30;

const kSilent_s = 3;      // that nothing was heard, though the server says something each 2 s
const kIdle_s = 3;        // that no scan came, and the rate is none any more
const kGivenUp_s = 10;    // at first: a slow line may take longer for a map
const kMostPatience_s = 160;

// What was heard last. Tests look at it.
const live = {drive: null, map: null, scan: null, maps: 0, scans: 0, errors: []};
window.gdtslamLive = live;
const camera = {x: 0, y: 0, scale: kFirstScale};
let picture = null;       // the map in the colours of the page
let trail = [];           // poses and their scans since the map's path, null where the way between two is not known
let isDue = false;
const kMostTrail = 20000;
const kTrailSpacing_m = 0.05;  // at first
let trailSpacing_m = kTrailSpacing_m;

function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

// "#fdfcfa" or "#fff" as three numbers.
function channels(name) {
  const text = colour(name).slice(1);
  const size = text.length / 3;
  return [0, 1, 2].map((k) => parseInt(text.slice(size * k, size * (k + 1)).repeat(3 - size), 16));
}

// Black, grey and white of the map become the colours of walls, of what is unknown and of free floor.
function paint() {
  if (!live.map) return;
  const {bitmap} = live.map;
  picture = new OffscreenCanvas(bitmap.width, bitmap.height);
  const target = picture.getContext("2d", {willReadFrequently: true});
  target.drawImage(bitmap, 0, 0);
  const image = target.getImageData(0, 0, bitmap.width, bitmap.height);
  const wall = channels("--wall"), unknown = channels("--unknown"), free = channels("--free");
  for (let k = 0; k < image.data.length; k += 4) {
    const grey = image.data[k];
    const [red, green, blue] = grey < 64 ? wall : grey < 192 ? unknown : free;
    image.data[k] = red;
    image.data[k + 1] = green;
    image.data[k + 2] = blue;
  }
  target.putImageData(image, 0, 0);
}

function place(x, y) {
  return [canvas.width / 2 + (x - camera.x) * camera.scale, canvas.height / 2 - (y - camera.y) * camera.scale];
}

function drawMap() {
  if (!picture) return;
  const {header} = live.map;
  const [left, bottom] = place(...header.corner_m);
  const width = header.width * header.pixel_m * camera.scale, height = header.height * header.pixel_m * camera.scale;
  context.imageSmoothingEnabled = header.pixel_m * camera.scale < 1;
  context.drawImage(picture, left, bottom - height, width, height);
}

function drawPath() {
  const path = live.map ? live.map.header.path : [];
  context.strokeStyle = colour("--path");
  context.lineWidth = 2 * devicePixelRatio;
  context.lineJoin = "round";
  context.beginPath();
  for (let k = 0; k + 1 < path.length; k += 2) context.lineTo(...place(path[k] / 100, path[k + 1] / 100));
  let isGap = false;
  for (const pose of trail) {
    if (pose && isGap) context.moveTo(...place(pose[0], pose[1]));
    else if (pose) context.lineTo(...place(pose[0], pose[1]));
    isGap = !pose;
  }
  context.stroke();
}

function drawScan() {
  if (!live.scan || !live.scan.pose) return;
  const {pose, points} = live.scan, size = 3 * devicePixelRatio;
  context.fillStyle = colour("--scan");
  for (let k = 0; k + 1 < points.length; k += 2) {
    const [x, y] = place(points[k] / 100, points[k + 1] / 100);
    context.fillRect(x - size / 2, y - size / 2, size, size);
  }
  const [x, y] = place(pose[0], pose[1]), reach = 11 * devicePixelRatio;
  context.save();
  context.translate(x, y);
  context.rotate(-pose[2]);
  context.beginPath();
  context.moveTo(reach, 0);
  context.lineTo(-0.7 * reach, 0.7 * reach);
  context.lineTo(-0.35 * reach, 0);
  context.lineTo(-0.7 * reach, -0.7 * reach);
  context.closePath();
  context.fillStyle = colour("--robot");
  context.fill();
  context.lineWidth = 1.5 * devicePixelRatio;
  context.strokeStyle = colour("--card");
  context.stroke();
  context.restore();
}

function draw() {
  isDue = false;
  const width = Math.round(canvas.clientWidth * devicePixelRatio), height = Math.round(canvas.clientHeight * devicePixelRatio);
  if (canvas.width !== width || canvas.height !== height) {
    canvas.width = width;
    canvas.height = height;
  }
  if (isFollowing() && live.scan && live.scan.pose) [camera.x, camera.y] = live.scan.pose;
  context.fillStyle = colour("--unknown");
  context.fillRect(0, 0, canvas.width, canvas.height);
  drawMap();
  drawPath();
  drawScan();
}

function drawSoon() {
  if (!isDue) requestAnimationFrame(draw);
  isDue = true;
}

function showFigures() {
  const rows = Object.entries(live.scan ? live.scan.figures : {}).map(([name, value]) => {
    const row = document.createElement("div");
    if (name === "doubt" && live.scan.inDoubt) row.className = "doubt";
    const term = document.createElement("dt"), text = document.createElement("dd");
    term.textContent = name;
    text.textContent = value;
    if (name === "rate") text.id = "rate";
    row.append(term, text);
    return row;
  });
  figures.replaceChildren(...rows);
  showRate();
}

// The rate is that of the last scans: where they have stopped, though the drive gives signs of life, it is none any more.
function showRate() {
  const rate = document.getElementById("rate");
  if (!rate) return;
  const idle_s = Math.floor((performance.now() - scannedAt) / 1000);
  const text = idle_s < kIdle_s ? live.scan.figures.rate : `no scan for ${idle_s} s`;
  if (rate.textContent !== text) rate.textContent = text;
}

// Whether a line needs both poses: they lie the spacing apart, or a quarter of it where the robot has turned (0.2 rad).
function isApart(from, to) {
  const away_m = Math.hypot(to[0] - from[0], to[1] - from[1]);
  const hasTurned = Math.abs(Math.sin((to[2] - from[2]) / 2)) > 0.1;
  return away_m >= (hasTurned ? trailSpacing_m / 4 : trailSpacing_m);
}

// The newest pose is among the poses until the next one comes, and stays if it lies apart from the one before it.
function addPose(poses, pose) {
  if (!pose) {
    if (poses.at(-1) !== null) poses.push(null);
    return poses;
  }
  const newest = poses.findLastIndex((one) => one);
  const before = poses.findLastIndex((one, k) => one && k < newest);
  if (before >= 0 && !isApart(poses[before], poses[newest])) {
    const hasGap = poses.includes(null, before);
    poses.length = before + 1;
    if (hasGap) poses.push(null);
  }
  poses.push(pose);
  return poses;
}

// What the path of a map has by now goes; a gap that is left, stays.
function shortenTrail(scans) {
  const from = trail.findIndex((pose) => pose && pose[3] > scans);
  const begin = from < 0 ? trail.length : from;
  trail = trail.slice(trail[begin - 1] === null ? begin - 1 : begin);
}

// A trail that is too long gets a wider spacing, the same from its begin to its end.
function followTrail(pose) {
  if (trail.length === 0) trailSpacing_m = kTrailSpacing_m;
  addPose(trail, pose);
  while (trail.length > kMostTrail) {
    trailSpacing_m *= 2;
    trail = trail.reduce((poses, one) => addPose(poses, one), []);
  }
}

function forgetMap() {
  if (live.map) live.map.bitmap.close();
  live.map = null;
  picture = null;
}

// Another drive may follow at the same address: nothing of the one before belongs to it.
function takeDrive(drive) {
  if (drive === live.drive) return;
  if (live.drive) {
    setFollowing(true);
    patience_s = kGivenUp_s;
  }
  live.drive = drive;
  live.scan = null;
  trail = [];
  forgetMap();
  showFigures();
  drawSoon();
}

let newestMap = 0;        // of those that were begun: pictures are read beside each other

async function takeMap(data) {
  const size = new DataView(data).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 4, size)));
  takeDrive(header.drive);
  const mine = ++newestMap;
  const bitmap = await createImageBitmap(new Blob([new Uint8Array(data, 4 + size)], {type: "image/png"}));
  if (mine !== newestMap || header.drive !== live.drive) return bitmap.close();
  forgetMap();
  live.map = {header, bitmap};
  ++live.maps;
  if (header.path.length > 0) shortenTrail(header.scans);
  paint();
  drawSoon();
}

function takeScan(text) {
  const scan = JSON.parse(text);
  takeDrive(scan.drive);
  if (scan.title) document.title = document.querySelector("h1").textContent = scan.title;
  if (!scan.figures) return;  // there is nothing new
  if (scan.scan !== live.scan?.scan) scannedAt = performance.now();  // after a reconnection the newest one comes again
  live.scan = scan;
  ++live.scans;
  followTrail(scan.pose && [...scan.pose, scan.scan]);
  showFigures();
  drawSoon();
}

function say(text, kind) {
  if (state.textContent !== text) state.textContent = text;
  state.className = kind;
}

// Seconds that go by are for the eye alone: read aloud each second they were in the way.
function saySilent(seconds) {
  if (state.className !== "silent") {
    say("nothing heard", "silent");
    const count = document.createElement("span");
    count.setAttribute("aria-hidden", "true");
    state.append(count);
  }
  state.lastChild.textContent = ` for ${seconds} s`;
}

let socket = null;
let heardAt = 0;          // performance.now() of the last message, or of when it was asked for
let hasHeard = false;
let scannedAt = 0;        // performance.now() of the newest scan
// What a slow line has taught stays for the drive: each connection begins with a sign of life, however long the map takes.
let patience_s = kGivenUp_s;

function takeMessage(data) {
  heardAt = performance.now();
  hasHeard = true;
  if (state.className !== "") say("live", "");
  if (typeof data === "string") takeScan(data);
  else takeMap(data).catch((error) => live.errors.push(String(error)));
}

// The drive may begin later, and a new one follows it: the page asks again. Where the robot went meanwhile is not known.
function connect() {
  heardAt = performance.now();
  const asked = socket = new WebSocket(`ws://${location.host}/`, "gdtslam-live");
  asked.binaryType = "arraybuffer";
  asked.onopen = () => {
    heardAt = performance.now();
    followTrail(null);
    say("live", "");
  };
  asked.onmessage = ({data}) => takeMessage(data);
  asked.onclose = disconnect;
}

function disconnect() {
  socket.onopen = socket.onmessage = socket.onclose = null;
  socket.close();
  socket = null;
  say(hasHeard ? "no connection: the drive has ended, or is out of reach" : "no drive here", "gone");
  setTimeout(connect, 2000);
}

// A connection that fails on the way may never say so.
setInterval(() => {
  if (!socket) return;
  const silent_s = Math.floor((performance.now() - heardAt) / 1000);
  if (silent_s >= patience_s) {
    patience_s = Math.min(kMostPatience_s, 2 * patience_s);
    disconnect();
  } else if (silent_s >= kSilent_s && socket.readyState === WebSocket.OPEN) saySilent(silent_s);
}, 250);
setInterval(showRate, 250);

function isFollowing() {
  return follow.getAttribute("aria-pressed") === "true";
}

function setFollowing(isOn) {
  follow.setAttribute("aria-pressed", String(isOn));
  drawSoon();
}

// At which all of the map is seen.
function wholeScale() {
  if (!live.map) return kLeastScale;
  const {width, height, pixel_m} = live.map.header;
  return Math.min(kMostScale, 0.94 * Math.min(canvas.width / (width * pixel_m), canvas.height / (height * pixel_m)));
}

function zoom(factor, x = canvas.width / 2, y = canvas.height / 2) {
  const least = Math.min(kLeastScale, wholeScale(), camera.scale);
  const scale = Math.min(kMostScale, Math.max(least, camera.scale * factor));
  if (!isFollowing()) {
    camera.x += (x - canvas.width / 2) * (1 / camera.scale - 1 / scale);
    camera.y -= (y - canvas.height / 2) * (1 / camera.scale - 1 / scale);
  }
  camera.scale = scale;
  drawSoon();
}

function showWhole() {
  setFollowing(false);
  if (!live.map) return;
  const {corner_m: [left, bottom], width, height, pixel_m} = live.map.header;
  camera.x = left + 0.5 * width * pixel_m;
  camera.y = bottom + 0.5 * height * pixel_m;
  camera.scale = wholeScale();
  drawSoon();
}

const pointers = new Map();
canvas.addEventListener("pointerdown", (event) => {
  canvas.setPointerCapture(event.pointerId);
  pointers.set(event.pointerId, event);
});
canvas.addEventListener("pointermove", (event) => {
  const before = pointers.get(event.pointerId);
  if (!before) return;
  const other = [...pointers.values()].find((one) => one.pointerId !== event.pointerId);
  if (other) {
    const apart = (one) => Math.hypot(one.clientX - other.clientX, one.clientY - other.clientY);
    zoom(apart(event) / Math.max(1, apart(before)));
  } else {
    setFollowing(false);
    camera.x -= (event.clientX - before.clientX) * devicePixelRatio / camera.scale;
    camera.y += (event.clientY - before.clientY) * devicePixelRatio / camera.scale;
  }
  pointers.set(event.pointerId, event);
  drawSoon();
});
for (const kind of ["pointerup", "pointercancel"]) {
  canvas.addEventListener(kind, (event) => pointers.delete(event.pointerId));
}
canvas.addEventListener("wheel", (event) => {
  event.preventDefault();
  zoom(Math.exp(-0.0015 * event.deltaY), event.offsetX * devicePixelRatio, event.offsetY * devicePixelRatio);
}, {passive: false});
canvas.addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey) return;  // the browser's
  const kStep = 80 * devicePixelRatio / camera.scale;
  const moves = {ArrowLeft: [-kStep, 0], ArrowRight: [kStep, 0], ArrowUp: [0, kStep], ArrowDown: [0, -kStep]};
  const zooms = {"+": 1.25, "=": 1.25, "-": 0.8};  // = is + without Shift
  if (event.key in zooms) zoom(zooms[event.key]);
  const move = moves[event.key];
  if (!move) return;
  event.preventDefault();
  setFollowing(false);
  camera.x += move[0];
  camera.y += move[1];
  drawSoon();
});
follow.addEventListener("click", () => setFollowing(!isFollowing()));
document.getElementById("whole").addEventListener("click", showWhole);
new ResizeObserver(drawSoon).observe(canvas);
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
  paint();
  drawSoon();
});
window.addEventListener("error", (event) => live.errors.push(event.message));
connect();
drawSoon();
