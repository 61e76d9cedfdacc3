// The picture of a run: which moment is shown, by which field it is coloured, from where.

const PLAY_SECONDS = 8; // about how long a run takes to play
const REST = 180; // ms without a movement, then the picture is drawn finer

class Viewer {
  constructor(place, scene) {
    this.scene = scene;
    this.place = place;
    this.part = (name) => place.querySelector(`[data-part="${name}"]`);
    this.canvas = this.part("picture");
    this.camera = new Camera(scene);
    this.painter = new Painter(this.canvas, scene);
    this.moments = scene.frames.map(() => null); // once they are unpacked
    this.frame = scene.start;
    this.field = scene.fields[0];
    this.shown = Object.fromEntries(LAYERS.map((name) => [name, true]));
    this.hides = !scene.terrain; // on a map what is in front may be the dam that matters
    this.clear = false;
    this.fine = true;
    this.playing = false;
    this.names = scene.fields.map((field) => field.name);
    for (const field of scene.fields) field.table = this.tableOf(field);
  }

  // 256 colours, four bytes each.
  tableOf(field) {
    const table = new Uint8ClampedArray(1024).fill(255);
    const given = field.names ? field.colours : this.scene.scale;
    for (let k = 0; k < 256; k++) table.set(rgbOf(given[k % Math.max(1, given.length)] || "#808080"), 4 * k);
    return table;
  }

  // What stays where it is. A browser may take the graphics processor away, and give it back.
  async fillStill() {
    const { scene, painter } = this;
    if (scene.terrain) {
      const planes = new Planes(await inflated(scene.terrain.id), scene.terrain.columns * scene.terrain.rows);
      painter.setTerrain(scene.terrain, planes.wide(new Uint16Array(planes.count)));
    }
    if (scene.walls?.id) painter.setParticles(painter.walls, await readParticles(scene.walls, []));
    const meshes = scene.bodies?.meshes ?? [];
    this.meshes = meshes.map((mesh) => painter.mesh(...flatTriangles(mesh.points, mesh.triangles)));
  }

