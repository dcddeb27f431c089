"""Run the examples of README.md and docs/*.md: `python -m docs.examples [--long] [--refill]`.

A fenced block that begins with `$ tsas` is run, each page in an empty folder of its own beside
`datasets`, and what the program says is held against what stands below the command. Comments of
HTML, which no reader sees, say what a block cannot:

    <!-- file NAME -->       the next block is this file
    <!-- file NAME …         so is what stands in the comment
    <!-- head NAME -->       the next block shows the first lines of this file
    <!-- run -->             the next block is Python to be run; or what stands in the comment
    <!-- long -->            the next block takes more than some seconds

A line `…` stands for lines that the page leaves out.
"""

import argparse
import contextlib
import difflib
import io
import re
import shlex
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from unittest import mock

ROOT = Path(__file__).parent.parent
PAGES = (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")))
PROMPT = "$ tsas"
LEFT_OUT = "…"
COMMENT = re.compile(r"<!--\s*(file|head|run|long)\b[ ]*([^\n]*?)\s*(?:\n(.*?))?-->", re.DOTALL)
OF_THE_MACHINE = re.compile(r"\b\d+(\.\d+)? (MB|kB)\b")


@dataclass(frozen=True)
class Block:
    """A fenced block, or a comment that stands for one: what is done with it, its lines."""

    kind: str  # file, head, run, calls, nothing
    name: str
    lines: tuple[str, ...]
    first: int  # of its lines, in the page
    long: bool = False


@dataclass(frozen=True)
class Call:
    """A command, what the page shows of its output, what it said, and where that stands."""

    page: Path
    line: int
    command: str
    shown: tuple[str, ...]
    said: tuple[str, ...]

    @property
    def true(self) -> tuple[str, ...]:
        """What should be shown: all that was said, less what the page leaves out."""
        if LEFT_OUT in self.shown:
            place = self.shown.index(LEFT_OUT)
            after = len(self.shown) - place - 1
            return (*self.said[:place], LEFT_OUT, *self.said[len(self.said) - after :])
        return self.said

    @property
    def holds(self) -> bool:
        """Whether the page shows what is true, but for what depends on the machine."""
        return [_normalised(line) for line in self.shown] == [
            _normalised(line) for line in self.true
        ]


def _normalised(line: str) -> str:
    return OF_THE_MACHINE.sub(r"# \2", line)


def blocks(text: str) -> Iterator[Block]:
    """Yield the blocks of a page in order."""
    lines = text.splitlines()
    said, i = ("nothing", ""), 0
    while i < len(lines):
        line = lines[i]
        if line.startswith("<!--"):
            end = next(j for j in range(i, len(lines)) if lines[j].rstrip().endswith("-->"))
            found = COMMENT.fullmatch("\n".join(lines[i : end + 1]))
            if found:
                said = (found[1], found[2])
                if found[3] is not None:
                    yield Block(*said, tuple(found[3].splitlines()), i + 1)
                    said = ("nothing", "")
            i = end
        elif line.startswith("```"):
            end = next(j for j in range(i + 1, len(lines)) if lines[j].startswith("```"))
            inside = tuple(lines[i + 1 : end])
            if inside and inside[0].startswith(PROMPT):
                yield Block("calls", "", inside, i + 1, long=said[0] == "long")
            else:
                yield Block(*said, inside, i + 1)
            said, i = ("nothing", ""), end
        elif line.strip():
            said = ("nothing", "")
        i += 1


def commands(block: Block) -> Iterator[tuple[int, str, tuple[str, ...]]]:
    """Yield the place, the command and the shown output of each call of a block."""
    starts = [i for i, line in enumerate(block.lines) if line.startswith("$ ")]
    for start, end in zip(starts, (*starts[1:], len(block.lines)), strict=True):
        command, after = block.lines[start][2:], start + 1
        while command.endswith("\\"):
            command, after = command[:-1] + block.lines[after].strip(), after + 1
        yield block.first + after, command, block.lines[after:end]


def run_page(page: Path, *, long: bool) -> list[Call]:
    """Run the examples of a page in an empty folder; those that take long only if asked for."""
    calls = []
    with tempfile.TemporaryDirectory() as name, contextlib.chdir(name):
        folder = Path(name)
        (folder / "datasets").symlink_to(ROOT / "datasets")
        for block in blocks(page.read_text(encoding="utf-8")):
            text = "\n".join(block.lines) + "\n"
            if block.kind == "file":
                (folder / block.name).parent.mkdir(parents=True, exist_ok=True)
                (folder / block.name).write_text(text, encoding="utf-8")
            elif block.kind == "head":
                with (folder / block.name).open(encoding="utf-8") as stream:
                    said = tuple(next(stream).rstrip("\n") for _ in block.lines)
                command = f"head {block.name}"
                calls.append(Call(page, block.first, command, block.lines, said))
            elif block.kind == "run":
                exec(compile(text, str(page), "exec"), {})  # noqa: S102  our own page
            elif block.kind == "calls" and (long or not block.long):
                calls += [
                    Call(page, line, command, shown, output_of(command))
                    for line, command, shown in commands(block)
                ]
    return calls


def output_of(command: str) -> tuple[str, ...]:
    """Run `tsas …` in this process and return the lines that it prints, on both streams."""
    from tsas_cli.__main__ import main

    said, code = io.StringIO(), None
    with (
        contextlib.redirect_stdout(said),
        contextlib.redirect_stderr(said),
        mock.patch.object(sys, "argv", shlex.split(command)),
    ):
        try:
            main()
        except SystemExit as end:
            code = end.code
    if code not in (None, 0, 2):
        raise RuntimeError(f"`{command}` ended with {code}: {said.getvalue()}")
    lines = [line.rstrip() for line in said.getvalue().rstrip().splitlines()]
    return tuple(lines)


def refilled(text: str, calls: list[Call]) -> str:
    """Return the page with the true output under every command that was run."""
    lines = text.splitlines()
    for call in sorted(calls, key=lambda call: call.line, reverse=True):
        if not call.holds:
            lines[call.line : call.line + len(call.shown)] = call.true
    return "\n".join(lines) + "\n"


def difference(call: Call) -> str:
    """Return what the page shows and what is true, line by line."""
    where = f"{call.page.relative_to(ROOT)}:{call.line}"
    lines = difflib.unified_diff(call.shown, call.true, where, f"$ {call.command}", lineterm="")
    return "\n".join(lines)


def main() -> int:
    """Run the examples of some or all pages; print what differs, or refill it."""
    parser = argparse.ArgumentParser(prog="python -m docs.examples")
    parser.add_argument("pages", nargs="*", type=Path, help="pages; all without it")
    parser.add_argument("--long", action="store_true", help="run the long ones too")
    parser.add_argument("--refill", action="store_true", help="write the true output")
    chosen = parser.parse_args()
    wrong = 0
    for page in [path.resolve() for path in chosen.pages] or PAGES:
        calls = run_page(page, long=chosen.long)
        bad = [call for call in calls if not call.holds]
        print(f"{page.relative_to(ROOT)}: {len(calls)} examples, {len(bad)} differ")
        for call in bad:
            print(difference(call))
        if chosen.refill and bad:
            page.write_text(refilled(page.read_text(encoding="utf-8"), calls), encoding="utf-8")
        wrong += len(bad)
    return 1 if wrong and not chosen.refill else 0


if __name__ == "__main__":
    sys.exit(main())
