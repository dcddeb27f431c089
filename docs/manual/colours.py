"""The colours of the program's own pages, as styles of the site and of a picture by itself."""

from tsas_cli.reporting.colours import schemes


def palettes() -> tuple[str, str]:
    """Return the declarations of light and dark that the report's style sheet makes."""
    light, dark = (
        " ".join(f"--{role}: {colour};" for role, colour in scheme.items()) for scheme in schemes()
    )
    return light, dark


def site_style() -> str:
    """Return the style sheet that gives figures their colours in either scheme."""
    light, dark = palettes()
    return f""":root {{ {light} }}
[data-md-color-scheme="slate"] {{ {dark} }}
.md-typeset figure {{ margin: 1.2em 0; max-width: 31rem; }}
.md-typeset figure svg {{ display: block; width: 100%; height: auto; overflow: visible; }}
.md-typeset figure svg text {{ font-family: inherit !important; }}
.md-typeset figcaption {{
  max-width: none; margin: 0.5rem 0 0; text-align: left; font-style: normal;
  color: var(--md-default-fg-color--light);
}}
.md-typeset pre > code {{ font-size: 0.78em; }}
.md-typeset table:not([class]) th {{ min-width: 0; }}
.md-typeset table:not([class]) code {{ white-space: nowrap; }}
@media (max-width: 40em) {{ .md-typeset table:not([class]) code {{ white-space: normal; }} }}
.md-typeset img {{ max-width: 100%; height: auto; }}
"""
