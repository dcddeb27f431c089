"""The paper done again: every table and figure that can be computed, held against what it prints.

Each table or figure is one file with one function from the `Paper` to a `Group`, and its line in
`GROUPS`.
"""

from collections.abc import Callable

from tsas_cli.paper import Paper
from tsas_studies.reproduction.beyond import beyond
from tsas_studies.reproduction.contradictions import contradictions
from tsas_studies.reproduction.fig_4 import fig_4
from tsas_studies.reproduction.fig_7 import fig_7
from tsas_studies.reproduction.figs_9_to_11 import figs_9_to_11
from tsas_studies.reproduction.group import Group
from tsas_studies.reproduction.lyapunov import lyapunov
from tsas_studies.reproduction.table_3 import table_3
from tsas_studies.reproduction.table_5 import table_5
from tsas_studies.reproduction.tables_1_2_4 import tables_1_2_4

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
