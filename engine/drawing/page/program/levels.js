// Choices of the user; at first without the ceiling, which hides the rooms. Everything that draws reads them, and a change
// ends with changed().

const view = {
  layers: {cloud: true, floor: true, ceiling: false, path: true, robot: true, scan: true, map: true, grid: true},
  quantity: 'plain',
  colourMap: {},       // of each quantity: index into colourMaps
  scale: {},           // of each quantity: [low, high] in its unit of the description
  pointFactor: 1,
  shading: 1,          // strength of the eye-dome lighting
  until: 1,            // share of the time line
  watchers: [],
  changed(what = '') {
    for (const watcher of this.watchers) watcher(what);
  },
};

/// Whether cloud and path tell time by one clock. Else the log's clock was set: time is that of the path, whose times go
/// on there, and the cloud is shown whole.
const hasOneClock = ({path}) => !path || path.log_times === 1;

/// The stretch of time that cloud and path take together, in the log's clock; a cloud without times takes none.
function timeSpanOf({cloud, path}) {
  const hasTimes = cloud && (!path || (cloud.time.most > cloud.time.least && hasOneClock({path})));
  const time = hasTimes ? cloud.time : {least: Infinity, most: -Infinity};
  const from = Math.min(time.least, path ? path.first : Infinity);
  const to = Math.max(time.most, path ? path.last : -Infinity);
  return {from, to, extent: to - from};
}
let timeSpan = timeSpanOf(description);  // of a drive that goes on another one with each map
/// What the times of the cloud's points are counted from.
const cloudBegin = hasOneClock(description) ? timeSpan.from : description.cloud?.time.least;
const shownTime = () => timeSpan.from + view.until * timeSpan.extent;
/// A stamp as a share of the cloud's times; beyond the last one everything is shown.
function cloudShareOf(stamp) {
  const {least, most} = description.cloud.time;
  if (view.until >= 1 || !(most > least) || !hasOneClock(description)) return 1;
  return clamp((stamp - least) / (most - least), -0.001, 1);
}
