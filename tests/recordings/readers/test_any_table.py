"""Known numbers come back bit by bit, whatever the format and its layout."""

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.recordings.readers.any_table import check, foreign_tables, plain_tables

ONE_FOLDER = HealthCheck.function_scoped_fixture  # each example writes its file anew


@settings(suppress_health_check=[ONE_FOLDER])
@given(known=plain_tables())
def test_text_json_and_parquet(tmp_path, known):
    check(known, tmp_path)


@settings(suppress_health_check=[ONE_FOLDER])
@given(data=st.data())
def test_matlab_and_mdf(tmp_path, data):
    check(data.draw(foreign_tables(tmp_path)), tmp_path)
