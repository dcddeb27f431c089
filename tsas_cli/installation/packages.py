"""The packages that tsas requires, and the installed versions."""

import platform
from collections.abc import Iterator
from dataclasses import dataclass
from importlib import import_module
from importlib.metadata import PackageNotFoundError, metadata, version

from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet

PROJECT = "tsas"
MODULES = {"rerun-sdk": "rerun"}  # modules that are named differently
PURPOSES = {
    "mat": "MATLAB v7.3 files",
    "hdf5": "HDF5 files",
    "mdf": "MDF4 files",
    "excel": "Excel and OpenDocument spreadsheets",
    "tdms": "TDMS files of LabVIEW",
    "robots": "MCAP files and ROS bags",
    "challenge": "the sparse-regression baseline of tsas challenge",
    "dask": "tsas sweep --cluster",
    "catalogue": "queries over many datasets with tsas runs",
    "s3": "datasets on S3, by address (s3://…)",
    "gs": "datasets on Google Cloud Storage, by address (gs://…)",
    "bench": "the general solvers that make bench compares with",
    "all": "every file format, storage, baseline and query",
}


@dataclass(frozen=True)
class Package:
    """A package: the required and the installed version, and its problem, if any."""

    name: str
    asked: str
    found: str | None
    problem: str = ""


@dataclass(frozen=True)
class Extra:
    """An optional set of packages, and its purpose."""

    name: str
    purpose: str
    packages: tuple[Package, ...]

    @property
    def missing(self) -> tuple[str, ...]:
        """The packages that are missing or have a wrong version."""
        return tuple(package.name for package in self.packages if package.problem)


def core_packages() -> Iterator[Package]:
    """Yield Python and every required package, each imported once."""
    asked, python = SpecifierSet(metadata(PROJECT)["Requires-Python"]), platform.python_version()
    fits = asked.contains(python, prereleases=True)
    yield Package("Python", str(asked), python, "" if fits else "wrong version")
    for requirement in _requirements():
        if _holds(requirement):
            package = _package(requirement)
            yield package if package.problem else _imported(package)


def extras() -> list[Extra]:
    """Return the extras; their packages are looked up, not imported."""
    found = []
    for name in metadata(PROJECT).get_all("Provides-Extra") or []:
        only = [r for r in _requirements() if not _holds(r) and _holds(r, name)]
        own = tuple(_package(requirement) for requirement in only)
        found.append(Extra(name, PURPOSES.get(name, ""), own))
    return found


def _requirements() -> list[Requirement]:
    return [Requirement(text) for text in metadata(PROJECT).get_all("Requires-Dist") or []]


def _holds(requirement: Requirement, extra: str = "") -> bool:
    return requirement.marker is None or requirement.marker.evaluate({"extra": extra})


def _package(requirement: Requirement) -> Package:
    asked = str(requirement.specifier)
    try:
        found = version(requirement.name)
    except PackageNotFoundError:
        return Package(requirement.name, asked, None, "missing")
    fits = requirement.specifier.contains(found, prereleases=True)
    return Package(requirement.name, asked, found, "" if fits else "wrong version")


def _imported(package: Package) -> Package:
    """Return the package with the error of its import; a broken one may raise any type."""
    try:
        import_module(MODULES.get(package.name, package.name.replace("-", "_")))
    except Exception as error:  # noqa: BLE001 # the error is the result
        reason = f"{type(error).__name__}: {error}".splitlines()[0]
        return Package(package.name, package.asked, package.found, f"cannot be loaded: {reason}")
    return package
