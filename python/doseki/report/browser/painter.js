// Draws a scene with WebGL2: particles, rigid bodies, terrain, then the shading of depths.

const SQUARE = new Float32Array([-1, -1, 1, -1, -1, 1, 1, 1]);
const CLEAR = 0.45; // how much a clear flow covers what is behind it
const EMPTY_FRAME = { count: 0, place: new Uint16Array(0) };

class Painter {
  // Throws where there is no WebGL2.
  constructor(canvas, scene) {
    this.gl = canvas.getContext("webgl2", { antialias: false, alpha: false, preserveDrawingBuffer: true });
    if (!this.gl) throw new Error("this browser has no WebGL2");
    this.scene = scene;
    const gl = this.gl;
    this.programs = {
      particles: this.program(PARTICLE_VERTEX, PARTICLE_FRAGMENT),
      balls: this.program(BALL_VERTEX, BALL_FRAGMENT),
      solids: this.program(SOLID_VERTEX, SOLID_FRAGMENT),
      terrain: this.program(TERRAIN_VERTEX, TERRAIN_FRAGMENT),
      screen: this.program(SCREEN_VERTEX, SCREEN_FRAGMENT),
    };
    this.square = this.buffer(SQUARE);
    this.flow = this.cloud();
    this.walls = this.cloud();
    this.balls = this.ballCloud();
    this.solids = [];
    this.colours = gl.createTexture();
    this.target = { width: 0, height: 0, frame: gl.createFramebuffer() };
    this.target.picture = gl.createTexture();
    this.target.depths = gl.createTexture();
    this.nothing = gl.createVertexArray();
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
  }

