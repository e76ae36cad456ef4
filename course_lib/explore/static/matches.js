/* Matches between two pictures, and the outline for the slider's position. */

const GREEN = "rgb(34 197 94)";
const RED = "rgb(239 68 68)";

async function render({ model, el }) {
  const n = model.get("matches");
  const lines = typed(model, "lines", Float32Array);
  const shown = typed(model, "shown", Uint16Array);
  const inliers = typed(model, "inliers");
  const outlines = typed(model, "outlines", Float32Array);
  const { all: texts, width, shift, heights } = JSON.parse(model.get("texts"));
  const bitmap = await decode(typed(model, "picture"));

  const page = model.get("width") / width; // picture pixels to CSS pixels
  const drawPictures = backdrop(bitmap, model.get("width"), model.get("height"));

  function strokeMatches(context, state, good) {
    context.beginPath();
    for (let i = 0; i < shown[state]; i++) {
      if (Boolean(inliers[state * n + i]) !== good) continue;
      context.moveTo(lines[4 * i] + 0.5, lines[4 * i + 1] + 0.5);
      context.lineTo(lines[4 * i + 2] + 0.5, lines[4 * i + 3] + 0.5);
    }
    context.strokeStyle = good ? GREEN : RED;
    context.stroke();
  }

  function strokeOutline(context, state) {
    const at = outlines.subarray(8 * state, 8 * state + 8);
    if (Number.isNaN(at[0])) return;
    const believed = !texts[state].includes("NOT");
    context.save();
    context.beginPath(); // an absurd outline must not run over the template
    context.rect(shift, 0, width - shift, bitmap.height);
    context.clip();
    context.beginPath();
    for (let k = 0; k < 8; k += 2) context.lineTo(at[k] + 0.5, at[k + 1] + 0.5);
    context.closePath();
    if (!believed) context.setLineDash([8 / page, 6 / page]);
    for (const [ink, thick] of [["white", 5], [believed ? GREEN : RED, 3]]) {
      context.strokeStyle = ink;
      context.lineWidth = thick / page;
      context.stroke();
    }
    context.restore();
  }

  function paint(context, pixelRatio) {
    const last = shown.length - 1;
    const position = (model.get("value") - model.get("first")) / model.get("step");
    const state = Math.max(0, Math.min(last, Math.round(position)));
    drawPictures(context, pixelRatio);
    context.save();
    context.scale(page, page);
    // Beside the lower picture is the page's colour, be it light or dark.
    stage.wipe(0, heights[0], shift, bitmap.height);
    stage.wipe(shift, heights[1], width - shift, bitmap.height);
    context.lineWidth = 0.9 / page;
    strokeMatches(context, state, false);
    strokeMatches(context, state, true);
    strokeOutline(context, state);
    context.restore();
    return texts[state];
  }

  const stage = createStage({ model, el }, paint);
  stage.follow("value");
  return stage.dispose;
}

export default { render };
