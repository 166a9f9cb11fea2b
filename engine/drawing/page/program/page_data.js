// Data of the page: one description in JSON and elements with bytes in base64 (engine/drawing/page writes both).

const byId = (id) => document.getElementById(id);
const description = JSON.parse(byId('description').textContent);

/// The bytes of an element, which goes: a page of two million points need not lie in memory twice. Those of a drive come
/// with the description.
function takeBytes(id) {
  if (description.elements?.[id]) return bytesOfBase64(description.elements[id]);
  const element = byId(id);
  const text = element.textContent;
  element.remove();
  return bytesOfBase64(text);
}

function bytesOfBase64(text) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const letters = atob(text);
  const bytes = new Uint8Array(letters.length);
  for (let k = 0; k < letters.length; ++k) bytes[k] = letters.charCodeAt(k);
  return bytes;
}

/// Little-endian float32 values, on any host.
function floatsOf(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  return Float32Array.from({length: bytes.length / 4}, (_, k) => view.getFloat32(4 * k, true));
}

/// An element of the page; words go in as text, never as markup.
function element(tag, properties = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name in made) made[name] = value;
    else made.setAttribute(name, value);
  }
  made.append(...children);
  return made;
}

const grouped = (count) => Math.round(count).toLocaleString('en-US');
/// Fixed decimals with a true minus, and no minus before zero.
function fixed(value, decimals) {
  const text = value.toFixed(decimals);
  return /^-0(\.0*)?$/.test(text) ? text.slice(1) : text.replace('-', '−');
}
const degrees = (angle) => angle * 180 / Math.PI;
/// Pixels of the scene to one of CSS.
const pixelRatio = () => Math.min(devicePixelRatio || 1, 2);
const prefersStill = () => matchMedia('(prefers-reduced-motion: reduce)').matches;
const clamp = (value, least, most) => Math.min(Math.max(value, least), most);
