"""From pages as they stand in the repository to pages of the site."""

import os
import re
from collections.abc import Mapping
from pathlib import PurePosixPath

FENCE = re.compile(r"^```.*?^```[^\n]*$", re.MULTILINE | re.DOTALL)
COMMENT = re.compile(r"^<!--.*?-->\n", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"(!?)\[([^\]]*)\]\(([^)\s]+)\)")
OUTSIDE = re.compile(r"[a-z]+:")


def for_site(text: str, page: str, sites: Mapping[str, str]) -> str:
    """Return a page's text with comments gone, sessions marked, and links that lead in the site.

    Parameters
    ----------
    text
        Markdown as it stands in the repository.
    page
        The page's path in the repository.
    sites
        The path in the site of everything that is there, by its path in the repository. A link to
        anything else of the repository keeps its words alone.
    """
    pieces, end = [], 0
    text = COMMENT.sub("", text)
    for fence in FENCE.finditer(text):
        pieces += [_relinked(text[end : fence.start()], page, sites), _marked(fence[0])]
        end = fence.end()
    return "".join([*pieces, _relinked(text[end:], page, sites)])


def _marked(fence: str) -> str:
    return fence.replace("```\n$ ", "```console\n$ ", 1)


def _relinked(prose: str, page: str, sites: Mapping[str, str]) -> str:
    def relink(link: re.Match[str]) -> str:
        image, words, target = link.groups()
        place, _, anchor = target.partition("#")
        if OUTSIDE.match(target) or not place:
            return link[0]
        there = os.path.normpath(PurePosixPath(page).parent / place)
        if there not in sites:
            return words
        here = PurePosixPath(sites[page]).parent
        relative = os.path.relpath(sites[there], here)
        return f"{image}[{words}]({relative}{'#' * bool(anchor)}{anchor})"

    return LINK.sub(relink, prose)


def targets(text: str, page: str) -> list[str]:
    """Return the paths in the repository that a page's links lead to."""
    prose = FENCE.sub("", text)
    places = [link[3].partition("#")[0] for link in LINK.finditer(prose)]
    return [
        os.path.normpath(PurePosixPath(page).parent / place)
        for place in places
        if place and not OUTSIDE.match(place)
    ]
