// A thin layer over WebGL 2: programs with their uniforms, buffers, and the picture that points are drawn into.

const kShaderBegin = '#version 300 es\nprecision highp float;\nprecision highp int;\n';

/// A program of the graphics processor, made once for each pair of shaders.
function programOf(gl, vertex, fragment) {
  gl.programs ??= new Map();
  if (!gl.programs.has(vertex)) gl.programs.set(vertex, new Program(gl, vertex, fragment));
  return gl.programs.get(vertex);
}

class Program {
  constructor(gl, vertex, fragment) {
    this.gl = gl;
    this.program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, kShaderBegin + text);
      gl.compileShader(shader);
      gl.attachShader(this.program, shader);
    }
    gl.linkProgram(this.program);
    if (!gl.getProgramParameter(this.program, gl.LINK_STATUS) && !gl.isContextLost()) {
      const logs = gl.getAttachedShaders(this.program).map((shader) => gl.getShaderInfoLog(shader));
      throw new Error('A shader does not build: ' + [gl.getProgramInfoLog(this.program), ...logs].join(' '));
    }
    this.places = {};
    const count = gl.getProgramParameter(this.program, gl.ACTIVE_UNIFORMS);
    for (let k = 0; k < count; ++k) {
      const uniform = gl.getActiveUniform(this.program, k);
      this.places[uniform.name] = {at: gl.getUniformLocation(this.program, uniform.name), type: uniform.type};
    }
  }

  /// Makes it current and sets uniforms by their names.
  use(values) {
    const gl = this.gl;
    gl.useProgram(this.program);
    for (const [name, value] of Object.entries(values)) {
      const place = this.places['u_' + name];
      if (!place) continue;
      switch (place.type) {
        case gl.FLOAT: gl.uniform1f(place.at, value); break;
        case gl.FLOAT_VEC2: gl.uniform2fv(place.at, value); break;
        case gl.FLOAT_VEC3: gl.uniform3fv(place.at, value); break;
        case gl.FLOAT_VEC4: gl.uniform4fv(place.at, value); break;
        case gl.FLOAT_MAT4: gl.uniformMatrix4fv(place.at, false, value); break;
        default: gl.uniform1i(place.at, value);
      }
    }
  }
}

function bufferOf(gl, data) {
  const buffer = gl.createBuffer();
  gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
  gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
  return buffer;
}

/// A vertex array over one buffer; attributes are [location, size, type, normalised, stride, offset].
function vertexArray(gl, buffer, attributes) {
  const array = gl.createVertexArray();
  gl.bindVertexArray(array);
  gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
  for (const [location, size, type, isNormalised, stride, offset] of attributes) {
    gl.enableVertexAttribArray(location);
    gl.vertexAttribPointer(location, size, type, isNormalised, stride, offset);
  }
  gl.bindVertexArray(null);
  array.buffer = buffer;
  return array;
}

/// Frees what a part of the scene has on the graphics processor, where another one takes its place.
function release(gl, part) {
  gl.deleteTexture(part?.texture ?? null);
  gl.deleteBuffer(part?.array?.buffer ?? null);
  gl.deleteVertexArray(part?.array ?? null);
}

function makeTexture(gl, filter) {
  const texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, filter);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, filter);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
  return texture;
}

/// Colour and depth as textures, as large as was asked last.
class DepthPicture {
  constructor(gl) {
    this.gl = gl;
    this.framebuffer = gl.createFramebuffer();
    this.width = 0;
    this.height = 0;
  }

  begin(width, height) {
    const gl = this.gl;
    if (width !== this.width || height !== this.height) this.resize(width, height);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.framebuffer);
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  }

  resize(width, height) {
    const gl = this.gl;
    gl.deleteTexture(this.colour);
    gl.deleteTexture(this.depth);
    this.colour = makeTexture(gl, gl.NEAREST);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA8, width, height);
    this.depth = makeTexture(gl, gl.NEAREST);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.DEPTH_COMPONENT24, width, height);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.framebuffer);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, this.colour, 0);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, this.depth, 0);
    [this.width, this.height] = [width, height];
  }

  bindTextures() {
    const gl = this.gl;
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, this.depth);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.colour);
  }
}
