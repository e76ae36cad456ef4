/* Widgets without a kernel, part 2: ipywidgets' controls as the browser's own, labelled ones. */
"use strict";

let lastId = 0;

function make(tag, properties = {}, ...children) {
  const { class: className = "", ...rest } = properties;
  const element = Object.assign(document.createElement(tag), rest);
  element.className = className;
  element.append(...children);
  return element;
}

/** Call `show` now and whenever one of the traits changes. */
function follow(model, names, show) {
  for (const name of names) model.on(`change:${name}`, show);
  show();
}

/** A number as Python's format specification writes it; the few forms that sliders use. */
function formatNumber(value, specification = "") {
  const [, digits, kind] = /\.(\d+)([fg])$/.exec(specification) ?? [];
  if (kind === "f") return value.toFixed(Number(digits));
  if (kind === "g") return String(Number(value.toPrecision(Number(digits))));
  return specification.endsWith("d") ? String(Math.round(value)) : String(value);
}

/** Description, control and readout in a row. */
function row(model, control, ...after) {
  control.id = `control-${++lastId}`;
  const label = make("label", { htmlFor: control.id });
  follow(model, ["description"], () => {
    if (model.get("description_allow_html")) label.innerHTML = model.get("description");
    else label.textContent = model.get("description");
    label.hidden = !model.get("description");
    if (label.hidden) control.setAttribute("aria-label", model.get("tooltip") ?? "value");
  });
  if ("disabled" in control)
    follow(model, ["disabled"], () => (control.disabled = Boolean(model.get("disabled"))));
  return make("div", { class: "w-row" }, label, control, ...after);
}

function slider(trait, { position = (m, v) => v, value = (m, p) => p, text } = {}) {
  return (model) => {
    const control = make("input", { type: "range" });
    const readout = make("output");
    follow(model, ["min", "max", "step", "_options_labels", trait], () => {
      const last = model.get("_options_labels")?.length - 1;
      control.min = model.get("min") ?? 0;
      control.max = model.get("max") ?? last;
      control.step = model.get("step") ?? 1;
      control.value = position(model, model.get(trait));
      const words = text?.(model) ?? formatNumber(model.get(trait), model.get("readout_format"));
      readout.textContent = words;
      control.setAttribute("aria-valuetext", words);
      readout.hidden = model.get("readout") === false;
    });
    const event = model.get("continuous_update") === false ? "change" : "input";
    control.addEventListener(event, () => model.set(trait, value(model, Number(control.value))));
    return row(model, control, readout);
  };
}

function numberField(model) {
  const control = make("input", { type: "number" });
  follow(model, ["min", "max", "step", "value"], () => {
    control.min = model.get("min") ?? "";
    control.max = model.get("max") ?? "";
    control.step = model.get("step") ?? (model.name.includes("Int") ? 1 : "any");
    control.value = model.get("value");
  });
  control.addEventListener("change", () => {
    const low = model.get("min") ?? -Infinity;
    const high = model.get("max") ?? Infinity;
    const typed = control.value === "" ? model.get("value") : Number(control.value);
    const whole = model.name.includes("Int") ? Math.round(typed) : typed;
    model.set("value", Math.min(high, Math.max(low, whole)));
    control.value = model.get("value");
  });
  return row(model, control);
}

function checkbox(model) {
  const control = make("input", { type: "checkbox" });
  follow(model, ["value"], () => (control.checked = model.get("value")));
  control.addEventListener("change", () => model.set("value", control.checked));
  const line = row(model, control);
  line.classList.add("w-checkbox");
  return line;
}

function toggleButton(model) {
  const control = make("button", { type: "button", class: "w-toggle" });
  follow(model, ["value", "description"], () => {
    control.textContent = model.get("description");
    control.setAttribute("aria-pressed", String(model.get("value")));
  });
  control.addEventListener("click", () => model.set("value", !model.get("value")));
  return control;
}

function dropdown(model) {
  const control = make("select");
  follow(model, ["_options_labels", "index"], () => {
    control.replaceChildren(...model.get("_options_labels").map((text) => new Option(text)));
    control.selectedIndex = model.get("index") ?? -1;
  });
  control.addEventListener("change", () => model.set("index", control.selectedIndex));
  return row(model, control);
}

function choice(className) {
  return (model) => {
    const legend = make("legend", {}, model.get("description"));
    legend.hidden = !model.get("description");
    const name = `choice-${++lastId}`;
    const options = model.get("_options_labels").map((text, index) => {
      const input = make("input", { type: "radio", name });
      input.addEventListener("change", () => model.set("index", index));
      return make("label", { title: model.get("tooltips")?.[index] ?? "" }, input, text);
    });
    follow(model, ["index"], () =>
      options.forEach((option, i) => (option.control.checked = i === model.get("index"))),
    );
    return make("fieldset", { class: className }, legend, ...options);
  };
}

function play(model) {
  const button = make("button", { type: "button", class: "w-play" });
  let timer = 0;
  function step() {
    const next = model.get("value") + model.get("step");
    if (next <= model.get("max")) model.set("value", next);
    else if (model.get("repeat")) model.set("value", model.get("min"));
    else model.set("playing", false);
  }
  follow(model, ["playing", "interval"], () => {
    const playing = model.get("playing");
    clearInterval(timer);
    if (playing) timer = setInterval(step, model.get("interval"));
    button.textContent = playing ? "❚❚" : "▶";
    button.setAttribute("aria-label", playing ? "pause" : "play");
  });
  button.addEventListener("click", () => {
    // At the end, play means once more from the start.
    if (!model.get("playing") && model.get("value") >= model.get("max"))
      model.set("value", model.get("min"));
    model.set("playing", !model.get("playing"));
  });
  return make("div", { class: "w-row" }, button);
}

function text(trait) {
  return (model) => {
    const element = make("div", { class: "w-text" });
    follow(model, ["value"], () => (element[trait] = model.get("value")));
    return element;
  };
}

function box(className) {
  return async (model) => {
    const views = model.get("children").map((id) => createView(model.widget_manager.model(id)));
    return make("div", { class: className }, ...(await Promise.all(views)));
  };
}

const power = {
  position: (model, value) => Math.log(value) / Math.log(model.get("base")),
  value: (model, exponent) => model.get("base") ** exponent,
};
const CONTROLS = {
  BoundedFloatTextModel: numberField,
  BoundedIntTextModel: numberField,
  BoxModel: box("w-hbox"),
  CheckboxModel: checkbox,
  DropdownModel: dropdown,
  FloatLogSliderModel: slider("value", power),
  FloatSliderModel: slider("value"),
  FloatTextModel: numberField,
  HBoxModel: box("w-hbox"),
  HTMLModel: text("innerHTML"),
  IntSliderModel: slider("value"),
  IntTextModel: numberField,
  LabelModel: text("textContent"),
  PlayModel: play,
  RadioButtonsModel: choice("w-radio"),
  SelectionSliderModel: slider("index", {
    text: (model) => model.get("_options_labels")[model.get("index")],
  }),
  ToggleButtonModel: toggleButton,
  ToggleButtonsModel: choice("w-buttons"),
  VBoxModel: box("w-vbox"),
};
