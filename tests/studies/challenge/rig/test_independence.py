from pathlib import Path

from tsas_studies.challenge import rig


def test_the_rig_shares_no_code_with_the_product():
    sources = list(Path(rig.__file__).parent.rglob("*.py"))
    assert len(sources) >= 8
    for source in sources:
        text = source.read_text(encoding="utf-8").replace("tsas_studies.challenge.rig", "")
        assert "tsas_cli" not in text, source.name
