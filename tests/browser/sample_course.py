"""A small course for tests: one of everything that an exported page has to carry."""

from pathlib import Path

import cv2
import nbformat
import numpy as np
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook

CANVAS = '''
import anywidget, traitlets
class Disc(anywidget.AnyWidget):
    _esm = """
    function render({ model, el }) {
      const canvas = document.createElement("canvas");
      Object.assign(canvas, { width: 200, height: 100 });
      canvas.setAttribute("role", "img");
      canvas.setAttribute("aria-label", "a disc");
      const [r, g, b] = new Uint8Array(model.get("colour").buffer);
      function draw() {
        const context = canvas.getContext("2d");
        context.clearRect(0, 0, 200, 100);
        context.fillStyle = `rgb(${r} ${g} ${b})`;
        context.arc(100, 50, model.get("radius"), 0, 7);
        context.beginPath();
        context.arc(100, 50, model.get("radius"), 0, 7);
        context.fill();
        el.dataset.radius = model.get("radius");
      }
      model.on("change:radius", draw);
      draw();
      el.append(canvas);
    }
    export default { render };
    """
    _css = "canvas { border: 1px solid gray }"
    radius = traitlets.Float(10).tag(sync=True)
    colour = traitlets.Bytes().tag(sync=True)
'''

VIEWER = """
import base64, cv2, numpy as np, ipywidgets as w
png = cv2.imencode(".png", np.full((100, 200, 3), 200, np.uint8))[1].tobytes()
class Viewer(w.VBox):
    def _repr_mimebundle_(self, **options):
        data = super()._repr_mimebundle_(**options)
        still = {"image/png": base64.b64encode(png).decode(), "text/plain": "A red disc."}
        return {**data, **still}, {"image/png": {"alt": "A red disc."}}
def viewer(control, trait="value"):
    disc = Disc(colour=bytes([200, 0, 0]))
    w.jslink((control, trait), (disc, "radius"))
    return Viewer([control, disc])
"""

LESSON = r"""# Lesson with a formula

Text with $I_p > I_c + t$ and a [link](index.ipynb#Second-part), `code`, and **bold**.

## First part

$$
\theta = \operatorname{atan2}(m_{01}, m_{10}), \qquad m_{pq} = \sum_{x,y} x^p y^q I(x, y)
$$

$$
\tau(p; x, y) = \begin{cases} 1 & \text{if } p(x) < p(y) \\ 0 & \text{otherwise} \end{cases}
\qquad S_\theta = R_\theta \begin{bmatrix} x_1 & \dots & x_n \\ y_1 & \dots & y_n \end{bmatrix}
$$

> **Corrected.** The original converts with `RGB2GRAY`; OpenCV's pictures are BGR.

| detector | matches |
|---|---:|
| ORB | 250 |

```python
corners = cv2.perspectiveTransform(outline, H)
```

![A grey square](square.png)
"""


def _write(path, *cells):
    for number, cell in enumerate(cells):
        cell["id"] = f"{path.stem}-{number}"
    metadata = {"kernelspec": {"name": "python3", "display_name": "P", "language": "python"}}
    nbformat.write(new_notebook(cells=list(cells), metadata=metadata), path)


def write_sample_course(folder: Path) -> list[Path]:
    """Write two notebooks and a picture; return the notebooks in reading order."""
    folder.mkdir(parents=True, exist_ok=True)
    cv2.imwrite(str(folder / "square.png"), np.full((40, 40, 3), 128, np.uint8))
    _write(
        folder / "index.ipynb",
        new_markdown_cell("# Small course\n\nStart with [the lesson](lesson.ipynb)."),
        new_markdown_cell("## Second part\n\nNothing more."),
    )
    _write(
        folder / "lesson.ipynb",
        new_markdown_cell(LESSON),
        new_code_cell(CANVAS.strip()),
        new_code_cell(VIEWER.strip()),
        new_code_cell('viewer(w.IntSlider(10, 1, 50, description="Radius"))'),
        new_code_cell('viewer(w.Dropdown(options=["a", "b"], description="Size"), "index")'),
        new_code_cell(
            'mode = w.ToggleButtons(options=["small", "large"], description="Kind")\n'
            "viewer(mode, 'index')"
        ),
        new_code_cell("viewer(w.Play(value=3, min=3, max=6, interval=30))"),
        new_code_cell('viewer(w.FloatLogSlider(value=10, min=0, max=1.6, description="Log"))'),
        new_code_cell('viewer(w.BoundedIntText(value=9, min=1, max=50, description="Typed"))'),
        new_code_cell('viewer(w.Checkbox(value=True, description="Shown"))'),
        new_code_cell('print("text <b>& more</b>")'),
    )
    return [folder / "index.ipynb", folder / "lesson.ipynb"]
