// Surfaces as triangles: the terrain, and rigid bodies that are no balls.

const NO_DATA = 65535;

// Indices of the triangles of a grid, without those that touch a node without data.
function gridTriangles(heights, columns, rows) {
  const index = new Uint32Array(6 * Math.max(0, columns - 1) * Math.max(0, rows - 1));
  let end = 0;
  for (let row = 0; row + 1 < rows; row++) {
    for (let column = 0; column + 1 < columns; column++) {
      const a = row * columns + column, b = a + 1, c = a + columns, d = c + 1;
      for (const triangle of [[a, b, c], [b, d, c]]) {
        if (triangle.every((node) => heights[node] !== NO_DATA)) {
          index.set(triangle, end);
          end += 3;
        }
      }
    }
  }
  return index.subarray(0, end);
}

// Corners and normals of flat triangles between `points` ([x, y, z] each), three indices each.
function flatTriangles(points, triangles) {
  const corners = [], normals = [];
  for (let k = 0; k < triangles.length; k += 3) {
    const [a, b, c] = [0, 1, 2].map((side) => points[triangles[k + side]]);
    const across = cross(along(b, a, -1), along(c, a, -1));
    const normal = Math.hypot(...across) > 0 ? unit(across) : [0, 0, 1];
    corners.push(...a, ...b, ...c);
    normals.push(...normal, ...normal, ...normal);
  }
  return [new Float32Array(corners), new Float32Array(normals)];
}

// Balls and solids of one moment, as Painter.setBodies takes them.
function placedBodies(frame, { bodies, size }, meshes, values) {
  const balls = { ball: [], turn: [], value: [] }, solids = [];
  for (let k = 0; k < frame.count; k++) {
    if (!frame.there[k]) continue;
    const shift = [0, 1, 2].map((axis) => frame.place[axis][k] * size[axis]);
    const turn = frame.turn.map((each) => each[k]);
    const value = values ? values[k] : 0, shape = bodies.shape[k];
    if (shape < 0) {
      balls.ball.push(...shift, bodies.radius[k]);
      balls.turn.push(...turn);
      balls.value.push(value);
    } else {
      const length = Math.hypot(...turn) || 1;
      solids.push({ mesh: meshes[shape], shift, value, turn: turnMatrix(...turn.map((v) => v / length)) });
    }
  }
  return [balls, solids];
}
