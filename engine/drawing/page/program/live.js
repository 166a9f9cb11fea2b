// A drive that goes on (gdtslam live --page): asks its program for the newest scan some ten times a second, and for the
// map where there is another one. The next drive at the same address has a page of its own.

const kAsk_ms = 100;
const kSilent_s = 3;       // without an answer, or without a scan, that are told
const kGivenUp_ms = 10000;
const kMostTrail = 4000;   // poses

const wait = (time_ms) => new Promise((resolve) => setTimeout(resolve, time_ms));

class Drive {
  constructor(cloudView, panel) {
    Object.assign(this, {cloudView, panel, scan: null, scans: 0, map: 0, trail: [], trailSpacing_m: 0.05});
    this.answeredAt = this.scannedAt = performance.now();
    for (const id of ['play', 'time', 'time-value', 'time-speed']) byId(id).hidden = true;
    byId('timeline').querySelector('[for=time-speed]').hidden = true;
    byId('state').hidden = byId('timeline').hidden = false;
    byId('follow').checked = true;
    setInterval(() => this.showSilence(), 1000);
    this.run();
  }

  async run() {
    for (;; await wait(kAsk_ms)) {
      try {
        await this.ask();
        this.answeredAt = performance.now();
        this.say('live');
      } catch {
        if (this.scans > 0) this.trail.push(null);  // where the robot goes meanwhile is not known
        this.say('no connection: the drive has ended, or is out of reach', 'is-gone');
        await wait(1000);
      }
    }
  }

  async fetched(path) {
    const answer = await fetch(path, {cache: 'no-store', signal: AbortSignal.timeout(kGivenUp_ms)});
    if (!answer.ok) throw new Error(`${path}: ${answer.status}`);
    return answer.json();
  }

  async ask() {
    const news = await this.fetched(`/scan/${this.scan?.scan ?? 0}`);
    if (news.drive !== description.drive) location.reload();
    description.origin = news.origin;
    if (news.map !== this.map) this.takeMap(news.map, await this.fetched('/map'));
    if (news.figures) this.takeScan(news);
  }

  /// Path and map as in a page of a run, with the poses of so many scans.
  takeMap(version, {scans, ...layers}) {
    this.map = version;
    Object.assign(description, layers);
    timeSpan = timeSpanOf(description);
    const from = this.trail.findIndex((pose) => pose && pose[3] > scans);  // the path has those before
    if (layers.path) this.trail = from < 0 ? [] : this.trail.slice(from);
    this.cloudView.takeAgain();
    this.showTrail();
  }

  takeScan(scan) {
    if (scan.scan !== this.scan?.scan) this.scannedAt = performance.now();
    this.scan = scan;
    ++this.scans;
    const {cloudView} = this;
    const [x0, y0] = description.origin;
    cloudView.pose = scan.pose && {x: scan.pose[0] - x0, y: scan.pose[1] - y0, heading: scan.pose[2]};
    const places = [];
    for (let k = 0; k + 1 < scan.points.length; k += 2) {
      places.push(scan.points[k] / 100 - x0, scan.points[k + 1] / 100 - y0, cloudView.floor + 0.04);
    }
    release(cloudView.gl, cloudView.scan);
    cloudView.scan = new FlatShape(cloudView.gl, cloudView.gl.POINTS, places);
    this.followTrail(scan.pose && [cloudView.pose.x, cloudView.pose.y, scan.pose[2], scan.scan]);
    followRobot(cloudView, cloudView.pose);
    this.showFigures();
    cloudView.request();
  }

  /// Poses since the map's path, null where the robot was lost. The newest takes the place of one before that lies near.
  followTrail(pose) {
    const before = this.trail.at(-2);
    const isNear = before && this.trail.at(-1) && Math.hypot(before[0] - this.trail.at(-1)[0], before[1] - this.trail.at(-1)[1]) < this.trailSpacing_m;
    if (isNear && pose) this.trail.pop();
    if (pose || this.trail.at(-1)) this.trail.push(pose);
    if (this.trail.length > kMostTrail) {
      this.trail = this.trail.filter((one, k) => !one || k % 2 === 0);
      this.trailSpacing_m *= 2;
    }
    this.showTrail();
  }

  showTrail() {
    const poses = this.trail.filter((pose) => pose);
    const drives = [];
    this.trail.reduce((count, pose) => (pose ? count + 1 : (drives.push(count), count)), 0);
    release(this.cloudView.gl, this.cloudView.trail);
    const rows = new Float32Array(poses.flatMap(([x, y, heading]) => [x, y, heading, 1]));
    this.cloudView.trail = new Path({count: poses.length, drives, first: 0, last: 1}, rows);
    this.cloudView.trail.upload(this.cloudView.gl);
  }

  /// The rate is that of the last scans: where they have stopped it is none any more.
  showFigures() {
    const idle_s = Math.floor((performance.now() - this.scannedAt) / 1000);
    this.panel.showFacts(Object.entries(this.scan.figures).map(([name, value]) =>
        [name, name === 'rate' && idle_s >= kSilent_s ? `no scan for ${idle_s} s` : value, name === 'doubt' && this.scan.inDoubt ? 'doubt' : '']));
  }

  showSilence() {
    const isSilent = performance.now() - this.answeredAt >= 1000 * kSilent_s;
    if (isSilent && byId('state').className !== 'is-gone') this.say('nothing heard for some seconds', 'is-silent');
    if (this.scan) this.showFigures();
  }

  say(text, className = '') {
    if (byId('state').textContent !== text) byId('state').textContent = text;
    byId('state').className = className;
  }
}
