"""Every mutant of a source file, by the operators of cosmic-ray, and a sample of them."""

import ast
import random
from dataclasses import dataclass
from functools import cache
from pathlib import Path

BINARY = ("Add_Sub", "Sub_Add", "Mul_Div", "Div_Mul", "Pow_Mul", "FloorDiv_Mul", "Mod_Mul")
MASKS = ("BitAnd_BitOr", "BitOr_BitAnd")
COMPARED = (
    *("Gt_GtE", "Gt_Lt", "GtE_Gt", "GtE_LtE", "Lt_LtE", "Lt_Gt", "LtE_Lt", "LtE_GtE"),
    *("Eq_NotEq", "NotEq_Eq", "Is_IsNot", "IsNot_Is"),
)
# What a person might have written by mistake. Left out is what dies of a TypeError whatever the
# tests are (shifts of floats, a number for a type), decorators (not compiled is the same law), and
# arguments that only guard or speed up: those of `dataclass`, and `GUARDS`.
GUARDS = ("strict", "hermitian")
OPERATORS = (
    *(f"core/ReplaceBinaryOperator_{name}" for name in BINARY + MASKS),
    *(f"core/ReplaceComparisonOperator_{name}" for name in COMPARED),
    "core/ReplaceUnaryOperator_USub_UAdd",
    "core/ReplaceUnaryOperator_Delete_Not",
    "core/ReplaceUnaryOperator_Delete_Invert",
    "core/AddNot",
    "core/NumberReplacer",
    "core/ReplaceTrueWithFalse",
    "core/ReplaceFalseWithTrue",
    "core/ReplaceAndWithOr",
    "core/ReplaceOrWithAnd",
    "core/ReplaceBreakWithContinue",
    "core/ReplaceContinueWithBreak",
    "core/ZeroIterationForLoop",
    "core/ExceptionReplacer",
)

Place = tuple[int, int]  # line and column


@dataclass(frozen=True)
class Mutant:
    """One change of one file: the operator, and at which of its places it acts."""

    path: str
    operator: str
    occurrence: int
    line: int
    lines: tuple[int, ...]  # of its statement, but for those of the block below it

    @property
    def name(self) -> str:
        """Return what tells it apart in one version of the sources."""
        return f"{self.path}:{self.line} {self.operator.removeprefix('core/')} {self.occurrence}"

    def source(self, root: Path) -> str:
        """Return the text of the mutated file."""
        from cosmic_ray.mutating import mutate_code  # a second that only mutants are worth
        from cosmic_ray.plugins import get_operator

        operator = get_operator(self.operator)()
        text = mutate_code((root / self.path).read_text(), operator, self.occurrence)
        if text is None:
            raise LookupError(f"{self.name}: there is no such place")
        return str(text)

    def change(self, root: Path) -> tuple[str, str]:
        """Return the first line that differs, as it is and as the mutant has it."""
        lines = zip(
            (root / self.path).read_text().splitlines(),
            self.source(root).splitlines(),
            strict=False,
        )
        return next((ours.strip(), theirs.strip()) for ours, theirs in lines if ours != theirs)


@cache
def mutants(root: Path, path: str) -> tuple[Mutant, ...]:
    """Return every mutant of a file, none of them in an annotation or a guard."""
    from cosmic_ray.ast import ast_nodes, get_ast
    from cosmic_ray.plugins import get_operator

    text = (root / path).read_text()
    nodes = list(ast_nodes(get_ast(text)))
    left_out = annotations(text) + guards(text)
    calculated, lines = operations(text), statements(text)
    found = []
    for name in OPERATORS:
        operator = get_operator(name)()
        places = [start for node in nodes for start, _ in operator.mutation_positions(node)]
        found += [
            Mutant(path, name, occurrence, start[0], lines.get(start[0], (start[0],)))
            for occurrence, start in enumerate(places)
            if not _within(start, left_out)
            and ("BinaryOperator" not in name or _within(start, calculated))
        ]
    return tuple(found)


def statements(text: str) -> dict[int, tuple[int, ...]]:
    """Return for each line the lines of the innermost statement that it belongs to."""
    found: dict[int, tuple[int, ...]] = {}
    for node in ast.walk(ast.parse(text)):  # those within others come after them
        if isinstance(node, ast.stmt | ast.ExceptHandler):
            body = getattr(node, "body", None)
            last = body[0].lineno - 1 if body else node.end_lineno or node.lineno
            lines = tuple(range(node.lineno, max(last, node.lineno) + 1))
            found |= dict.fromkeys(lines, lines)
    return found


def _within(place: Place, parts: list[tuple[Place, Place]]) -> bool:
    return any(first <= place < last for first, last in parts)


def operations(text: str) -> list[tuple[Place, Place]]:
    """Return from where to where operators stand that calculate: no star of a signature."""
    nodes = list(ast.walk(ast.parse(text)))
    pairs = [(n.left, n.right) for n in nodes if isinstance(n, ast.BinOp)]
    pairs += [(n.target, n.value) for n in nodes if isinstance(n, ast.AugAssign)]
    return [
        ((a.end_lineno or 0, a.end_col_offset or 0), (b.lineno, b.col_offset)) for a, b in pairs
    ]


def annotations(text: str) -> list[tuple[Place, Place]]:
    """Return from where to where annotations stand."""
    nodes = list(ast.walk(ast.parse(text)))
    notes = [n.annotation for n in nodes if isinstance(n, ast.AnnAssign | ast.arg) and n.annotation]
    notes += [n.returns for n in nodes if isinstance(n, ast.FunctionDef) and n.returns]
    return _extents(notes)


def guards(text: str) -> list[tuple[Place, Place]]:
    """Return from where to where arguments stand that only guard or speed up."""
    calls = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Call)]
    made = [ast.unparse(call.func) == "dataclass" for call in calls]
    keywords = [(k, whole) for call, whole in zip(calls, made, strict=True) for k in call.keywords]
    return _extents([k.value for k, whole in keywords if whole or k.arg in GUARDS])


def _extents(nodes: list[ast.expr]) -> list[tuple[Place, Place]]:
    return [((n.lineno, n.col_offset), (n.end_lineno or 0, n.end_col_offset or 0)) for n in nodes]


def sample(root: Path, paths: list[str], size: int, seed: int) -> list[Mutant]:
    """Return mutants by chance, from each file as many as its share of all of them.

    A larger sample of the same seed holds the smaller one but for the rounding of the shares.
    """
    every = {path: mutants(root, path) for path in paths}
    total = sum(map(len, every.values()))
    share = {path: size * len(found) / total for path, found in every.items()}
    counts = {path: int(value) for path, value in share.items()}
    rest = sorted(paths, key=lambda path: counts[path] - share[path])
    for path in rest[: max(0, min(size, total) - sum(counts.values()))]:
        counts[path] += 1
    drawn = []
    for path, found in every.items():
        shuffled = random.Random(f"{seed} {path}").sample(found, len(found))  # noqa: S311 # no secret
        drawn += shuffled[: counts[path]]
    return drawn
