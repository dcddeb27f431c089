"""`tsas reproduce`: the source paper's tables and figures computed again, beside what it prints."""

from tsas_cli.commands.common import Force, Json, OutFolder, Quiet, progress, show


def reproduce(
    out: OutFolder, force: Force = False, quiet: Quiet = False, as_json: Json = False
) -> None:
    """Compute the tables and figures of Yang et al. 2025 again, and say what agrees."""
    from tsas_cli.files import new_folder, write_json
    from tsas_cli.paper import yang2025
    from tsas_cli.reporting.reproduction import reproduction_page
    from tsas_cli.reproduction import GROUPS
    from tsas_cli.reproduction.summary import reproduce as reproduce_paper
    from tsas_cli.reproduction.summary import sentence, summary_of, verdict_table

    paper = yang2025()
    with (
        new_folder(out, force=force) as folder,
        progress("reproduce", len(GROUPS), quiet=quiet or as_json) as step,
    ):
        groups = reproduce_paper(paper, step)
        summary = summary_of(paper, groups)
        write_json(folder / "reproduction.json", summary)
        page = reproduction_page(paper, groups)
        (folder / "index.html").write_text(page, encoding="utf-8")
    show(
        summary,
        [(f"{out / 'index.html'}", *verdict_table(groups))],
        quiet=quiet,
        as_json=as_json,
    )
    if not quiet and not as_json:
        print(sentence(groups))
