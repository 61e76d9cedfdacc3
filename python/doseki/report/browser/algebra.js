// Vectors of three, and matrices of sixteen in columns, as WebGL has them.

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [
  a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const along = (a, b, t) => [a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]];
const unit = (a) => along([0, 0, 0], a, 1 / Math.hypot(...a));
const clamp = (value, low, high) => Math.min(high, Math.max(low, value));

// Sends the axes `right`, `up`, `back` and the point `eye` to those of the camera.
function viewMatrix(right, up, back, eye) {
  const rows = [right, up, back];
  return new Float32Array([
    ...[0, 1, 2].flatMap((column) => [...rows.map((row) => row[column]), 0]),
    ...rows.map((row) => -dot(row, eye)), 1]);
}

function perspectiveMatrix(slope, aspect, near, far) {
  const depth = 1 / (near - far);
  return new Float32Array([
    1 / (slope * aspect), 0, 0, 0, 0, 1 / slope, 0, 0,
    0, 0, (far + near) * depth, -1, 0, 0, 2 * far * near * depth, 0]);
}

function parallelMatrix(height, aspect, near, far) {
  const depth = 1 / (near - far);
  return new Float32Array([
    1 / (height * aspect), 0, 0, 0, 0, 1 / height, 0, 0,
    0, 0, 2 * depth, 0, 0, 0, (far + near) * depth, 1]);
}

// The matrix, in columns, that a quaternion w, x, y, z stands for.
function turnMatrix(w, x, y, z) {
  return [
    1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y),
    2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x),
    2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)];
}

// The largest of 1, 2, 5 times a power of ten that is not above `length`.
function niceLength(length) {
  const power = 10 ** Math.floor(Math.log10(length));
  return power * ([5, 2].find((digit) => digit * power <= length) ?? 1);
}
