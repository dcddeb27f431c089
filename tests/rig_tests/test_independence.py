import ast
from pathlib import Path

RIG = Path(__file__).parents[1] / "rig"


def test_the_rig_shares_no_code_with_the_product():
    for source in RIG.glob("*.py"):
        for node in ast.walk(ast.parse(source.read_text(encoding="utf-8"))):
            names = [alias.name for alias in getattr(node, "names", ()) if hasattr(alias, "name")]
            names.append(getattr(node, "module", None) or "")
            assert not any("tsas_cli" in name for name in names), source.name
