import pytest

from tsas_cli.records.check import CheckFile
from tsas_cli.reporting.inputs import read_stage
from tsas_cli.support.errors import InputError


def test_a_file_that_is_nested_deeply_is_one_line(tmp_path):
    (tmp_path / CheckFile.FILE).write_text('{"a": ' + "[" * 800 + "]" * 800 + "}")
    with pytest.raises(InputError, match=r"check\.json: is nested too deep"):
        read_stage(CheckFile, tmp_path)
