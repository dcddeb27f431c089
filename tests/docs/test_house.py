"""The picture of the house is that of the import contract."""

from docs.house import OUT, ROOT, floors, svg


def test_the_picture_is_drawn_from_the_contract_as_it_is():
    assert OUT.read_text(encoding="utf-8") == svg(), "run `.venv/bin/python -m docs.house`"


def test_every_package_has_a_floor():
    packages = {f"tsas_cli.{p.parent.name}" for p in ROOT.glob("tsas_cli/*/__init__.py")}
    assert packages <= {room for floor in floors() for room in floor}
