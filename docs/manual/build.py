"""Put the pages together, generated ones among them, and let zensical make the site."""

import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import tomlkit

from docs.manual import pages
from docs.manual.api import api_page
from docs.manual.colours import site_style
from docs.manual.commands import command_page
from docs.manual.effects import PLACES, effect_pages
from docs.manual.links import for_site, targets
from tsas_cli.effects import EFFECTS

ASSETS = Path(__file__).parent / "assets"
SETTINGS = Path(__file__).parent / "zensical.toml"
GENERATED = {  # where links of the repository lead in the site, beside its pages
    "README.md": pages.HOME.site,
    "tsas_cli/commands": "commands.md",
    "tsas_cli/effects": "effects/index.md",
    **{f"tsas_cli/effects/{effect.name}.py": f"effects/{effect.name}.md" for effect in EFFECTS},
}


def write_sources(folder: Path, effects: dict[str, str]) -> None:
    """Write what zensical reads into an empty folder: the settings, the pages, what they show.

    Raises
    ------
    ValueError
        A page links to something that the repository does not hold.
    """
    source = folder / "source"
    (source / "assets").mkdir(parents=True)
    for asset in ASSETS.iterdir():
        shutil.copy(asset, source / "assets")
    (source / "assets" / "tsas.css").write_text(site_style(), encoding="utf-8")
    sites = {page.source: page.site for page in pages.pages()} | GENERATED
    texts = {page: (pages.ROOT / page.source).read_text(encoding="utf-8") for page in pages.pages()}
    for page, text in texts.items():
        for target in targets(text, page.source):
            if not (pages.ROOT / target).exists():
                raise ValueError(f"{page.source}: there is no {target}")
            if target.endswith(".svg"):
                sites[target] = Path(target).name
                shutil.copy(pages.ROOT / target, source)
    generated = {"commands.md": command_page(), "api.md": api_page(), **effects}
    ours = {page.site: for_site(text, page.source, sites) for page, text in texts.items()}
    for site, text in (generated | ours).items():
        (source / site).parent.mkdir(parents=True, exist_ok=True)
        (source / site).write_text(text, encoding="utf-8")
    settings = tomlkit.parse(SETTINGS.read_text(encoding="utf-8"))
    settings["project"]["nav"] = _contents()
    (folder / "zensical.toml").write_text(tomlkit.dumps(settings), encoding="utf-8")


def build(folder: Path, effects: dict[str, str] | None = None) -> Path:
    """Build the site in an empty folder and return where it is.

    Raises
    ------
    RuntimeError
        zensical has something to complain of; its words are the error's.
    """
    write_sources(folder, effect_pages() if effects is None else effects)
    call = [sys.executable, "-m", "zensical", "build", "--strict"]
    done = subprocess.run(call, cwd=folder, capture_output=True, text=True, check=False)  # noqa: S603
    if done.returncode:
        raise RuntimeError(done.stdout + done.stderr)
    return folder / "site"


def _contents() -> list[dict[str, Any]]:
    def entries(some: tuple[pages.Page, ...]) -> list[dict[str, Any]]:
        return [{page.title: page.site} for page in some]

    effects: list[Any] = [
        {
            place.capitalize(): [
                {effect.title: f"effects/{effect.name}.md"}
                for effect in EFFECTS
                if effect.acts_on == place
            ]
        }
        for place in PLACES
    ]
    reference = [
        {"Commands": "commands.md"},
        {"Python, call by call": "api.md"},
        *entries(pages.REFERENCE),
    ]
    return [
        {pages.HOME.title: pages.HOME.site},
        {pages.TUTORIAL.title: pages.TUTORIAL.site},
        {"How-to": entries(pages.HOW_TO)},
        {"Effects": ["effects/index.md", *effects]},
        {"Reference": reference},
        {"Method": entries(pages.METHOD)},
        {pages.LIMITS.title: pages.LIMITS.site},
        {"Project": entries(pages.PROJECT)},
    ]
