// The numbers of a scene: planes of bytes, deflated, in base64 (view/coding.py writes them).

async function inflated(id) {
  const text = atob(document.getElementById(id).textContent);
  const packed = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) packed[i] = text.charCodeAt(i);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// Reads planes of `count` numbers one after the other; each number is a step from the one before.
class Planes {
  constructor(bytes, count) {
    this.bytes = bytes;
    this.count = count;
    this.at = 0;
  }

  // 8 bits each.
  small() {
    const values = new Uint8Array(this.count);
    for (let i = 0, v = 0; i < this.count; i++) values[i] = v = (v + this.bytes[this.at + i]) & 255;
    this.at += this.count;
    return values;
  }

  // 16 bits each, into every `stride`th entry of `values`; low bytes, then high bytes. The sign of a
  // step is its lowest bit.
  wide(values, first = 0, stride = 1) {
    const { bytes, at, count } = this;
    for (let i = 0, k = first, v = 0; i < count; i++, k += stride) {
      const step = bytes[at + i] | (bytes[at + count + i] << 8);
      values[k] = v = (v + ((step >>> 1) ^ -(step & 1))) & 65535;
    }
    this.at += 2 * count;
    return values;
  }
}

// A block of particles: `place` holds x, y, z and radius of each (16 bits), `values` one byte for
// each field.
async function readParticles(block, fields) {
  const planes = new Planes(await inflated(block.id), block.count);
  const place = new Uint16Array(4 * block.count);
  for (let axis = 0; axis < 4; axis++) planes.wide(place, axis, 4);
  const values = {};
  for (const name of fields) values[name] = planes.small();
  return { count: block.count, place, values };
}

// A block of rigid bodies: places (0 to 1 in the box), quaternions w, x, y, z, whether they are there.
async function readBodies(block, fields) {
  const planes = new Planes(await inflated(block.id), block.count);
  const words = () => planes.wide(new Uint16Array(block.count));
  const place = [words(), words(), words()].map((each) => Float32Array.from(each, (v) => v / 65535));
  const turn = [words(), words(), words(), words()].map((each) =>
    Float32Array.from(each, (v) => v / 32767 - 1));
  const there = planes.small();
  const values = {};
  for (const name of fields) values[name] = planes.small();
  return { count: block.count, place, turn, there, values };
}