  async start() {
    await this.fillStill();
    this.canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
    this.canvas.addEventListener("webglcontextrestored", async () => {
      this.painter = new Painter(this.canvas, this.scene);
      await this.fillStill();
      await this.show();
    });
    buildPanel(this);
    attachControls(this.canvas, this.camera, (moving) => this.changed(moving), {
      " ": () => this.setPlaying(!this.playing), ",": () => this.show({ frame: this.frame - 1 }),
      ".": () => this.show({ frame: this.frame + 1 }), Home: () => this.show({ frame: 0 }),
    });
    new ResizeObserver(() => this.draw()).observe(this.canvas);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.draw());
    addEventListener("beforeprint", () => this.setPrinting(true));
    addEventListener("afterprint", () => this.setPrinting(false));
    addEventListener("hashchange", () => this.follow());
    await this.show(this.asked());
  }

  // An address is a whole view: what it does not name is as at the start.
  follow() {
    const asked = this.asked();
    if (!Object.keys(asked).length) return; // a place in the page
    this.camera.reset();
    this.show({ frame: this.scene.start, field: this.names[0], clear: 0, ...asked });
  }

  // What the address says after its #: frame, field, azimuth, elevation, zoom, clear (1: one sees through the flow).
  asked() {
    const asked = Object.fromEntries(new URLSearchParams(location.hash.slice(1)));
    const found = this.names.includes(asked.field) ? { field: asked.field } : {};
    for (const key of ["frame", "azimuth", "elevation", "zoom", "clear"]) {
      const number = numberOr(asked[key] || null);
      if (number !== undefined) found[key] = number;
    }
    return found;
  }

  // Changes what is shown; what is not named, or no number, stays. Resolves when it has been drawn.
  async show({ frame, field = this.field.name, azimuth, elevation, zoom, clear } = {}) {
    const { camera } = this;
    this.clear = Boolean(clear ?? this.clear);
    this.frame = clamp(Math.round(numberOr(frame, this.frame)), 0, this.scene.frames.length - 1);
    this.field = this.scene.fields[Math.max(0, this.names.indexOf(field))];
    camera.look(numberOr(azimuth, camera.azimuth), numberOr(elevation, camera.elevation));
    const moment = await this.moment(this.frame);
    if (moment !== this.moments[this.frame]) return; // another one has been asked for since
    this.hand(moment);
    if (numberOr(zoom, 0) > 0) {
      this.draw();
      camera.zoom(1 / zoom);
    }
    this.draw();
  }

  async moment(index) {
    const { fields, frames, bodies } = this.scene;
    const names = fields.map((field) => field.name);
    this.moments[index] ??= Promise.all([
      readParticles(frames[index].flow, names),
      frames[index].walls ? readParticles(frames[index].walls, []) : null,
      bodies ? readBodies(frames[index].bodies, bodies.fields) : null,
    ]);
    this.moments[index] = await this.moments[index];
    return this.moments[index];
  }

  // Gives the numbers of a moment to the painter.
  hand([flow, walls, bodies]) {
    const { painter, field } = this;
    painter.setParticles(painter.flow, flow, flow.values[field.name]);
    if (walls) painter.setParticles(painter.walls, walls);
    painter.setColours(new Uint8Array(field.table.buffer));
    this.counts = { flow: flow.count, extent: this.extentOf(flow), bodies: 0 };
    if (!bodies) return;
    painter.setBodies(...placedBodies(bodies, this.scene, this.meshes, bodies.values[field.name]));
    this.counts.bodies = bodies.there.reduce((sum, on) => sum + on, 0);
  }

  // Lower and upper corner of particles, in map coordinates.
  extentOf({ place }) {
    const { corner, size, dim } = this.scene;
    const low = Array(3).fill(Infinity), high = Array(3).fill(-Infinity);
    for (let i = 0; i < place.length; i++) {
      const axis = i % 4;
      if (place[i] < low[axis]) low[axis] = place[i];
      if (place[i] > high[axis]) high[axis] = place[i];
    }
    return [low, high].map((end) => end.slice(0, dim).map((v, k) => corner[k] + (v / 65535) * size[k]));
  }

  setPlaying(playing) {
    const { frames } = this.scene;
    this.playing = playing && frames.length > 1;
    this.part("play").textContent = this.playing ? "❚❚ Pause" : "▶ Play";
    clearInterval(this.clock);
    if (!this.playing) return this.draw();
    const pause = clamp((1000 * PLAY_SECONDS) / frames.length, 50, 400);
    this.clock = setInterval(() => this.step(), pause);
  }

  // The next moment, unless the last one is still being drawn.
  async step() {
    if (this.busy) return;
    this.busy = true;
    await this.show({ frame: (this.frame + 1) % this.scene.frames.length });
    this.busy = false;
  }

  // Moving pictures are drawn quickly; when they rest, finely.
  changed(moving) {
    this.fine = !moving;
    requestAnimationFrame(() => this.draw());
    clearTimeout(this.rest);
    if (!moving) return;
    this.rest = setTimeout(() => {
      this.fine = true;
      this.draw();
    }, REST);
  }

  // Paper is light, and has a copy of the picture: browsers print what a canvas of the graphics
  // processor has shown last, not what has been drawn since, and lay the page out anew meanwhile.
  setPrinting(printing) {
    const { canvas } = this, paper = this.part("paper");
    this.printing = false;
    document.documentElement.classList.toggle("printing", printing);
    this.draw();
    this.printing = printing;
    Object.assign(paper, { width: canvas.width, height: canvas.height });
    if (printing) paper.getContext("2d").drawImage(canvas, 0, 0);
  }

  draw() {
    if (this.printing) return;
    const { canvas, camera, scene } = this, style = getComputedStyle(this.place);
    const colour = (name) => rgbOf(style.getPropertyValue(name).trim()).map((v) => v / 255);
    const ratio = Math.min(3, Math.min(devicePixelRatio || 1, 2) * (this.fine && !this.playing ? 2 : 1));
    const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((v) => Math.max(1, Math.round(v * ratio)));
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    const known = !scene.bodies || scene.bodies.fields.includes(this.field.name);
    const began = performance.now();
    this.painter.paint(camera, {
      ...this.shown,
      hides: this.hides,
      clear: this.clear,
      background: colour("--picture"),
      wallColour: colour("--wall"),
      soil: colour("--soil"),
      bodyColour: known ? null : colour("--body"),
    });
    this.drawn = performance.now() - began;
    this.write(known);
  }

  write(known) {
    const { scene, camera, canvas } = this, { time } = scene.frames[this.frame];
    const extra = [
      ...(this.shown.walls && scene.walls ? [["fixed", "var(--wall)"]] : []),
      ...(scene.bodies && this.shown.bodies && !known ? [["rigid bodies", "var(--body)"]] : []),
    ];
    fillLegend(this.part("legend"), this.field, extra);
    this.part("time").value = this.frame;
    const clock = `${(scene.clock.factor * time).toFixed(scene.clock.digits)} ${scene.clock.unit}`;
    this.part("time").setAttribute("aria-valuetext", clock);
    this.part("clock").textContent = clock;
    this.part("field").value = this.field.name;
    if (this.clearBox) this.clearBox.checked = this.clear;
    drawScaleBar(this.part("bar"), camera, canvas.width / canvas.height);
    drawAxes(this.part("axes"), camera, scene.axes);
    this.place.dataset.state = JSON.stringify(this.state());
  }

  // What is shown, for tests and for whoever scripts the page. Places are map coordinates.
  state() {
    const { scene, camera, field } = this;
    return {
      ready: true, frame: this.frame, frames: scene.frames.length, time: scene.frames[this.frame].time,
      field: field.name, fields: this.names, low: field.low, high: field.high, legend: field.names,
      ...this.counts, walls: this.painter.walls.count, cut: this.hides,
      terrain: Boolean(this.painter.terrain),
      dim: scene.dim, azimuth: camera.azimuth, elevation: camera.elevation, height: camera.height,
      target: camera.target.map((v, k) => v + scene.corner[k]), clear: this.clear, playing: this.playing, drawn: this.drawn,
    };
  }
}

// What is given as a number, or another one.
function numberOr(value, other) {
  return Number.isFinite(Number(value ?? NaN)) ? Number(value) : other;
}

function rgbOf(colour) {
  return [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));
}

async function openViewer() {
  const place = document.getElementById("viewer");
  if (!place) return;
  place.hidden = false;
  try {
    const viewer = new Viewer(place, JSON.parse(document.getElementById("scene").textContent));
    window.doseki = { state: () => viewer.state(), show: (wanted) => viewer.show(wanted) };
    await viewer.start();
  } catch (error) {
    const said = typeof DecompressionStream === "undefined" ? "the browser is older than 2023" : error.message;
    place.dataset.state = JSON.stringify({ ready: false, error: String(said) });
    const text = `The interactive view cannot be shown here: ${said}. The figures below show the run.`;
    place.replaceChildren(element("p", text, "failure"));
  }
}

openViewer();
