"""How a call is refused: in one line that a terminal can show."""

import pytest

from tsas_cli.support.errors import InputError


def refusal(call, *given, **said) -> str:
    """Return the line with which a call is refused."""
    with pytest.raises(InputError) as caught:
        call(*given, **said)
    line = caught.value.line()
    assert line.isprintable()
    return line
