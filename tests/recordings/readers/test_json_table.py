import json

import numpy as np
import pytest

from tests.refusals import refusal
from tsas_cli.recordings.readers import read
from tsas_cli.recordings.readers.table import ReadOptions

ROWS = [[0, 1.5], [1, None], [2, 3.5]]


@pytest.fixture
def ask(tmp_path):
    def call(content, *wanted, **options):
        path = tmp_path / "a.json"
        path.write_text(content if isinstance(content, str) else json.dumps(content))
        return read(path, ReadOptions(**options), wanted)

    return call


def test_what_stands_beside_the_table_is_the_header(ask):
    table = ask({"data": ROWS, "unit": "kip"}, 2, table="data")
    np.testing.assert_array_equal(table.columns[2], [1.5, np.nan, 3.5])
    assert table.header == ("unit = kip",)


@pytest.mark.parametrize(
    ("content", "options", "message"),
    [
        ("", {}, "is empty"),
        ("{", {}, "is not JSON"),
        ({"data": ROWS, "dt": 1}, {}, "its keys are: data, dt"),
        ({"data": ROWS}, {"table": "date"}, "did you mean data"),
        ([[0, 1], [1, "fast"]], {}, "row 2: column 2 holds 'fast'"),
        ([[0, 1], [1]], {}, "row 2: 1 value; expected 2"),
        ([], {}, "holds no table"),
        ([[0, 1], [1, "1_2"]], {}, "row 2: column 2 holds '1_2'"),
    ],
)
def test_what_is_wrong_is_reported(ask, content, options, message):
    assert message in refusal(ask, content, 1, 2, **options)
