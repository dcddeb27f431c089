"""All groups together."""

import importlib
import pkgutil
import re

import tsas_studies.reproduction
from tsas_cli.paper import yang2025
from tsas_studies.reproduction import GROUPS
from tsas_studies.reproduction.group import VERDICTS, Group
from tsas_studies.reproduction.summary import counted, sentence, summary_of, verdict_table
from tsas_studies.reproduction.verdicts import undetermined, within

PAPER = yang2025()
KM = PAPER["stiffness.theory.km_dead_band"]
MADE = [
    Group(
        "x",
        "X",
        rows=(within("one", KM, 175.0, percent=1.0), undetermined("p", "Fig.", because="b")),
    ),
    Group("y", "Y", rows=(within("two", KM, 100.0, percent=1.0),)),
]


def test_every_function_from_paper_to_group_is_in_the_list():
    found = set()
    for module in pkgutil.iter_modules(tsas_studies.reproduction.__path__):
        content = vars(importlib.import_module(f"tsas_studies.reproduction.{module.name}"))
        for name, value in content.items():
            returned = getattr(value, "__annotations__", {}).get("return")
            if not name.startswith("_") and returned is Group and callable(value):
                found.add(value)
    assert found == set(GROUPS)


def test_verdicts_are_counted():
    assert counted(MADE) == {"agrees": 1, "differs": 1, "cannot tell": 1}
    assert re.findall(r"\d+", sentence(MADE)) == ["3", "1", "1", "1"]
    header, rows = verdict_table(MADE)
    assert header == ("part", *VERDICTS)
    assert rows == [("X", "1", "0", "1"), ("Y", "0", "1", "0"), ("all", "1", "1", "1")]


def test_what_is_written_holds_every_row():
    summary = summary_of(PAPER, MADE)
    assert summary["counts"] == counted(MADE)
    assert [row["what"] for group in summary["groups"] for row in group["rows"]] == [
        "one",
        "p",
        "two",
    ]
    assert summary["groups"][0]["rows"][0]["ratio"] == 175.0 / 175.1
    assert summary["groups"][1]["rows"][0]["because"]
