// Vectors of three numbers as arrays, matrices of 4 x 4 by columns as OpenGL has them.

const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const scaled = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const norm = (a) => Math.sqrt(dot(a, a));
const mix = (a, b, share) => a + (b - a) * share;
/// The same angle in (-pi, pi].
const wrapped = (angle) => angle - 2 * Math.PI * Math.ceil((angle - Math.PI) / (2 * Math.PI));

function product(a, b) {
  const out = new Float32Array(16);
  for (let column = 0; column < 4; ++column) {
    for (let row = 0; row < 4; ++row) {
      let sum = 0;
      for (let k = 0; k < 4; ++k) sum += a[4 * k + row] * b[4 * column + k];
      out[4 * column + row] = sum;
    }
  }
  return out;
}

/// Clip coordinates from the view's, which looks along its -z.
function perspective(fieldOfView, aspect, near, far) {
  const f = 1 / Math.tan(fieldOfView / 2);
  return new Float32Array([f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0,
                           2 * far * near / (near - far), 0]);
}

/// The view's coordinates from the page's, for an eye with these axes.
function viewMatrix(eye, right, up, back) {
  return new Float32Array([right[0], up[0], back[0], 0, right[1], up[1], back[1], 0, right[2], up[2], back[2], 0,
                           -dot(right, eye), -dot(up, eye), -dot(back, eye), 1]);
}

/// The corners of a box.
function cornersOf(least, most) {
  const corners = [];
  for (let k = 0; k < 8; ++k) corners.push([0, 1, 2].map((axis) => (k >> axis & 1 ? most : least)[axis]));
  return corners;
}

/// 1, 2 or 5 times a power of ten, at least `value`.
function roundStep(value) {
  const power = Math.pow(10, Math.floor(Math.log10(value)));
  for (const factor of [1, 2, 5]) {
    if (factor * power >= value * 0.999999) return factor * power;
  }
  return 10 * power;
}
const decimalsOf = (step) => clamp(Math.ceil(-Math.log10(step) - 1e-9), 0, 6);
/// Decimals of a value that is known to such a step, which they are not finer than.
const knownDecimals = (step, most) => (step > 0 ? clamp(Math.floor(1e-9 - Math.log10(step)), 0, most) : most);
