"""The effects manual: a page for each effect, from the text that `tsas explain` prints."""

import re
from collections.abc import Callable

from docs.manual.drawn import signature_picture
from docs.manual.signatures import SIGNATURES
from tsas_cli.effects import EFFECTS
from tsas_cli.effects.effect import Effect

PARTS = ("What one sees", "Equation", "Mistaken for", "Not validated")
PLACES = ("drive", "tendon", "load", "sensor")
NAMED = re.compile(rf"\b({'|'.join(effect.name for effect in EFFECTS)})\b")


def parts_of(doc: str) -> dict[str, str]:
    """Return the parts of an effect's text by their names; the first sentence has none.

    Raises
    ------
    ValueError
        A part is missing, or stands elsewhere.
    """
    pieces = re.split(rf"^({'|'.join(PARTS)}): ", doc.strip(), flags=re.MULTILINE)
    if tuple(pieces[1::2]) != PARTS:
        raise ValueError(f"expected the parts {PARTS}, found {pieces[1::2]}")
    texts = [_begun(" ".join(piece.split())) for piece in pieces[::2]]
    return dict(zip(("", *PARTS), texts, strict=True))


def _begun(text: str) -> str:
    """Return a part with a capital where it begins with a word, and not with a name."""
    word = text.split(maxsplit=1)[0]
    return text if "_" in word or (len(word) == 1 and word != "a") else text[0].upper() + text[1:]


def effect_pages(draw: Callable[[Effect], str] | None = None) -> dict[str, str]:
    """Return the pages by their paths in the site; `draw` gives an effect's figure as HTML."""
    draw = draw or _figure
    pages = {f"effects/{effect.name}.md": _page(effect, draw(effect)) for effect in EFFECTS}
    return {"effects/index.md": _index(), **pages}


def _figure(effect: Effect) -> str:
    drawn = signature_picture(effect, SIGNATURES[effect.name])
    return (
        f"<figure data-search-exclude>{drawn.svg}<figcaption>{drawn.caption}</figcaption></figure>"
    )


def _page(effect: Effect, figure: str) -> str:
    parts = parts_of(effect.doc)
    rows = [
        f"| `{p.name}` | {p.unit} | {'any' if p.shape else f'{p.neutral:g}'} | {p.lower:g} "
        f"| {p.upper:g} |"
        for p in effect.parameters
    ]
    return "\n".join(
        (
            f"# {effect.title}",
            f"\n`{effect.name}` · acts on the {effect.acts_on}",
            f"\n{parts['']}",
            f"\n{figure}",
            f"\n## What one sees\n\n{parts['What one sees']}",
            f"\n## Equation\n\n```\n{effect.equation}\n```\n\n{_linked(parts['Equation'])}",
            "\n## Parameters\n\n| parameter | unit | neutral | lowest | highest |",
            "|---|---|---|---|---|",
            *rows,
            f"\n## Mistaken for\n\n{_linked(parts['Mistaken for'], but=effect.name)}",
            f"\n## Experiment\n\n{effect.experiment}",
            f"\n## Not validated\n\n{parts['Not validated']}",
            (
                f"\n`tsas explain {effect.name}` prints this text; grey is the rig of group a of "
                "Yang 2025 without the effect, simulated on the slip chain.\n"
            ),
        )
    )


def _linked(text: str, but: str = "") -> str:
    """Return the text with the names of other effects as links to their pages."""
    return NAMED.sub(lambda name: name[0] if name[0] == but else f"[{name[0]}]({name[0]}.md)", text)


def _index() -> str:
    lines = [
        "# Effects manual",
        (
            "\nWhat makes a real rig differ from the nominal one: what a diagnosis can name. "
            "Each page says what one sees, the law, what it is mistaken for, the experiment that "
            "isolates it, and draws its signature: the loops without it and with it, and what it "
            "changes, at a size that the eye sees at once. [How a diagnosis comes about]"
            "(../diagnosis.md) works with far smaller ones."
        ),
    ]
    for place in PLACES:
        lines.append(f"\n## {place.capitalize()}\n\n| effect | what it is |\n|---|---|")
        lines += [
            f"| [{effect.title}]({effect.name}.md) | {effect.sentence} |"
            for effect in EFFECTS
            if effect.acts_on == place
        ]
    return "\n".join(lines) + "\n"
