"""Widget state for a page without a kernel: what `static/models.js` reads.

Why our own manager rather than the official one: the official bundle (html-manager) is 3.9 MB of
JavaScript that reaches Python installations only inside packages that also install a web server.
The few controls of this course are a browser's own: a labelled range input answers keyboard and
screen reader by itself.
"""

import json
from typing import Any

STATE = "application/vnd.jupyter.widget-state+json"
# Each is a function in static/controls.js; a browser test compares the two lists.
CONTROLS = frozenset(
    {
        "BoundedFloatTextModel",
        "BoundedIntTextModel",
        "BoxModel",
        "CheckboxModel",
        "DropdownModel",
        "FloatLogSliderModel",
        "FloatSliderModel",
        "FloatTextModel",
        "HBoxModel",
        "HTMLModel",
        "IntSliderModel",
        "IntTextModel",
        "LabelModel",
        "PlayModel",
        "RadioButtonsModel",
        "SelectionSliderModel",
        "ToggleButtonModel",
        "ToggleButtonsModel",
        "VBoxModel",
    }
)
_LINKS = {"LinkModel", "DirectionalLinkModel"}


def _slim(record: dict[str, Any]) -> dict[str, Any]:
    state = record["state"]
    if record["model_name"] == "LayoutModel":
        # Traits are CSS properties with underscores; nearly all of them are unset.
        css = {
            name.replace("_", "-"): value
            for name, value in state.items()
            if value is not None and not name.startswith("_")
        }
        state = {"css": css}
    slim = {"model_name": record["model_name"], "model_module": record["model_module"]}
    return slim | {"state": state, "buffers": record.get("buffers", [])}


def page_state(notebook: Any) -> str:  # noqa: ANN401
    """Return a notebook's widget state as JSON to stand in a script element.

    Parameters
    ----------
    notebook : nbformat.NotebookNode
        Executed with its widget state kept.

    Returns
    -------
    str
        JSON in which no character can end the element; "" when there is no widget.

    Raises
    ------
    ValueError
        A widget is of a kind that an exported page cannot show.
    """
    records = notebook.get("metadata", {}).get("widgets", {}).get(STATE, {}).get("state", {})
    kept = {}
    for identifier, record in records.items():
        name = record["model_name"]
        if name.endswith("StyleModel"):
            continue
        is_known = name in CONTROLS | _LINKS | {"LayoutModel"}
        if not is_known and record["model_module"] != "anywidget":
            kind = name.removesuffix("Model")
            known = ", ".join(sorted(c.removesuffix("Model") for c in CONTROLS))
            raise ValueError(
                f"an exported page cannot show the widget {kind}; it can show anywidgets, {known}"
            )
        kept[identifier] = _slim(record)
    if not kept:
        return ""
    return json.dumps(kept, separators=(",", ":"), ensure_ascii=False).replace("<", "\\u003c")
