// The time slider: what was measured until then is shown, and where the robot was.

const kSpeeds = [0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500];
const kWholeRun_s = 45;  // the speed at first plays the log in about this time
const kLongestStep_s = 0.25;  // of the clock on the wall: a tab that was hidden goes on where it was

/// The target goes with the robot; whoever moves the picture has the camera stay.
const isFollowing = () => byId('follow').checked;
const stopFollowing = () => { byId('follow').checked = false; };
function followRobot(cloudView, pose) {
  if (isFollowing() && pose) cloudView.camera.moveTarget([pose.x, pose.y, cloudView.floor + 0.3]);
}

class Timeline {
  constructor(cloudView) {
    this.cloudView = cloudView;
    [this.button, this.slider, this.value, this.speed] = ['play', 'time', 'time-value', 'time-speed'].map(byId);
    byId('timeline').hidden = false;
    byId('follow-label').hidden = !cloudView.path;
    const suited = kSpeeds.find((speed) => timeSpan.extent / speed <= kWholeRun_s) ?? kSpeeds.at(-1);
    for (const speed of kSpeeds) this.speed.append(element('option', {value: speed, textContent: `${speed} ×`, selected: speed === suited}));
    this.button.addEventListener('click', () => this.toggle());
    this.slider.addEventListener('input', () => this.set(Number(this.slider.value)));
    this.show();
  }

  toggle() {
    this.isPlaying = !this.isPlaying;
    this.button.textContent = this.isPlaying ? 'Pause' : 'Play';
    if (!this.isPlaying) return;
    if (view.until >= 1) this.set(0);
    this.last = performance.now();
    requestAnimationFrame((now) => this.step(now));
  }

  step(now) {
    if (!this.isPlaying) return;
    const passed_s = clamp((now - this.last) / 1000, 0, kLongestStep_s) * Number(this.speed.value);
    this.last = now;
    this.set(Math.min(view.until + passed_s / timeSpan.extent, 1));
    if (view.until >= 1) this.toggle();
    else requestAnimationFrame((later) => this.step(later));
  }

  set(until) {
    view.until = until;
    followRobot(this.cloudView, this.cloudView.path?.poseAt(shownTime()));
    this.show();
    view.changed('time');
    this.cloudView.moved();
  }

  show() {
    this.slider.value = view.until;
    const digits = timeSpan.extent < 1000 ? 1 : 0;
    this.value.textContent = `${(view.until * timeSpan.extent).toFixed(digits)} of ${timeSpan.extent.toFixed(digits)} s`;
    this.slider.setAttribute('aria-valuetext', this.value.textContent);
  }
}
