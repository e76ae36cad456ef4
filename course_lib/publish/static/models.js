/* Widgets without a kernel, part 1: their models, from the state that the page carries. */
"use strict";

const REFERENCE = "IPY_MODEL_";

function sameValue(a, b) {
  if (Object.is(a, b)) return true;
  if (typeof a !== "object" || typeof b !== "object" || a === null || b === null) return false;
  // Binary data is compared by identity: it may be large, and nobody edits it in place.
  if (ArrayBuffer.isView(a) || ArrayBuffer.isView(b)) return false;
  return JSON.stringify(a) === JSON.stringify(b);
}

/** The part of a Backbone model that widgets use; `on` and `off` take several names, as there. */
class Model {
  #state;
  #listeners = [];

  constructor(id, record, manager) {
    this.model_id = id;
    this.name = record.model_name;
    this.module = record.model_module;
    this.widget_manager = manager;
    this.#state = structuredClone(record.state);
    for (const { path, data } of record.buffers ?? []) {
      const bytes = Uint8Array.from(atob(data), (character) => character.charCodeAt(0));
      let holder = this.#state;
      for (const key of path.slice(0, -1)) holder = holder[key];
      holder[path.at(-1)] = new DataView(bytes.buffer); // what ipywidgets hands out, too
    }
  }

  get(name) {
    return this.#state[name];
  }

  set(nameOrValues, value) {
    const values = typeof nameOrValues === "object" ? nameOrValues : { [nameOrValues]: value };
    const changed = Object.keys(values).filter((k) => !sameValue(this.#state[k], values[k]));
    Object.assign(this.#state, values);
    for (const name of changed) this.trigger(`change:${name}`, this, this.#state[name], {});
    if (changed.length) this.trigger("change", this, {});
    return this;
  }

  on(names, callback, context) {
    for (const name of names.split(/\s+/)) this.#listeners.push({ name, callback, context });
    return this;
  }

  off(names, callback, context) {
    const wanted = names?.split(/\s+/);
    this.#listeners = this.#listeners.filter(
      (listener) =>
        (wanted && !wanted.includes(listener.name)) ||
        (callback && callback !== listener.callback) ||
        (context && context !== listener.context),
    );
    return this;
  }

  trigger(name, ...values) {
    for (const listener of [...this.#listeners])
      if (listener.name === name) listener.callback.apply(listener.context ?? this, values);
  }

  /* There is no kernel to tell. */
  save_changes() {}
  send() {}
}

/** All models of a page; links between them are alive from the start. */
class Manager {
  #models = new Map();

  constructor(records) {
    for (const [id, record] of Object.entries(records))
      this.#models.set(id, new Model(id, record, this));
    for (const model of this.#models.values()) {
      if (!["LinkModel", "DirectionalLinkModel"].includes(model.name)) continue;
      const [source, from] = this.#end(model.get("source"));
      const [target, to] = this.#end(model.get("target"));
      const forwards = () => target.set(to, source.get(from));
      source.on(`change:${from}`, forwards);
      if (model.name === "LinkModel")
        target.on(`change:${to}`, () => source.set(from, target.get(to)));
      forwards();
    }
  }

  #end([reference, name]) {
    return [this.model(reference), name];
  }

  /** The model with this id, which may be written as a reference ("IPY_MODEL_…"). */
  model(id) {
    const model = this.#models.get(id.startsWith(REFERENCE) ? id.slice(REFERENCE.length) : id);
    if (!model) throw new Error(`the page carries no widget ${id}`);
    return model;
  }

  async get_model(id) {
    return this.model(id);
  }
}
