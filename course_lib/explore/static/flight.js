/* A flight frame by frame, the outline found, and a strip that shows the whole flight. */

const GREEN = "rgb(34 197 94)";
const RED = "rgb(239 68 68)";

async function render({ model, el }) {
  const about = JSON.parse(model.get("about"));
  const { counts, every, scale, strip, offsets, faults, inView, judged } = about;
  const [frameWidth, frameHeight] = about.frame;
  const bytes = typed(model, "frames");
  const outlines = typed(model, "outlines", Float32Array);
  const inliers = typed(model, "inliers", Uint16Array);
  const errors = typed(model, "errors", Float32Array);
  const bitmaps = await Promise.all(
    inView.map((_, i) => decode(bytes.subarray(offsets[i], offsets[i + 1]))),
  );
  const columns = inView.length;
  const most = Math.max(10, ...inliers);

  function paintOutline(context, cell, fault) {
    const at = outlines.subarray(8 * cell, 8 * cell + 8);
    if (Number.isNaN(at[0])) return;
    context.beginPath();
    for (let k = 0; k < 8; k += 2)
      context.lineTo((at[k] + 0.5) * scale, (at[k + 1] + 0.5) * scale);
    context.closePath();
    context.setLineDash(fault ? [8, 6] : []);
    for (const [ink, width] of [["white", 5], [fault ? RED : GREEN, 3]]) {
      context.strokeStyle = ink;
      context.lineWidth = width;
      context.stroke();
    }
    context.setLineDash([]);
  }

  function paintStrip(context, theme, position, count) {
    const top = frameHeight + 16;
    const base = frameHeight + strip - 6;
    const step = frameWidth / columns;
    context.font = "11px sans-serif";
    context.textBaseline = "alphabetic";
    for (let i = 0; i < columns; i++) {
      const cell = i * counts.length + count;
      const x = i * step;
      if (inView[i] < 0.5) {
        context.fillStyle = theme.panel;
        context.fillRect(x, top, step, base - top);
      }
      const tall = ((base - top) * Math.min(inliers[cell], most)) / most;
      context.fillStyle = faults[i][count] ? theme.faint : GREEN;
      context.fillRect(x + 1, base - tall, Math.max(1, step - 2), tall);
      if (!Number.isNaN(errors[cell])) {
        // 1 pixel at the foot, 100 pixels at the top
        const high = ((base - top) * Math.log10(Math.max(1, Math.min(100, errors[cell])))) / 2;
        context.fillStyle = theme.bad;
        context.beginPath();
        context.arc(x + step / 2, base - high, 2.6, 0, 7);
        context.fill();
      }
    }
    context.strokeStyle = theme.accent;
    context.lineWidth = 2;
    context.strokeRect(position * step, top - 2, step, base - top + 4);
    context.fillStyle = theme.ink;
    const dots = judged ? "  ·  red dots: error, 1 px (foot) to 100 px (top)" : "";
    context.fillText(`bars: inliers, green where found, up to ${most}${dots}`, 2, frameHeight + 11);
  }

  function paint(context, _ratio, theme) {
    const position = Math.max(0, Math.min(columns - 1, model.get("position")));
    const count = model.get("count");
    const cell = position * counts.length + count;
    const fault = faults[position][count];
    stage.wipe();
    context.drawImage(bitmaps[position], 0, 0, frameWidth, frameHeight);
    context.save();
    context.beginPath();
    context.rect(0, 0, frameWidth, frameHeight);
    context.clip();
    paintOutline(context, cell, fault);
    context.restore();
    paintStrip(context, theme, position, count);
    const used = counts[count] >= 1000 ? "all" : counts[count];
    const verdict = fault ? `NOT found: ${fault}` : "found";
    const off = Number.isNaN(errors[cell]) ? "" : `, ${errors[cell].toFixed(1)} pixels off`;
    return (
      `Frame ${position * every}, ${used} matches: ${inliers[cell]} inliers, ${verdict}${off}. ` +
      `Over the flight: outlined in ${faults.filter((row) => !row[count]).length} of ${columns} ` +
      "frames."
    );
  }

  const stage = createStage({ model, el }, paint, { lines: 2 });
  const { canvas } = stage;
  canvas.addEventListener("pointerdown", (event) => {
    const [x, y] = stage.locate(event);
    if (y < frameHeight) return;
    model.set("position", Math.floor((x / frameWidth) * columns));
    model.save_changes();
  });
  stage.follow("position", "count");
  return stage.dispose;
}

export default { render };
