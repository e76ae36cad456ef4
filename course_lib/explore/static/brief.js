/* Two patches, BRIEF's tests upon them, their bits and the Hamming distance. */

const ONE = "#f59e0b";
const ZERO = "#3b82f6";
const A = "#00e5ff";
const B = "#ff5cf0";
const LINES = 64; // more would hide the patch

async function render({ model, el }) {
  const about = JSON.parse(model.get("about"));
  const { points, columns, panel, gap, patch, sizes, sigmas, tests, names, same } = about;
  const [mapWidth, mapHeight] = about.map;
  const pairs = typed(model, "pairs", Int8Array);
  const patches = typed(model, "patches");
  const drawMap = backdrop(await decode(typed(model, "picture")), mapWidth, mapHeight);
  const area = patch * patch;
  const half = (patch - 1) / 2;
  const cell = panel / patch;

  function patchOf(side, point) {
    const index = (side * sigmas.length + model.get("smoothing")) * points.length + point;
    return patches.subarray(index * area, (index + 1) * area);
  }

  function bitsOf(values, count) {
    const offset = model.get("geometry") * tests * 4;
    return Array.from({ length: count }, (_, i) => {
      const [x1, y1, x2, y2] = pairs.subarray(offset + 4 * i, offset + 4 * i + 4);
      const at = (x, y) => values[(y + half) * patch + x + half];
      return at(x1, y1) < at(x2, y2) ? 1 : 0;
    });
  }

  function paintMap(context, pixelRatio, theme) {
    drawMap(context, pixelRatio);
    const scale = mapWidth / columns;
    const chosen = [model.get("first") - 1, model.get("second") - 1];
    context.font = "bold 12px sans-serif";
    points.forEach(([x, y], i) => {
      const [cx, cy] = [(x + 0.5) * scale, (y + 0.5) * scale];
      context.beginPath();
      context.arc(cx, cy, 4, 0, 7);
      context.lineWidth = 2;
      context.strokeStyle = "white";
      context.stroke();
      chosen.forEach((point, side) => {
        if (point !== i) return;
        context.strokeStyle = side ? B : A;
        context.strokeRect(cx - 9 - 3 * side, cy - 9 - 3 * side, 18 + 6 * side, 18 + 6 * side);
        context.fillStyle = side ? B : A;
        context.fillText(side ? "B" : "A", cx + (side ? 14 : -24), cy - 8);
      });
    });
    context.fillStyle = theme.ink;
  }

  function paintPatch(context, left, values, bits, ink) {
    for (let y = 0; y < patch; y++)
      for (let x = 0; x < patch; x++) {
        const value = values[y * patch + x];
        context.fillStyle = `rgb(${value} ${value} ${value})`;
        context.fillRect(left + x * cell, y * cell, cell + 0.5, cell + 0.5);
      }
    const offset = model.get("geometry") * tests * 4;
    const place = (v) => (v + half + 0.5) * cell;
    context.lineWidth = 1.1;
    for (let i = 0; i < Math.min(LINES, bits.length); i++) {
      const [x1, y1, x2, y2] = pairs.subarray(offset + 4 * i, offset + 4 * i + 4);
      context.strokeStyle = bits[i] ? ONE : ZERO;
      context.beginPath();
      context.moveTo(left + place(x1), place(y1));
      context.lineTo(left + place(x2), place(y2));
      context.stroke();
    }
    context.strokeStyle = ink;
    context.lineWidth = 3;
    context.strokeRect(left + 1.5, 1.5, panel - 3, panel - 3);
  }

  function paintBits(context, theme, a, b) {
    const perRow = 64;
    const width = (2 * panel + gap - 40) / perRow;
    const rows = a.length / perRow;
    const left = mapWidth + gap + 40;
    const height = Math.min(width, 76 / (3 * rows));
    context.font = "12px sans-serif";
    context.textBaseline = "middle";
    [["A", a], ["B", b], ["A≠B", a.map((bit, i) => bit ^ b[i])]].forEach(([name, bits], k) => {
      const top = panel + 8 + k * (height * rows + 5);
      context.fillStyle = theme.ink;
      context.fillText(name, mapWidth + gap, top + (height * rows) / 2);
      bits.forEach((bit, i) => {
        context.fillStyle = k < 2 ? (bit ? ONE : ZERO) : bit ? theme.bad : theme.panel;
        const x = left + (i % perRow) * width;
        context.fillRect(x, top + Math.floor(i / perRow) * height, width - 0.6, height - 0.6);
      });
    });
  }

  function paint(context, pixelRatio, theme) {
    const count = 8 * sizes[model.get("size")];
    const [p, q] = [model.get("first"), model.get("second")];
    const values = [patchOf(0, p - 1), patchOf(1, q - 1)];
    const [a, b] = values.map((v) => bitsOf(v, count));
    stage.wipe();
    paintMap(context, pixelRatio, theme);
    paintPatch(context, mapWidth + gap, values[0], a, A);
    paintPatch(context, mapWidth + gap * 2 + panel, values[1], b, B);
    paintBits(context, theme, a, b);
    const distance = a.filter((bit, i) => bit !== b[i]).length;
    const where = same ? "" : " of the other picture";
    return (
      `Point A is ${p}, point B is ${q}${where}. Geometry ${names[model.get("geometry")]}, ` +
      `sigma ${sigmas[model.get("smoothing")]}: Hamming distance ${distance} of ${count} bits ` +
      `(${Math.round((100 * distance) / count)} %). Orange tests give 1, blue 0; ` +
      `the first ${LINES} are drawn.`
    );
  }

  const stage = createStage({ model, el }, paint, { lines: 2 });
  stage.follow("geometry", "size", "smoothing", "first", "second");
  return stage.dispose;
}

export default { render };
