// Where the scene is looked at from. Lengths are in metres from the corner of the scene's box.

const SLOPE = Math.tan((15 * Math.PI) / 180); // half of the height that is seen, over the distance
const STEEPEST = 89; // degrees

class Camera {
  // `up` points against gravity. A flat scene is seen face on, in parallel projection.
  constructor(scene) {
    this.flat = scene.dim === 2;
    this.up = unit(scene.up);
    this.focus = scene.focus; // lower and upper corner of what matters
    this.reach = Math.hypot(...scene.size);
    const level = Math.abs(this.up[0]) < 0.9 ? [1, 0, 0] : [0, 1, 0];
    this.first = unit(along(level, this.up, -dot(level, this.up)));
    this.second = cross(this.up, this.first);
    this.reset();
  }

  reset() {
    this.azimuth = -60;
    this.elevation = 25;
    this.fitted = true; // until somebody moves it, it follows the shape of the window
    this.target = [0, 1, 2].map((k) => (this.focus[0][k] + this.focus[1][k]) / 2);
  }

  look(azimuth, elevation) {
    this.azimuth = azimuth;
    this.elevation = clamp(elevation, -STEEPEST, STEEPEST);
  }

  // Unit vectors to the right, upwards, and towards the viewer.
  get axes() {
    if (this.flat) return [cross(this.up, [0, 0, 1]), this.up, [0, 0, 1]];
    const [a, e] = [this.azimuth, this.elevation].map((angle) => (angle * Math.PI) / 180);
    let back = along(along([0, 0, 0], this.first, Math.cos(a)), this.second, Math.sin(a));
    back = along(along([0, 0, 0], back, Math.cos(e)), this.up, Math.sin(e));
    const right = unit(cross(this.up, back));
    return [right, cross(back, right), back];
  }

  // Half extents of what matters: to the right, upwards, towards the viewer.
  extents() {
    const half = [0, 1, 2].map((k) => (this.focus[1][k] - this.focus[0][k]) / 2);
    return this.axes.map((axis) => half.reduce((sum, h, k) => sum + h * Math.abs(axis[k]), 0));
  }

  fit(aspect) {
    const [wide, high, deep] = this.extents();
    // What is nearer than the target looks larger.
    const height = Math.max(high, wide / aspect) + (this.flat ? 0 : 0.9 * deep * SLOPE);
    this.height = 1.06 * Math.max(height, 1e-9); // half of what is seen at the target
  }

  orbit(right, up) {
    this.look(this.azimuth - right, this.elevation + up);
  }

  // By shares of the height that is seen.
  pan(right, up) {
    this.fitted = false;
    const [x, y] = this.axes;
    this.target = along(along(this.target, x, -2 * right * this.height), y, -2 * up * this.height);
  }

  zoom(factor) {
    this.fitted = false;
    this.height = clamp(this.height * factor, 1e-5 * this.reach, 5 * this.reach);
  }

  matrices(aspect) {
    if (this.fitted) this.fit(aspect);
    const [right, up, back] = this.axes;
    const distance = this.flat ? this.reach : this.height / SLOPE;
    const eye = along(this.target, back, distance);
    const far = distance + 2 * this.reach;
    const near = Math.max(distance - 2 * this.reach, distance / 100);
    const projection = this.flat
      ? parallelMatrix(this.height, aspect, 0, far)
      : perspectiveMatrix(SLOPE, aspect, near, far);
    return { view: viewMatrix(right, up, back, eye), projection, near, far, back };
  }
}