  program(vertex, fragment) {
    const gl = this.gl, program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    const places = {};
    for (let k = 0; k < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); k++) {
      const { name } = gl.getActiveUniform(program, k);
      places[name] = gl.getUniformLocation(program, name);
    }
    return { program, places };
  }

  buffer(values) {
    const gl = this.gl, made = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, made);
    gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW);
    return made;
  }

  // One attribute; a whole number is given to the program as one.
  attribute(place, buffer, entries, type, each, isWhole = false) {
    const gl = this.gl;
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.enableVertexAttribArray(place);
    if (isWhole) gl.vertexAttribIPointer(place, entries, type, 0, 0);
    else gl.vertexAttribPointer(place, entries, type, type !== gl.FLOAT, 0, 0);
    gl.vertexAttribDivisor(place, each);
  }

  cloud() {
    const gl = this.gl;
    const made = { array: gl.createVertexArray(), count: 0 };
    made.place = gl.createBuffer();
    made.value = gl.createBuffer();
    gl.bindVertexArray(made.array);
    this.attribute(0, this.square, 2, gl.FLOAT, 0);
    this.attribute(1, made.place, 4, gl.UNSIGNED_SHORT, 1);
    this.attribute(2, made.value, 1, gl.UNSIGNED_BYTE, 1, true);
    gl.bindVertexArray(null);
    return made;
  }

  ballCloud() {
    const gl = this.gl, made = this.cloud();
    made.turn = gl.createBuffer();
    gl.bindVertexArray(made.array);
    this.attribute(1, made.place, 4, gl.FLOAT, 1);
    this.attribute(3, made.turn, 4, gl.FLOAT, 1);
    gl.bindVertexArray(null);
    return made;
  }

  fill(buffer, values) {
    const gl = this.gl;
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, values, gl.DYNAMIC_DRAW);
  }

  // Particles of a frame; `values` (one byte each) pick their colours.
  setParticles(cloud, particles, values) {
    const { count, place } = particles ?? EMPTY_FRAME;
    this.fill(cloud.place, place);
    this.fill(cloud.value, values ?? new Uint8Array(count));
    cloud.count = count;
  }

  // `balls`: {ball, turn, value} as arrays; `solids`: [{mesh, turn, shift, value}].
  setBodies(balls, solids) {
    this.fill(this.balls.place, new Float32Array(balls.ball));
    this.fill(this.balls.turn, new Float32Array(balls.turn));
    this.fill(this.balls.value, new Uint8Array(balls.value));
    this.balls.count = balls.value.length;
    this.solids = solids;
  }

  // Triangles as corners and normals, three numbers each.
  mesh(corners, normals) {
    const gl = this.gl, array = gl.createVertexArray();
    gl.bindVertexArray(array);
    this.attribute(0, this.buffer(corners), 3, gl.FLOAT, 0);
    this.attribute(1, this.buffer(normals), 3, gl.FLOAT, 0);
    gl.bindVertexArray(null);
    return { array, count: corners.length / 3 };
  }

  setColours(table) {
    this.gl.activeTexture(this.gl.TEXTURE0);
    this.texture(this.colours, this.gl.RGBA8, 256, 1, this.gl.RGBA, this.gl.UNSIGNED_BYTE, table);
  }

  texture(texture, inside, width, height, format, type, values) {
    const gl = this.gl;
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.texImage2D(gl.TEXTURE_2D, 0, inside, width, height, 0, format, type, values);
    for (const [key, value] of [
      [gl.TEXTURE_MIN_FILTER, gl.NEAREST], [gl.TEXTURE_MAG_FILTER, gl.NEAREST],
      [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE], [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE]]) {
      gl.texParameteri(gl.TEXTURE_2D, key, value);
    }
  }

  setTerrain(terrain, heights) {
    const gl = this.gl;
    gl.activeTexture(gl.TEXTURE1);
    const texture = gl.createTexture();
    this.texture(texture, gl.R16UI, terrain.columns, terrain.rows, gl.RED_INTEGER, gl.UNSIGNED_SHORT, heights);
    const triangles = gridTriangles(heights, terrain.columns, terrain.rows);
    const array = gl.createVertexArray(), index = gl.createBuffer();
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, index);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, triangles, gl.STATIC_DRAW);
    gl.bindVertexArray(null);
    this.terrain = { ...terrain, texture, array, count: triangles.length };
  }

  // Sets what all programs share of the camera, and numbers of one of them by name.
  use(name, shared, numbers = {}) {
    const gl = this.gl, { program, places } = this.programs[name];
    gl.useProgram(program);
    for (const [key, value] of Object.entries({ ...shared, ...numbers })) {
      const at = places[key];
      if (at === undefined) continue;
      if (value.length === 16) gl.uniformMatrix4fv(at, false, value);
      else if (value.length === 9) gl.uniformMatrix3fv(at, false, value);
      else if (value.length === 4) gl.uniform4fv(at, value);
      else if (value.length === 3) gl.uniform3fv(at, value);
      else gl.uniform1f(at, value);
    }
    if (places.colours !== undefined) gl.uniform1i(places.colours, 0);
    return places;
  }

  resize(width, height) {
    const gl = this.gl, target = this.target;
    if (target.width === width && target.height === height) return;
    Object.assign(target, { width, height });
    gl.activeTexture(gl.TEXTURE2);
    this.texture(target.picture, gl.RGBA8, width, height, gl.RGBA, gl.UNSIGNED_BYTE, null);
    gl.activeTexture(gl.TEXTURE3);
    this.texture(target.depths, gl.DEPTH_COMPONENT24, width, height, gl.DEPTH_COMPONENT, gl.UNSIGNED_INT, null);
    gl.bindFramebuffer(gl.FRAMEBUFFER, target.frame);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, target.picture, 0);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, target.depths, 0);
  }

  // `look`: background, wall and soil colours, shown layers, whether walls in front are hidden. A
  // clear flow is laid over the picture that there is without it.
  paint(camera, look) {
    const clear = look.clear && look.flow && !camera.flat;
    if (clear) this.paintLayers(camera, { ...look, flow: false }, 1);
    this.paintLayers(camera, look, clear ? CLEAR : 1);
  }

  paintLayers(camera, look, opacity) {
    const gl = this.gl, { width, height } = gl.canvas;
    this.resize(width, height);
    const { view, projection, near, far, back } = camera.matrices(width / height);
    const shared = { view, projection, flatness: camera.flat ? 1 : 0, size: this.scene.size, back,
      low: this.scene.flowBox[0], high: this.scene.flowBox[1] };
    const { radius, swell, wallSwell } = this.scene;
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.target.frame);
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.colours);
    if (look.terrain) this.paintTerrain(shared, look);
    if (look.walls) {
      const cuts = camera.up.map((v) => (look.hides && !camera.flat && Math.abs(v) < 0.7 ? 1 : 0));
      const plain = [...look.wallColour, 1];
      const largest = radius * wallSwell;
      this.paintCloud("particles", this.walls, shared, { plain, cuts, largest, roundness: 0.2 });
    }
    if (look.flow) {
      const [plain, cuts] = [[0, 0, 0, 0], [0, 0, 0]];
      const largest = radius * swell;
      this.paintCloud("particles", this.flow, shared, { plain, cuts, largest, roundness: 0.55 });
    }
    if (look.bodies) this.paintBodies(shared, look.bodyColour);
    const strength = camera.flat ? 0 : 22;
    this.paintScreen({ near, far, background: look.background, strength, opacity }, height);
  }

  paintCloud(name, cloud, shared, numbers) {
    if (!cloud.count) return;
    this.use(name, shared, numbers);
    this.gl.bindVertexArray(cloud.array);
    this.gl.drawArraysInstanced(this.gl.TRIANGLE_STRIP, 0, 4, cloud.count);
  }

  paintBodies(shared, colour) {
    const gl = this.gl, plain = colour ? [...colour, 1] : [0, 0, 0, 0];
    this.paintCloud("balls", this.balls, shared, { plain });
    if (!this.solids.length) return;
    const places = this.use("solids", shared, { plain });
    for (const { mesh, turn, shift, value } of this.solids) {
      gl.uniformMatrix3fv(places.turn, false, turn);
      gl.uniform3fv(places.shift, shift);
      gl.uniform1i(places.value, value);
      gl.bindVertexArray(mesh.array);
      gl.drawArrays(gl.TRIANGLES, 0, mesh.count);
    }
  }

  paintTerrain(shared, look) {
    if (!this.terrain) return;
    const gl = this.gl, { terrain } = this;
    const places = this.use("terrain", shared, { origin: terrain.origin, spacing: terrain.spacing,
      soil: look.soil, interval: terrain.interval, base: terrain.base });
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, terrain.texture);
    gl.uniform1i(places.heights, 1);
    gl.uniform2i(places.shape, terrain.columns, terrain.rows);
    gl.uniform1i(places.upright, terrain.upright);
    gl.bindVertexArray(terrain.array);
    gl.drawElements(gl.TRIANGLES, terrain.count, gl.UNSIGNED_INT, 0);
  }

  paintScreen(numbers, height) {
    const gl = this.gl;
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.disable(gl.DEPTH_TEST);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    const places = this.use("screen", {}, numbers);
    for (const [unit, key] of [[2, "picture"], [3, "depths"]]) {
      gl.activeTexture(gl.TEXTURE0 + unit);
      gl.bindTexture(gl.TEXTURE_2D, this.target[key]);
      gl.uniform1i(places[key], unit);
    }
    gl.uniform1i(places.reach, Math.max(1, Math.round(height / 500)));
    gl.bindVertexArray(this.nothing);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.disable(gl.BLEND);
    gl.enable(gl.DEPTH_TEST);
  }
}
