"""Which pages the site has, in which order, and where each comes from."""

from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]


@dataclass(frozen=True)
class Page:
    """A page of the repository: its name in the contents, where it is, and where in the site."""

    title: str
    source: str
    site: str


def _docs(title: str, name: str) -> Page:
    return Page(title, f"docs/{name}.md", f"{name}.md")


HOME = _docs("Home", "index")
TUTORIAL = _docs("Tutorial", "tutorial")
HOW_TO = (
    _docs("Read your files", "files"),
    _docs("The map, key by key", "ingest"),
    _docs("A project of your own", "init"),
    _docs("Files that you don't trust", "untrusted"),
    _docs("Check recordings", "check"),
    _docs("Plan runs", "plan"),
    _docs("Identify a drive", "drive"),
    _docs("Track a force", "tracking"),
    _docs("Close the loop", "close-loop"),
    _docs("Does a model carry over?", "predict"),
    _docs("Compare two models", "compare"),
    _docs("Look at streams", "viewing"),
    _docs("Many runs: sweeps", "sweep"),
    _docs("Find runs among many datasets", "runs"),
    _docs("Datasets on object storage", "object-storage"),
    _docs("A model for other programs", "export"),
    _docs("Outputs: whole or absent", "outputs"),
)
REFERENCE = (
    _docs("From Python", "python"),
    _docs("File formats", "formats"),
    _docs("Words", "words"),
)
METHOD = (
    _docs("How a diagnosis comes about", "diagnosis"),
    _docs("The blind benchmark", "challenge"),
    _docs("Public measurements", "measured"),
    _docs("The dynamic model", "lugre"),
    _docs("The source paper", "paper"),
    _docs("Scale", "scale"),
    Page("Data: paper-groups", "datasets/paper-groups/README.md", "data/paper-groups.md"),
    Page("Data: drive-chirp", "datasets/drive-chirp/README.md", "data/drive-chirp.md"),
    Page("Data: yang2025", "datasets/yang2025/README.md", "data/yang2025.md"),
)
LIMITS = _docs("What it can't do", "limits")
PROJECT = (
    Page("Changelog", "CHANGELOG.md", "changelog.md"),
    Page("Contributing", "CONTRIBUTING.md", "contributing.md"),
    _docs("Bad input, searched for", "fuzzing"),
    _docs("Do the tests notice?", "mutants"),
)


def pages() -> tuple[Page, ...]:
    """Return every page of the repository that is in the site; the worklog is not."""
    return (HOME, TUTORIAL, *HOW_TO, *REFERENCE, *METHOD, LIMITS, *PROJECT)
