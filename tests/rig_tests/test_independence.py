from pathlib import Path

RIG = Path(__file__).parents[1] / "rig"


def test_the_rig_shares_no_code_with_the_product():
    sources = list(RIG.glob("*.py"))
    assert len(sources) >= 7
    for source in sources:
        assert "tsas_cli" not in source.read_text(encoding="utf-8"), source.name
