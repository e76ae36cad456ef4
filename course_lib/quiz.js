/* A question that the browser judges. Wrong answers may be mended as often as one likes. */

/** Append text in which `backquotes` mark code. */
function write(parent, text) {
  text.split("`").forEach((part, i) => {
    if (i % 2 === 0) return parent.append(part);
    const code = document.createElement("code");
    code.textContent = part;
    parent.append(code);
  });
  return parent;
}

function element(tag, className, text = "") {
  const node = document.createElement(tag);
  if (className) node.className = className;
  return write(node, text);
}

function judgeChoice(key, given) {
  const right = Number(given) === key.answer;
  return { right, reason: key.reasons[Number(given)] };
}

/** Read a number as people type it: a comma for the point, spaces, the unit behind it. */
function parseNumber(text, unit) {
  let plain = text.trim().replace("−", "-");
  if (unit && plain.toLowerCase().endsWith(unit.toLowerCase()))
    plain = plain.slice(0, plain.length - unit.length);
  plain = plain.replace(/\s+/g, "").replace(",", ".");
  return plain === "" ? NaN : Number(plain);
}

function judgeNumber(key, given) {
  const value = parseNumber(given, key.unit);
  if (!Number.isFinite(value)) return { right: false, reason: "Please type a number." };
  // Decimal fractions are not exact in binary: 0.1 + 0.2 is still 0.3 to a student.
  const slack = key.tolerance + 1e-9 * Math.max(1, Math.abs(key.answer));
  const right = Math.abs(value - key.answer) <= slack;
  const expected = key.reasons.find(([at]) => (right ? at === key.answer : Math.abs(at - value) <= 1e-9 * Math.max(1, Math.abs(at))));
  if (expected) return { right, reason: expected[1] };
  if (right) return { right, reason: "" };
  return { right, reason: value < key.answer ? "Your number is too small." : "Your number is too large." };
}

function render({ model, el }) {
  const kind = model.get("kind");
  const key = model.get("key");
  const box = element("div", "fm-quiz");
  const verdict = element("p", "fm-verdict");
  verdict.setAttribute("aria-live", "polite");

  function show() {
    const given = model.get("given");
    verdict.replaceChildren();
    delete box.dataset.verdict;
    if (given === "") return;
    const { right, reason } = (kind === "choose" ? judgeChoice : judgeNumber)(key, given);
    box.dataset.verdict = right ? "right" : "wrong";
    verdict.append(element("strong", "", right ? "✓ Right." : "✗ Not yet."), " ");
    write(verdict, right ? reason : `${reason} Try again.`);
  }
  function answer(given) {
    model.set("given", given);
    model.save_changes();
    show();
  }

  if (kind === "choose") {
    const fields = element("fieldset");
    fields.append(element("legend", "", model.get("question")));
    const group = `fm-quiz-${crypto.getRandomValues(new Uint32Array(2)).join("-")}`;
    model.get("options").forEach((option, i) => {
      const label = element("label", "fm-option");
      const input = element("input");
      Object.assign(input, { type: "radio", name: group, value: String(i) });
      input.checked = model.get("given") === String(i);
      input.addEventListener("change", () => answer(String(i)));
      label.append(input, element("span", "", option));
      fields.append(label);
    });
    box.append(fields);
  } else {
    const form = element("form");
    const label = element("label", "fm-question", model.get("question"));
    const input = element("input");
    Object.assign(input, { type: "text", inputMode: "decimal", autocomplete: "off" });
    input.id = `fm-quiz-${crypto.getRandomValues(new Uint32Array(2)).join("-")}`;
    input.value = model.get("given");
    label.htmlFor = input.id;
    form.append(input);
    if (key.unit) form.append(element("span", "", key.unit));
    form.append(Object.assign(element("button", "", "Check"), { type: "submit" }));
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      answer(input.value);
    });
    box.append(label, form);
  }
  // JupyterLab's own shortcuts must not see what is typed into a question.
  box.addEventListener("keydown", (event) => event.stopPropagation());
  box.append(verdict);
  el.append(box);
  model.on("change:given", show);
  show();
  return () => model.off("change:given", show);
}

export default { render };
