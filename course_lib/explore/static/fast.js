/* FAST corners over a picture: those that score at least the threshold. */

const RING = [0, 229, 255];

/**
 * For every canvas pixel the highest threshold at which some corner's ring covers it. A step of
 * the slider then changes the pixels with that value, and looks at no others.
 */
function ringMap(points, scores, columns, rows, scale, pixelRatio) {
  const map = new Uint8Array(columns * rows);
  const radius = 3.4 * pixelRatio;
  const stroke = 0.62 * Math.max(1, pixelRatio);
  const reach = Math.ceil(radius + stroke);
  const ring = [];
  for (let y = -reach; y <= reach; y++)
    for (let x = -reach; x <= reach; x++)
      if (Math.abs(Math.hypot(x, y) - radius) <= stroke) ring.push([x, y]);
  for (let i = 0; i < scores.length; i++) {
    const cx = Math.floor((points[2 * i] + 0.5) * scale);
    const cy = Math.floor((points[2 * i + 1] + 0.5) * scale);
    for (const [dx, dy] of ring) {
      const x = cx + dx;
      const y = cy + dy;
      if (x < 0 || y < 0 || x >= columns || y >= rows) continue;
      const at = y * columns + x;
      if (map[at] < scores[i]) map[at] = scores[i];
    }
  }
  return map;
}

/** The places of a map by the value that stands there: 256 lists of indices. */
function placesByValue(map) {
  const starts = new Uint32Array(257);
  for (const value of map) starts[value + 1]++;
  for (let value = 0; value < 256; value++) starts[value + 1] += starts[value];
  const places = new Uint32Array(map.length);
  const next = starts.slice();
  for (let i = 0; i < map.length; i++) places[next[map[i]]++] = i;
  return Array.from({ length: 256 }, (_, v) => places.subarray(starts[v], starts[v + 1]));
}

/** How many of the scores, sorted from high to low, are at least `threshold`. */
function countAtLeast(scores, threshold) {
  let low = 0;
  let high = scores.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (scores[middle] >= threshold) low = middle + 1;
    else high = middle;
  }
  return low;
}

async function render({ model, el }) {
  const sets = ["all", "kept"].map((name) => ({
    points: typed(model, `${name}_points`, Uint16Array),
    scores: typed(model, `${name}_scores`),
  }));
  const bitmap = await decode(typed(model, "picture"));
  let layers = null;

  function prepare(context, pixelRatio) {
    const { width: columns, height: rows } = context.canvas;
    context.imageSmoothingQuality = "high";
    context.drawImage(bitmap, 0, 0, stage.width, stage.height);
    const frame = context.getImageData(0, 0, columns, rows);
    const scale = model.get("scale") * pixelRatio;
    layers = {
      pixelRatio,
      frame,
      pixels: new Uint32Array(frame.data.buffer),
      background: new Uint32Array(frame.data.buffer.slice(0)),
      rings: sets.map((s) =>
        placesByValue(ringMap(s.points, s.scores, columns, rows, scale, pixelRatio)),
      ),
      shown: { nonmax: null, threshold: 256 },
      colour: new Uint32Array(new Uint8Array([...RING, 255]).buffer)[0],
    };
  }

  function paint(context, pixelRatio) {
    if (layers?.pixelRatio !== pixelRatio) prepare(context, pixelRatio);
    const threshold = model.get("threshold");
    const nonmax = model.get("nonmax") ? 1 : 0;
    const { pixels, background, colour } = layers;
    if (layers.shown.nonmax !== nonmax) {
      pixels.set(background);
      layers.shown = { nonmax, threshold: 256 };
    }
    const rings = layers.rings[nonmax];
    const before = layers.shown.threshold;
    for (let t = threshold; t < before; t++) for (const i of rings[t]) pixels[i] = colour;
    for (let t = before; t < threshold; t++) for (const i of rings[t]) pixels[i] = background[i];
    layers.shown.threshold = threshold;
    context.putImageData(layers.frame, 0, 0);
    const count = countAtLeast(sets[nonmax].scores, threshold);
    const how = nonmax ? "with" : "without";
    return `${count} corners at threshold ${threshold}, ${how} non-maximum suppression`;
  }

  const stage = createStage({ model, el }, paint);
  stage.follow("threshold", "nonmax");
  return stage.dispose;
}

export default { render };
