/* FAST corners over a picture: those that score at least the threshold. */

const RING = [0, 229, 255];

/**
 * For every canvas pixel the highest threshold at which some corner's ring covers it. A repaint
 * then is one comparison per pixel, whether ten corners pass or fifty thousand.
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
      maps: sets.map((s) => ringMap(s.points, s.scores, columns, rows, scale, pixelRatio)),
      colour: new Uint32Array(new Uint8Array([...RING, 255]).buffer)[0],
    };
  }

  function paint(context, pixelRatio) {
    if (layers?.pixelRatio !== pixelRatio) prepare(context, pixelRatio);
    const threshold = model.get("threshold");
    const nonmax = model.get("nonmax") ? 1 : 0;
    const { pixels, background, colour } = layers;
    const map = layers.maps[nonmax];
    for (let i = 0; i < pixels.length; i++)
      pixels[i] = map[i] >= threshold ? colour : background[i];
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
