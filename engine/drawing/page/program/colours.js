// The page's colours: themes by the style's properties, colour maps by the description.

const colourMaps = (description.colour_maps ?? []).map((map) => ({name: map.name, doc: map.doc, bytes: bytesOfBase64(map.colours)}));

function hexColour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue('--' + name).trim();
}

/// A property of the style as red, green, blue from 0 to 1; properties may refer to others.
function colourOf(name) {
  let value = hexColour(name);
  const reference = /^var\(--(.+)\)$/.exec(value);
  if (reference) value = hexColour(reference[1]);
  const bits = parseInt(value.slice(1), 16);
  return [bits >> 16 & 255, bits >> 8 & 255, bits & 255].map((byte) => byte / 255);
}

function cssOfMap(map, share) {
  const k = 3 * Math.round(clamp(share, 0, 1) * 255);
  return `rgb(${map.bytes[k]} ${map.bytes[k + 1]} ${map.bytes[k + 2]})`;
}

/// Properties of the style: a path from its start to its end, as pictures of maps have it.
const kTimeStops = ['time-0', 'time-1', 'time-2', 'time-3', 'time-4'];

/// The map that suits the page's ground, as pictures of clouds have it.
function defaultMap() {
  const named = description.default_maps[theme.isDark() ? 'dark' : 'light'];
  return Math.max(colourMaps.findIndex((map) => map.name === named), 0);
}

const theme = {
  watchers: [],
  isDark() { return document.documentElement.dataset.theme === 'dark'; },
  set(isDark) {
    document.documentElement.dataset.theme = isDark ? 'dark' : 'light';
    for (const watcher of this.watchers) watcher();
  },
  /// Follows the system until the user chooses.
  follow() {
    const system = matchMedia('(prefers-color-scheme: dark)');
    this.set(system.matches);
    system.addEventListener('change', () => { if (!this.isChosen) this.set(system.matches); });
  },
  toggle() {
    this.isChosen = true;
    this.set(!this.isDark());
  },
};
