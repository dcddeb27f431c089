"""Execute docs/tutorial.ipynb and write what its cells show: `python -m docs.notebook`.

Each cell runs as in Jupyter: what it prints, its last expression, and the figures that it draws are
its outputs. Only the standard library and matplotlib are needed.
"""

import ast
import base64
import contextlib
import io
import json
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

NOTEBOOK = Path(__file__).parent / "tutorial.ipynb"
Outputs = list[dict[str, Any]]


def read() -> dict[str, Any]:
    """Return the notebook."""
    content: dict[str, Any] = json.loads(NOTEBOOK.read_text(encoding="utf-8"))
    return content


def executed(notebook: dict[str, Any], folder: Path) -> Iterator[tuple[dict[str, Any], Outputs]]:
    """Execute the cells in a folder; yield each cell of code with what it shows."""
    import matplotlib as mpl

    mpl.use("agg")
    names: dict[str, Any] = {"__name__": "__main__"}
    with contextlib.chdir(folder):
        for cell in notebook["cells"]:
            if cell["cell_type"] == "code":
                yield cell, _run("".join(cell["source"]), names)


def _run(source: str, names: dict[str, Any]) -> Outputs:
    from matplotlib import pyplot as plt

    tree = ast.parse(source)
    last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    printed, outputs = io.StringIO(), []
    with contextlib.redirect_stdout(printed):
        exec(compile(tree, "cell", "exec"), names)  # noqa: S102 # our own notebook
        value = None
        if isinstance(last, ast.Expr):
            value = eval(compile(ast.Expression(last.value), "cell", "eval"), names)  # noqa: S307
    if text := printed.getvalue():
        outputs.append({"output_type": "stream", "name": "stdout", "text": _lines(text)})
    if value is not None and not source.rstrip().endswith(";"):  # as in Jupyter
        outputs.append(_shown(value))
    for number in plt.get_fignums():
        stream = io.BytesIO()
        plt.figure(number).savefig(stream, format="png", dpi=80, metadata={"Software": None})
        plt.close(number)
        data = {"image/png": base64.b64encode(stream.getvalue()).decode()}
        outputs.append({"output_type": "display_data", "metadata": {}, "data": data})
    return outputs


def _shown(value: object) -> dict[str, Any]:
    data = {"text/plain": _lines(repr(value))}
    as_html = getattr(value, "_repr_html_", None)
    if as_html is not None:
        data["text/html"] = _lines(as_html())
    return {"output_type": "execute_result", "execution_count": None, "metadata": {}, "data": data}


def _lines(text: str) -> list[str]:
    return text.splitlines(keepends=True)


def main() -> None:
    """Execute the notebook and write its outputs."""
    notebook = read()
    with tempfile.TemporaryDirectory() as folder:
        for cell, outputs in executed(notebook, Path(folder)):
            cell["outputs"] = outputs
    text = json.dumps(notebook, indent=1, ensure_ascii=False) + "\n"
    NOTEBOOK.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
