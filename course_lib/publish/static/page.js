/* Widgets without a kernel, part 3: anywidget's modules, and the start of the page. */
"use strict";

const modules = new Map();

/** Load a widget's JavaScript once, however many widgets share it. */
function loadModule(source) {
  if (!modules.has(source)) {
    const address = URL.createObjectURL(new Blob([source], { type: "text/javascript" }));
    const load = import(address).then(async (module) => {
      const definition = module.default ?? module;
      return typeof definition === "function" ? definition() : definition;
    });
    modules.set(source, load.finally(() => URL.revokeObjectURL(address)));
  }
  return modules.get(source);
}

const styles = new Set();
const initialised = new Map();

async function anywidget(model) {
  const el = make("div", { class: "w-canvas" });
  const css = model.get("_css");
  if (css && !styles.has(css)) document.head.append(make("style", {}, css));
  styles.add(css);
  const definition = await loadModule(model.get("_esm"));
  const { signal } = new AbortController();
  if (!initialised.has(model))
    initialised.set(model, definition.initialize?.({ model, signal, experimental: {} }));
  await initialised.get(model);
  // A view may measure itself or its theme, so it has to stand in the page first.
  el.mount = () => definition.render?.({ model, el, signal, experimental: {} });
  return el;
}

/** Build a widget's element; `mount` functions are called once it stands in the page. */
async function createView(model) {
  const build = model.module === "anywidget" ? anywidget : CONTROLS[model.name];
  if (!build) throw new Error(`this page cannot show a ${model.name}`);
  const element = await build(model);
  for (const name of model.get("_dom_classes") ?? []) element.classList.add(name);
  const layout = model.get("layout") && model.widget_manager.model(model.get("layout"));
  if (layout)
    for (const [name, value] of Object.entries(layout.get("css") ?? {}))
      element.style.setProperty(name, value);
  if (model.get("tooltip")) element.title = model.get("tooltip");
  return element;
}

async function showWidgets() {
  const state = document.getElementById("widget-state");
  if (!state) return;
  const manager = new Manager(JSON.parse(state.textContent));
  for (const place of document.querySelectorAll(".widget[data-model]")) {
    const still = [...place.children];
    try {
      const view = await createView(manager.model(place.dataset.model));
      place.append(view);
      for (const element of [view, ...view.querySelectorAll(".w-canvas")]) await element.mount?.();
      still.forEach((element) => element.remove());
      place.dataset.live = "";
    } catch (error) {
      place.replaceChildren(...still); // the picture is better than half a widget
      console.error(error);
    }
  }
}

function setUpTheme() {
  const button = document.getElementById("theme");
  const root = document.documentElement;
  const dark = () =>
    (root.dataset.theme ?? (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "")) ===
    "dark";
  const announce = () => {
    button.setAttribute("aria-pressed", String(dark()));
    // Canvases listen for JupyterLab's change of theme; give them the same sign.
    document.body.dataset.jpThemeName = dark() ? "dark" : "light";
  };
  button.addEventListener("click", () => {
    root.dataset.theme = dark() ? "light" : "dark";
    announce();
    try {
      localStorage.setItem("theme", root.dataset.theme);
    } catch {} // storage may be forbidden; then the choice lasts for this page
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", announce);
  announce();
}

setUpTheme();
showWidgets().finally(() => (document.documentElement.dataset.widgets = "ready"));
