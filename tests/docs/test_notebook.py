"""The notebook shows what its cells give: every text, and a picture wherever one is drawn."""

import base64
import shutil

from docs import notebook
from docs.examples import ROOT


def text_of(outputs):
    """Return the texts of outputs, and how many pictures there are."""
    texts = ["".join(o.get("text", o.get("data", {}).get("text/plain", []))) for o in outputs]
    return [text for text in texts if text], sum("image/png" in o.get("data", {}) for o in outputs)


def test_what_stands_in_the_notebook_is_what_its_cells_show(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT))
    pictures = 0
    for cell, outputs in notebook.executed(notebook.read(), tmp_path):
        texts, drawn = text_of(outputs)
        assert (texts, drawn) == text_of(cell["outputs"]), "".join(cell["source"])
        pictures += drawn
    assert pictures >= 2
    shutil.rmtree(tmp_path / "bench-42")


def test_its_pictures_are_pictures():
    shown = [o for cell in notebook.read()["cells"] for o in cell.get("outputs", [])]
    encoded = [o["data"]["image/png"] for o in shown if "image/png" in o.get("data", {})]
    assert all(base64.b64decode(png).startswith(b"\x89PNG") for png in encoded)
