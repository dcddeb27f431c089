import re
from pathlib import Path

import pytest

from tsas_cli.recordings.ingest_map import ColumnMap, read_map
from tsas_cli.recordings.readers.table import ReadOptions
from tsas_cli.support.errors import InputError

REPOSITORY = Path(__file__).parents[2]
PAGE = (REPOSITORY / "docs" / "ingest.md").read_text(encoding="utf-8")

WHOLE = """
[dataset]
name = "m"
[columns.time_s]
source = 1
[columns.x_in_mm]
source = "x"
[columns.f_in_N]
source = "f"
"""


@pytest.fixture
def ask(tmp_path):
    def call(text):
        path = tmp_path / "map.toml"
        path.write_text(text)
        return read_map(path)

    return call


def test_the_smallest_map_and_the_columns_it_takes(ask):
    mapping = ask(WHOLE + '[columns.f_out_N]\nsource = "f"\n[read]\nextra = ["note", "x"]\n')
    assert mapping.sources() == [1, "x", "f", "note"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (WHOLE.replace("f_in_N", "f_in_n"), "unknown column f_in_n (did you mean f_in_N?)"),
        (WHOLE + "ofset = 1\n", "columns.f_in_N.ofset (did you mean offset?)"),
        (WHOLE + "[reed]\n", "unknown key reed (did you mean read?)"),
        (WHOLE + "[read]\ndecimals = ','\n", "read.decimals (did you mean decimal?)"),
        (WHOLE + "[rig]\ntendon_diameter = 1\n", "did you mean tendon_diameter_mm?"),
        (WHOLE + "[run]\npreload = 1\n", "did you mean preload_N?"),
        (WHOLE + "[run]\nload = 'sprung'\n", "run.load"),
        (WHOLE + "[run.from_header]\npattern = '('\n", "run.from_header.pattern"),
        (WHOLE + "sign = 2\n", "columns.f_in_N.sign"),
        (WHOLE + "factor = 2\n", "factor and factor_unit belong together"),
        (WHOLE + "rate_Hz = 2\n", "columns.f_in_N: needs a source"),
        (WHOLE.replace('source = "f"', "rate_Hz = 2"), "f_in_N cannot have rate_Hz"),
        (WHOLE.replace("[columns.time_s]", "[columns.x_out_mm]"), "time_s is missing"),
        (WHOLE.replace("x_in_mm", "temperature_C"), "an input and an output column"),
        (WHOLE.replace('name = "m"', ""), "dataset.name is missing"),
        (WHOLE + "offset = true\n", "columns.f_in_N.offset: true and false are no numbers"),
        (WHOLE + "sign = true\n", "columns.f_in_N.sign: true and false are no numbers"),
        (WHOLE.replace("source = 1", "rate_Hz = true"), "columns.time_s.rate_Hz: true and false"),
        (WHOLE.replace("source = 1", "source = true"), "columns.time_s.source: true and false"),
        (WHOLE + "[read]\nextra = ['a', true]\n", "read.extra.1: true and false are no numbers"),
        ("[dataset", "is not TOML"),
    ],
)
def test_what_is_wrong_is_reported_with_the_nearest_known_word(ask, text, message):
    with pytest.raises(InputError) as error:
        ask(text)
    assert message in error.value.line()
    assert "map.toml" in error.value.line()


def test_a_missing_map_is_reported(tmp_path):
    with pytest.raises(InputError, match="cannot be read"):
        read_map(tmp_path / "none.toml")


@pytest.mark.parametrize("path", sorted((REPOSITORY / "datasets" / "maps").glob("*.toml")))
def test_the_shipped_maps_are_maps(path):
    assert read_map(path).dataset.name == path.stem


def test_the_page_shows_a_map_that_works_and_names_every_key(ask):
    *_, example = re.findall(r"```toml\n(.*?)```", PAGE, flags=re.DOTALL)
    assert ask(example).columns["x_in_mm"].sign == -1
    for key in [*ReadOptions.model_fields, *ColumnMap.model_fields]:
        assert f"`{key}`" in PAGE
