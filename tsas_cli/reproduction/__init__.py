"""The paper done again: every table and figure that can be computed, held against what it prints.

Each table or figure is one file with one function from the `Paper` to a `Group`, and its line in
`GROUPS`.
"""

from collections.abc import Callable

from tsas_cli.paper import Paper
from tsas_cli.reproduction.beyond import beyond
from tsas_cli.reproduction.contradictions import contradictions
from tsas_cli.reproduction.fig_4 import fig_4
from tsas_cli.reproduction.fig_7 import fig_7
from tsas_cli.reproduction.figs_9_to_11 import figs_9_to_11
from tsas_cli.reproduction.group import Group
from tsas_cli.reproduction.lyapunov import lyapunov
from tsas_cli.reproduction.table_3 import table_3
from tsas_cli.reproduction.table_5 import table_5
from tsas_cli.reproduction.tables_1_2_4 import tables_1_2_4

GROUPS: tuple[Callable[[Paper], Group], ...] = (
    tables_1_2_4,
    table_3,
    fig_7,
    fig_4,
    figs_9_to_11,
    table_5,
    lyapunov,
    contradictions,
    beyond,
)
