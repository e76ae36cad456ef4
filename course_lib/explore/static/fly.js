/* The cockpit: keys and sliders set a velocity, the kernel sends the pictures that are asked for. */

const KEYS = {
  w: ["vx", 1], s: ["vx", -1], a: ["vy", 1], d: ["vy", -1],
  r: ["vz", 1], f: ["vz", -1],
  arrowup: ["vx", 1], arrowdown: ["vx", -1], arrowleft: ["yaw", 1], arrowright: ["yaw", -1],
};
const SPEED = { vx: 0.8, vy: 0.6, vz: 0.5, yaw: 0.6 };
const SETTLE = 2500; // milliseconds that frames still come after the last command: it brakes
const PATIENCE = 4000; // without an answer for so long there is no kernel
const AT_ONCE = 6; // frames of one request; a slow page is never more than these behind
const RATE_OVER = 20; // frames

async function render({ model, el }) {
  let bitmap = await decode(typed(model, "picture"));
  let about = JSON.parse(model.get("first"));
  let owed = 0; // frames asked for that have not come
  let heard = 0; // when the last one came
  let awake = 0; // until when frames are asked for
  let answers = 0;
  let shown = 0; // the answer that is on the canvas
  let arrivals = [];
  let silent = false;
  let gone = false;

  const command = () => Object.fromEntries(Object.keys(SPEED).map((k) => [k, model.get(k)]));
  const moving = () => Object.values(command()).some((v) => v !== 0);

  function ask({ atOnce = false } = {}) {
    if (gone || document.hidden) return;
    if (!moving() && performance.now() > awake) {
      arrivals = [];
      stage.redraw();
      return;
    }
    if (!atOnce && owed > AT_ONCE / 2) return;
    owed = AT_ONCE;
    model.send({ kind: "look", command: command(), frames: owed });
    const sent = performance.now();
    setTimeout(() => {
      if (heard > sent || gone) return;
      owed = 0;
      silent = true;
      stage.redraw();
    }, PATIENCE);
  }

  function steer() {
    awake = performance.now() + SETTLE;
    ask({ atOnce: true });
    stage.redraw();
  }

  async function onMessage(message, buffers) {
    if (message.kind !== "frame") return;
    const turn = ++answers;
    owed--;
    heard = performance.now();
    silent = false;
    ask();
    const view = buffers[0];
    const bytes = new Uint8Array(view.buffer ?? view, view.byteOffset ?? 0, view.byteLength);
    const next = await decode(bytes);
    if (gone || turn < shown) {
      next.close();
      return;
    }
    shown = turn;
    bitmap.close();
    bitmap = next;
    about = message;
    arrivals = [...arrivals, performance.now()].slice(-RATE_OVER);
    stage.redraw();
  }

  function outline(context, points, ink, width) {
    if (!points.length) return;
    context.beginPath();
    for (let k = 0; k < points.length; k += 2) context.lineTo(points[k] + 0.5, points[k + 1] + 0.5);
    context.closePath();
    for (const [colour, wide] of [["white", width + 2], [ink, width]]) {
      context.strokeStyle = colour;
      context.lineWidth = wide;
      context.stroke();
    }
  }

  /** The command as an instrument: a stick seen from above, climb beside it, turn as an arc. */
  function paintStick(context, v) {
    const [x, y, r] = [58, stage.height - 58, 40];
    context.lineWidth = 2;
    context.fillStyle = "rgb(0 0 0 / 45%)";
    context.strokeStyle = "white";
    context.beginPath();
    context.arc(x, y, r, 0, 7);
    context.fill();
    context.stroke();
    context.fillRect(x + r + 10, y - r, 8, 2 * r);
    context.fillStyle = "rgb(250 204 21)";
    context.fillRect(x + r + 10, y, 8, -r * v.vz);
    context.beginPath();
    context.arc(x - 24 * v.vy, y - 24 * v.vx, 8, 0, 7);
    context.fill();
    if (v.yaw) {
      context.strokeStyle = "rgb(250 204 21)";
      context.lineWidth = 5;
      context.beginPath();
      context.arc(x, y, r + 5, -Math.PI / 2, -Math.PI / 2 - 1.5 * v.yaw, v.yaw > 0);
      context.stroke();
    }
  }

  function paint(context) {
    context.drawImage(bitmap, 0, 0, stage.width, stage.height);
    if (about.corners.length) outline(context, about.corners, "rgb(34 197 94)", 3);
    const v = command();
    paintStick(context, v);
    const signed = (value, one, other) =>
      value ? `${value > 0 ? one : other} ${Math.abs(value).toFixed(1)}` : "";
    const words = [
      signed(v.vx, "forward", "back"), signed(v.vy, "left", "right"),
      signed(v.vz, "up", "down"), signed(v.yaw, "turning left", "turning right"),
    ].filter(Boolean);
    const span = arrivals.length > 2 ? (arrivals.at(-1) - arrivals[0]) / (arrivals.length - 1) : 0;
    const rate = span ? ` ${(1000 / span).toFixed(0)} frames a second.` : "";
    const first = words.length ? `Command: ${words.join(", ")}.` : "Command: hover.";
    if (silent) return `${first} No kernel answers: run this cell to fly.`;
    return `${first}${rate} ${about.text} Click the picture, then W A S D, arrows, R F; space stops.`;
  }

  const stage = createStage({ model, el }, paint, { lines: 2, focusable: true });
  const { canvas } = stage;
  const held = new Map(); // key: trait

  function set(name, value) {
    model.set(name, value);
    model.save_changes();
  }
  canvas.addEventListener("keydown", (event) => {
    const key = event.key.toLowerCase();
    if (event.ctrlKey || event.metaKey || event.altKey || (key !== " " && !(key in KEYS))) return;
    event.preventDefault();
    event.stopPropagation(); // JupyterLab has meanings of its own for letters
    if (key === " ") {
      held.clear();
      for (const name of Object.keys(SPEED)) set(name, 0);
    } else if (!held.has(key)) {
      const [name, sign] = KEYS[key];
      held.set(key, name);
      set(name, sign * SPEED[name]);
    }
  });
  canvas.addEventListener("keyup", (event) => {
    const key = event.key.toLowerCase();
    if (!held.has(key)) return;
    event.stopPropagation();
    set(held.get(key), 0);
    held.delete(key);
  });
  canvas.addEventListener("blur", () => {
    for (const name of held.values()) set(name, 0);
    held.clear();
  });
  canvas.addEventListener("pointerdown", () => canvas.focus());

  const names = Object.keys(SPEED);
  for (const name of names) model.on(`change:${name}`, steer);
  model.on("msg:custom", onMessage);
  document.addEventListener("visibilitychange", ask);
  stage.redraw();
  return () => {
    gone = true;
    for (const name of names) model.off(`change:${name}`, steer);
    model.off("msg:custom", onMessage);
    document.removeEventListener("visibilitychange", ask);
    stage.dispose();
  };
}

export default { render };
