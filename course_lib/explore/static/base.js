/* Shared by every viewer; Python puts this text in front of the viewer's own module. */

/** A binary trait as a typed array of its own (the message's buffer may be unaligned). */
function typed(model, name, Type = Uint8Array) {
  const view = model.get(name);
  return new Type(view.buffer.slice(view.byteOffset, view.byteOffset + view.byteLength));
}

/** Decode an encoded picture once; a bitmap is drawn without a wait, so no frame is blank. */
function decode(bytes) {
  return createImageBitmap(new Blob([bytes]));
}

/**
 * A function that draws a bitmap at a fixed size, resampled once for each pixel density: a
 * repaint then only copies pixels.
 */
function backdrop(bitmap, width, height) {
  let copy = null;
  return (context, pixelRatio) => {
    const columns = Math.round(width * pixelRatio);
    if (copy?.width !== columns) {
      copy = new OffscreenCanvas(columns, Math.round(height * pixelRatio));
      const pen = copy.getContext("2d", { alpha: false });
      pen.imageSmoothingQuality = "high";
      pen.drawImage(bitmap, 0, 0, copy.width, copy.height);
    }
    context.drawImage(copy, 0, 0, width, height);
  };
}

const REST = 250; // milliseconds

/**
 * Let the widgets named in `quiet` tell the kernel their values only when they have come to rest.
 * Told at each step of a drag, the kernel answers each with three messages, and handling those
 * took the browser longer than painting.
 */
async function quieten(model) {
  for (const id of model.get("quiet")) {
    const widget = await model.widget_manager.get_model(id);
    const save = widget.save_changes;
    if (save.isQuiet) continue;
    let timer = 0;
    widget.save_changes = (...options) => {
      clearTimeout(timer);
      timer = setTimeout(() => save.apply(widget, options), REST);
    };
    widget.save_changes.isQuiet = true;
  }
}

/** The colour that shows behind an element. */
function behind(el) {
  for (let e = el; e; e = e.parentElement) {
    const colour = getComputedStyle(e).backgroundColor;
    if (!/^(transparent|rgba\(.*, 0\))$/.test(colour)) return colour;
  }
  return "Canvas"; // the page's own, by the browser's account
}

/** Colours of the page's theme, for what is drawn on the page's own background. */
function themeOf(el) {
  const style = getComputedStyle(el);
  const [r, g, b] = (style.color.match(/[\d.]+/g) ?? [0, 0, 0]).map(Number);
  const dark = r + g + b > 384; // light ink means a dark page
  return {
    dark,
    ink: style.color,
    page: behind(el),
    faint: dark ? "#7d8590" : "#8a939d",
    panel: dark ? "#20262d" : "#f1f3f5",
    good: dark ? "#4ade80" : "#15803d",
    bad: dark ? "#fb7185" : "#c81e3a",
    accent: dark ? "#60a5fa" : "#1d4ed8",
    font: style.fontFamily,
  };
}

/**
 * A canvas of fixed size with a line of text under it. `paint(context, scale, theme)` draws all
 * of it, in CSS pixels, and returns the text. Repaints are asked for with `redraw()`, happen at
 * most once per animation frame, and in the frame of the event that asked.
 */
function createStage({ model, el }, paint, { lines = 1, focusable = false } = {}) {
  quieten(model);
  const width = model.get("width");
  const height = model.get("height");
  el.classList.add("fm-viewer");

  const canvas = document.createElement("canvas");
  canvas.style.width = `${width}px`;
  canvas.style.aspectRatio = `${width} / ${height}`;
  canvas.setAttribute("role", focusable ? "application" : "img");
  canvas.setAttribute("aria-label", model.get("alt"));
  if (focusable) canvas.tabIndex = 0;

  const readout = document.createElement("p");
  readout.className = "fm-readout";
  readout.setAttribute("aria-live", "polite");
  readout.style.height = `${1.4 * lines}em`;
  el.append(canvas, readout);

  // Opaque, so that the browser need not draw what is below: half the work of showing a frame where
  // no graphics card does it.
  const context = canvas.getContext("2d", { alpha: false });
  let theme = null;
  let pending = 0;

  function draw() {
    pending = 0;
    const scale = window.devicePixelRatio || 1;
    const pixels = Math.round(width * scale);
    if (canvas.width !== pixels) {
      canvas.width = pixels;
      canvas.height = Math.round(height * scale);
    }
    theme ??= themeOf(el);
    context.setTransform(scale, 0, 0, scale, 0, 0);
    const text = paint(context, scale, theme);
    if (readout.textContent !== text) readout.textContent = text;
  }
  const redraw = () => {
    pending ||= requestAnimationFrame(draw);
  };

  const repaintInNewTheme = () => {
    theme = null;
    redraw();
  };
  const observer = new MutationObserver(repaintInNewTheme);
  observer.observe(document.body, { attributeFilter: ["data-jp-theme-name"] });
  window.addEventListener("resize", redraw); // also fires when the page is zoomed

  const stops = [];
  return {
    canvas,
    context,
    width,
    height,
    redraw,
    /** Give a part of the canvas, or all of it, the colour of the page around it. */
    wipe(x = 0, y = 0, wide = width, high = height) {
      context.fillStyle = theme.page;
      context.fillRect(x, y, wide, high);
    },
    /** Repaint whenever one of these traits changes. */
    follow(...names) {
      for (const name of names) {
        model.on(`change:${name}`, redraw);
        stops.push(() => model.off(`change:${name}`, redraw));
      }
      redraw();
    },
    /** Where a pointer event fell, in the canvas's CSS pixels. */
    locate(event) {
      const box = canvas.getBoundingClientRect();
      return [
        ((event.clientX - box.left) * width) / box.width,
        ((event.clientY - box.top) * height) / box.height,
      ];
    },
    dispose() {
      cancelAnimationFrame(pending);
      observer.disconnect();
      window.removeEventListener("resize", redraw);
      for (const stop of stops) stop();
    },
  };
}
