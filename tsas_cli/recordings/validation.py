"""Content of a file against its schema: what is wrong in one line, with its places."""

from collections.abc import Iterable, Iterator
from datetime import date, time
from functools import partial
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from tsas_cli.support.errors import InputError, nearest
from tsas_cli.support.files import Raw

T = TypeVar("T", bound=BaseModel)
_MOST_ERRORS = 5  # listed of one file; further ones are counted
_VALUE_LENGTH = 80  # characters of an invalid value in a message
_EXPECTED = "input should be "
_COUNTS = {"too_long": ("at most", "max_length"), "too_short": ("at least", "min_length")}
_KINDS = {  # of Pydantic's errors
    "float_type": "a number",
    "float_parsing": "a number",
    "int_type": "a whole number",
    "int_parsing": "a whole number",
    "int_from_float": "a whole number",
    "string_type": "text",
    "tuple_type": "a list",
    "list_type": "a list",
    "bool_type": "true or false",
    "dict_type": "a table",
    "model_type": "a table",
}


def parse(model: type[T], content: Raw, path: object) -> T:
    """Return the validated content of a file; all its errors become one line.

    InputError: a key is missing, unknown or invalid, or a number is written as text.
    """
    try:
        read = model.model_validate(content, context={"file": path})
    except ValidationError as error:
        raise InputError(_sentences(error, content, model), where=path) from error
    for place, what in _misread(content, read):
        raise InputError(f"{place}: {what}", where=path)
    return read


def _misread(written: Any, read: Any, place: str = "") -> Iterator[tuple[str, str]]:
    """Yield the places where text was read as a number or as true, or true as a number, and why.

    Pydantic's strict mode would also refuse 1 for 1.0, and lists for tuples.
    """
    inside: Iterable[tuple[Any, Any, Any]] = ()
    if isinstance(written, dict):
        get = read.get if isinstance(read, dict) else partial(getattr, read)
        inside = ((key, value, get(key, None)) for key, value in written.items())
    elif isinstance(written, list) and isinstance(read, list | tuple):
        inside = ((k, *both) for k, both in enumerate(zip(written, read, strict=False)))
    elif isinstance(read, bool):
        if not isinstance(written, bool):
            yield place, f"{_EXPECTED}true or false, got {_shown(written)}"
    elif isinstance(read, int | float):
        if isinstance(written, bool):
            yield place, "true and false are no numbers"
        elif isinstance(written, str):
            yield place, f"text is no number, got {_shown(written)}; write it without quotes"
    for key, value, inner in inside:
        if inner is not None and inner is not value:
            at = f"{place}.{_named(written, key)}" if place else str(key)
            yield from _misread(value, inner, at)


def _sentences(error: ValidationError, content: Raw, model: type[BaseModel]) -> str:
    """Return the errors of a file's content as one line.

    Those of one place are one of them, and so are those that are alike in each table of a list.
    """
    # A list is also reported as too short only because its items are invalid.
    found: dict[str, list[Any]] = {}
    for each in error.errors(include_url=False):
        if not (each["type"] == "too_short" and any(each["input"])):
            found.setdefault(_place(each, content), []).append(each)
    alike: dict[tuple[str, ...], list[str]] = {}
    for place, errors in found.items():
        first = errors[0]
        keys = (k for k in first["loc"] if isinstance(k, str))
        key = (first["type"], repr(first["input"]), *keys)
        alike.setdefault(key, []).append(_sentence(place, errors, model))
    listed = [
        first + (f" (and {len(others)} more alike)" if others else "")
        for first, *others in list(alike.values())[:_MOST_ERRORS]
    ]
    more = [f"and {len(alike) - _MOST_ERRORS} more"] if len(alike) > _MOST_ERRORS else []
    return "; ".join(listed + more)


def _sentence(place: str, errors: list[Any], model: type[BaseModel]) -> str:
    """Return what is wrong at one place; of several errors, each says what could be there."""
    error = errors[0]
    if error["type"] == "extra_forbidden":
        return (
            f"unknown key {place} ({nearest(str(error['loc'][-1]), _known(model, error['loc']))})"
        )
    if error["type"] == "missing":
        return f"{place} is missing"
    first, *others = (_message(each) for each in errors)
    message = " or ".join([first, *(other.removeprefix(_EXPECTED) for other in others)])
    got = "" if isinstance(error["input"], dict | list) else f", got {_shown(error['input'])}"
    return f"{place}: {message}{got}" if place else message


def _message(error: Any) -> str:
    if error["type"] in _KINDS:
        return f"{_EXPECTED}{_KINDS[error['type']]}"
    if error["type"] in _COUNTS:
        bound, limit = _COUNTS[error["type"]]
        return f"{bound} {error['ctx'][limit]} items are expected, got {len(error['input'])}"
    message: str = error["msg"].removeprefix("Value error, ")
    return message[0].lower() + message[1:]


def _shown(value: object) -> str:
    shown = str(value) if isinstance(value, date | time) else repr(value)
    return shown if len(shown) <= _VALUE_LENGTH else f"{shown[:_VALUE_LENGTH]}…"


def _place(error: Any, content: Any) -> str:
    """Return the place of an error, without the kinds that Pydantic has tried there.

    Of a list's tables it names their ids, unless one is wrong.
    """
    names, location = list[str](), error["loc"]
    of_id = location[-1:] == ("id",)
    for part in location:
        name = str(part) if of_id else _named(content, part)
        try:
            content = content[part]
        except (LookupError, TypeError):
            if error["type"] != "missing" or part != location[-1]:
                continue
        names.append(name)
    return ".".join(names)


def _named(inside: Any, key: Any) -> str:
    """Return a key, or for that of a table in a list the table's id."""
    try:
        own = inside[key]["id"] if isinstance(key, int) else None
    except (KeyError, IndexError, TypeError):
        own = None
    return own if isinstance(own, str) and own else str(key)


def _known(model: Any, location: tuple[Any, ...]) -> list[str]:
    """Return the keys that the model defines at the place of an error, as they are written."""
    for part in location[:-1]:
        field = _fields(model).get(part)
        if field is None:
            continue
        inner = [a for a in getattr(field.annotation, "__args__", ()) if hasattr(a, "model_fields")]
        model = inner[0] if inner else field.annotation
    return list(_fields(model))


def _fields(model: Any) -> dict[str, Any]:
    return {f.alias or name: f for name, f in getattr(model, "model_fields", {}).items()}
