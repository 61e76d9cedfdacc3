// What is written over and beside the picture: colours and what they mean, scale bar, axes.

const UNITS = [[1000, 1e-3, "km"], [1, 1, "m"], [0.01, 100, "cm"], [0, 1000, "mm"]]; // from which length on
const MOST_NAMES = 12; // more of them are not told apart by colour

function numberText(value) {
  const size = Math.abs(value);
  if (size !== 0 && (size >= 1e5 || size < 1e-3)) return value.toExponential(1);
  return String(Number(value.toPrecision(3)));
}

function element(name, text = "", className = "") {
  const made = document.createElement(name);
  made.textContent = text;
  made.className = className;
  return made;
}

// The scale of a field, or the colour of each of its names.
function fillLegend(place, field, extra) {
  const title = element("p", field.unit ? `${field.label} (${field.unit})` : field.label, "legend-title");
  // What nothing has that moves has no colour.
  const named = (field.names ?? []).map((name, k) => [name, field.colours[k]]).filter(([, colour]) => colour);
  const entries = named.length > MOST_NAMES ? [[`${named.length} names`, "transparent"]] : named;
  const isScale = !field.names && field.low < field.high;
  if (!field.names && !isScale) entries.push([numberText(field.low), `rgb(${field.table.slice(0, 3)})`]);
  const swatches = [...entries, ...extra].map(([name, colour]) => {
    const entry = element("span", name, "swatch");
    const square = element("i");
    square.style.background = colour;
    entry.prepend(square);
    return entry;
  });
  place.replaceChildren(title, ...(isScale ? [scaleOf(field)] : []), ...swatches);
}

function scaleOf(field) {
  const scale = element("div", "", "scale"), bar = document.createElement("canvas");
  bar.width = 256;
  bar.height = 1;
  const context = bar.getContext("2d"), pixels = context.createImageData(256, 1);
  pixels.data.set(field.table);
  context.putImageData(pixels, 0, 0);
  const ends = element("div", "", "ends"), middle = (field.low + field.high) / 2;
  ends.append(...[field.low, middle, field.high].map((value) => element("span", numberText(value))));
  scale.append(bar, ends);
  return scale;
}

// A bar of a round length, true at the middle of the picture, also where that is shown smaller: on
// paper.
function drawScaleBar(place, camera, aspect) {
  const width = 2 * camera.height * aspect; // m, of what is seen
  const length = niceLength(0.22 * width);
  const [, factor, unit] = UNITS.find(([least]) => length >= least);
  place.style.width = `${(100 * length) / width}%`;
  place.textContent = `${Number((length * factor).toPrecision(2))} ${unit}`;
}

// The axes of the coordinates, as lines from a point (SVG).
function drawAxes(place, camera, names) {
  const [right, up] = camera.axes;
  const make = (name, entries) => {
    const made = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key, value] of Object.entries(entries)) made.setAttribute(key, value);
    return made;
  };
  place.replaceChildren(...names.flatMap((name, k) => {
    const [x, y] = [right[k], -up[k]];
    const label = make("text", { x: 40 + 33 * x, y: 44 + 33 * y });
    label.textContent = name;
    return [make("line", { x1: 40, y1: 40, x2: 40 + 24 * x, y2: 40 + 24 * y }), label];
  }));
}
