"""What a stage returns: the content of its JSON file, and its tables and sentences."""

from abc import ABC, abstractmethod
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

from tsas_cli.support import __version__
from tsas_cli.support.errors import printable
from tsas_cli.support.text_table import table_text

Table = tuple[str, Sequence[str], Sequence[Sequence[str]]]


@dataclass(frozen=True, repr=False, eq=False)
class Result(ABC):
    """What a stage found; its text, and its look in a notebook, is what the command prints.

    Parameters
    ----------
    summary
        What the stage's JSON file holds, and `--json` prints (docs/formats.md).
    out
        Where the stage has written it, or None where nothing was written.
    """

    summary: dict[str, Any]
    out: Path | None

    @abstractmethod
    def tables(self) -> Iterable[Table]:
        """Return the tables that are printed: title, header and rows of each."""

    def sentences(self) -> Iterable[str]:
        """Return the lines that are printed after the tables."""
        return ()

    def intro(self) -> Iterable[str]:
        """Return the lines that are printed before the tables."""
        return ()

    def titled(self, title: str, file: str = "") -> str:
        """Return a title with the file that holds what stands below it, where one was written."""
        return title if self.out is None else f"{title} → {self.out / file}"

    def __repr__(self) -> str:
        """Return what the command prints."""
        lines = [line for table in self.tables() for line in (*table_text(*table), "")]
        return "\n".join([*self.intro(), *lines, *self.sentences()]).rstrip("\n")

    def _repr_html_(self) -> str:
        """Return the same for a notebook."""
        intro = [f"<pre>{escape(line)}</pre>" for line in self.intro()]
        sentences = [f"<p>{escape(printable(sentence))}</p>" for sentence in self.sentences()]
        return "\n".join([*intro, *(_html(*table) for table in self.tables()), *sentences])


def heading(stage: str) -> dict[str, Any]:
    """Return what the JSON of a stage without a record begins with."""
    return {"format": 1, "stage": stage, "version": __version__}


def notes(sentences: Sequence[str]) -> list[str]:
    """Return sentences as the list below a stage's tables."""
    return [f"- {sentence}" for sentence in sentences]


def _html(title: str, header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    def cells(tag: str, texts: Sequence[str]) -> str:
        style = ' style="text-align: left"'
        return "".join(f"<{tag}{style}>{escape(printable(str(text)))}</{tag}>" for text in texts)

    head = f"<thead><tr>{cells('th', header)}</tr></thead>" if rows else ""
    body = "".join(f"<tr>{cells('td', row)}</tr>" for row in rows)
    style = "text-align: left; white-space: nowrap; font-weight: bold"
    caption = f'<caption style="{style}">{escape(printable(title))}</caption>'
    return f'<table style="margin-bottom: 1em">{caption}{head}<tbody>{body}</tbody></table>'
