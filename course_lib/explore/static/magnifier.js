/* FAST's segment test at one pixel: a picture to point at, and its circle magnified. */

const BRIGHTER = "#ffa500";
const DARKER = "#1e78ff";
const SIMILAR = "#a0a0a0";
const GAP = 20;
const SNAP = 5; // CSS pixels
const DOTS = 1500; // more would hide the picture

/** The longest run of one sign round the circle: its length, first place and sign. */
function longestRun(signs) {
  let best = { length: 0, start: 0, sign: 0 };
  for (const sign of [1, -1])
    for (let start = 0; start < 16; start++) {
      let length = 0;
      while (length < 16 && signs[(start + length) % 16] === sign) length++;
      if (length > best.length) best = { length, start, sign };
    }
  return best;
}

async function render({ model, el }) {
  const about = JSON.parse(model.get("about"));
  const { columns, rows, panel, reach, circle } = about;
  const [mapWidth, mapHeight] = about.map;
  const grey = typed(model, "grey");
  const drawMap = backdrop(await decode(typed(model, "picture")), mapWidth, mapHeight);
  const corners = [9, 12].map((n) => ({
    points: typed(model, `kept${n}_points`, Uint16Array),
    scores: typed(model, `kept${n}_scores`),
  }));
  let held = false; // whether the point stays although the pointer moves on
  const scale = mapWidth / columns;
  const cell = panel / (2 * reach + 1);

  const at = (x, y) => (x < 0 || y < 0 || x >= columns || y >= rows ? null : grey[y * columns + x]);

  /** Highest threshold at which the pixel is still a corner, -1 when it is none even at 0. */
  function score(x, y, n) {
    const centre = at(x, y);
    const ring = circle.map(([dx, dy]) => at(x + dx, y + dy));
    if (ring.includes(null)) return -1;
    let best = -1;
    for (const sign of [1, -1])
      for (let start = 0; start < 16; start++) {
        let least = 255;
        for (let k = 0; k < n; k++)
          least = Math.min(least, sign * (ring[(start + k) % 16] - centre) - 1);
        best = Math.max(best, least);
      }
    return best;
  }

  /** Visit the corners at the slider's threshold, best first, until `visit` returns true. */
  function eachCorner(most, visit) {
    const { points, scores } = corners[model.get("choice")];
    const threshold = model.get("threshold");
    for (let i = 0; i < Math.min(most, scores.length) && scores[i] >= threshold; i++)
      if (visit(points[2 * i], points[2 * i + 1])) return;
  }

  function paintMap(context, pixelRatio, x, y) {
    drawMap(context, pixelRatio);
    context.fillStyle = "#00e5ff";
    eachCorner(DOTS, (px, py) => {
      context.fillRect((px + 0.5) * scale - 1, (py + 0.5) * scale - 1, 2, 2);
    });
    const [cx, cy] = [(x + 0.5) * scale, (y + 0.5) * scale];
    for (const [ink, width] of [["black", 4], ["#00e5ff", 2]]) {
      context.strokeStyle = ink;
      context.lineWidth = width;
      context.strokeRect(cx - 9, cy - 9, 18, 18);
    }
  }

  function paintPanel(context, x, y, signs, run, n) {
    context.font = `${Math.round(cell * 0.36)}px sans-serif`;
    context.textAlign = "center";
    context.textBaseline = "middle";
    for (let dy = -reach; dy <= reach; dy++)
      for (let dx = -reach; dx <= reach; dx++) {
        const value = at(x + dx, y + dy);
        const [left, top] = [(dx + reach) * cell, (dy + reach) * cell];
        context.fillStyle = value === null ? "#7a1f3d" : `rgb(${value} ${value} ${value})`;
        context.fillRect(left, top, cell + 0.5, cell + 0.5);
      }
    const label = (dx, dy, text) => {
      const value = at(x + dx, y + dy);
      if (value === null) return;
      context.fillStyle = value > 127 ? "black" : "white";
      context.fillText(text, (dx + reach + 0.5) * cell, (dy + reach + 0.5) * cell);
    };
    circle.forEach(([dx, dy], k) => {
      const inRun = run.length && (k - run.start + 16) % 16 < run.length;
      context.strokeStyle = signs[k] > 0 ? BRIGHTER : signs[k] < 0 ? DARKER : SIMILAR;
      context.lineWidth = signs[k] ? (inRun ? 5 : 2.5) : 1;
      context.strokeRect((dx + reach) * cell + 3, (dy + reach) * cell + 3, cell - 6, cell - 6);
      label(dx, dy, at(x + dx, y + dy));
    });
    context.strokeStyle = "white";
    context.lineWidth = 2;
    context.strokeRect(reach * cell + 1, reach * cell + 1, cell - 2, cell - 2);
    label(0, 0, at(x, y));
    if (run.length > 1) {
      context.beginPath();
      for (let k = 0; k < run.length; k++) {
        const [dx, dy] = circle[(run.start + k) % 16];
        const far = 1.32; // outside the circle, so that the numbers stay readable
        context.lineTo((dx * far + reach + 0.5) * cell, (dy * far + reach + 0.5) * cell);
      }
      if (run.length === 16) context.closePath();
      context.strokeStyle = run.length >= n ? "#22c55e" : "#f43f5e";
      context.lineWidth = 4;
      context.stroke();
    }
  }

  function paint(context, pixelRatio) {
    const [x, y, t] = [model.get("x"), model.get("y"), model.get("threshold")];
    const n = model.get("choice") ? 12 : 9;
    const centre = at(x, y);
    const signs = circle.map(([dx, dy]) => {
      const value = at(x + dx, y + dy);
      return value === null ? 0 : Number(value > centre + t) - Number(value < centre - t);
    });
    const run = longestRun(signs);
    stage.wipe();
    paintMap(context, pixelRatio, x, y);
    context.save();
    context.translate(mapWidth + GAP, 0);
    paintPanel(context, x, y, signs, run, n);
    context.restore();

    const brighter = signs.filter((s) => s > 0).length;
    const darker = signs.filter((s) => s < 0).length;
    const word = run.sign > 0 ? "brighter" : run.sign < 0 ? "darker" : "different";
    const isCorner = run.length >= n;
    const best = score(x, y, n);
    const rank =
      best < 1 ? "no corner at any threshold" : `a corner at every threshold up to ${best}`;
    return (
      `(${x}, ${y}) has grey value ${centre}: ${brighter} brighter (orange), ${darker} darker ` +
      `(blue) at threshold ${t}. ${isCorner ? "CORNER" : "No corner"}: ${run.length} contiguous ${word}, ` +
      `needs ${n}; ${rank}. ${held ? "Held: click the square to let go." : "Click to hold."}`
    );
  }

  const stage = createStage({ model, el }, paint, { lines: 3, focusable: true });
  const { canvas } = stage;
  canvas.style.cursor = "crosshair";
  canvas.style.touchAction = "none";

  function moveTo(x, y) {
    model.set("x", Math.max(0, Math.min(columns - 1, x)));
    model.set("y", Math.max(0, Math.min(rows - 1, y)));
    model.save_changes();
  }
  /** The corner next to a place of the map, or the pixel there when no corner is near. */
  function pick(px, py) {
    let best = [Math.floor(px / scale), Math.floor(py / scale)];
    let nearest = SNAP;
    eachCorner(Infinity, (x, y) => {
      const away = Math.hypot((x + 0.5) * scale - px, (y + 0.5) * scale - py);
      if (away < nearest) [nearest, best] = [away, [x, y]];
    });
    return best;
  }
  const onMap = (px, py) => px >= 0 && py >= 0 && px < mapWidth && py < mapHeight;

  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    const [px, py] = stage.locate(event);
    const [x, y] = [model.get("x"), model.get("y")];
    if (onMap(px, py)) {
      const onSquare = Math.max(Math.abs((x + 0.5) * scale - px), Math.abs((y + 0.5) * scale - py)) < 9;
      held = !(held && onSquare);
      moveTo(...pick(px, py));
    } else if (px >= mapWidth + GAP && py < panel) {
      held = true;
      moveTo(
        x + Math.floor((px - mapWidth - GAP) / cell) - reach,
        y + Math.floor(py / cell) - reach,
      );
    }
    stage.redraw();
  });
  canvas.addEventListener("pointermove", (event) => {
    const [px, py] = stage.locate(event);
    if (onMap(px, py) && (!held || event.buttons)) moveTo(...pick(px, py));
  });
  canvas.addEventListener("keydown", (event) => {
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[
      event.key
    ];
    if (!step) return;
    event.preventDefault(); // neither the page nor the notebook's cells should move
    event.stopPropagation();
    held = true;
    const far = event.shiftKey ? 10 : 1;
    moveTo(model.get("x") + far * step[0], model.get("y") + far * step[1]);
  });
  stage.follow("threshold", "choice", "x", "y");
  return stage.dispose;
}

export default { render };
