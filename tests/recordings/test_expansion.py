"""What a file takes when it is unpacked, against its size and the memory."""

import pytest

from tsas_cli.recordings.guards import Expanded
from tsas_cli.support import limits
from tsas_cli.support.errors import InputError


def refusal(call, *args):
    """Return what the call is refused with."""
    with pytest.raises(InputError) as caught:
        call(*args)
    return str(caught.value)


def test_what_a_file_expands_to_counts_against_its_size(tmp_path):
    path = tmp_path / "a.mat"
    path.write_bytes(bytes(2_000_000))
    expanded = Expanded.of(path)
    expanded.add(limits.EXPANSION * 2_000_000)
    line = refusal(lambda: expanded.add(1, what="x of (9, 9)"))
    assert "x of (9, 9), 1 GB or more from a file of 2 MB; expected at most 500 times" in line
    small = Expanded(path, 10)
    small.add(limits.HARMLESS)
    assert "268 MB or more from a file of 10 bytes" in refusal(small.add, 1)


def test_items_are_counted(tmp_path):
    expanded = Expanded(tmp_path, 80_000)
    for _ in range(10_000):
        expanded.add(0)
    assert "holds more than 10000 variables" in refusal(expanded.add, 0)


def test_what_is_unpacked_has_to_fit_into_the_memory(tmp_path, monkeypatch):
    monkeypatch.setattr(limits, "available", lambda: 1_000_000_000)
    expanded = Expanded(tmp_path / "a.mat", 1)
    expanded.bytes = 1_000_000_000 // limits.COPIES
    expanded.fits()
    expanded.bytes += 1
    assert "needs 1 GB of memory" in refusal(expanded.fits)
