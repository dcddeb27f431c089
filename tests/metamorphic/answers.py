"""What calibrate and diagnose say of recordings, as numbers that can be held against each other."""

from functools import cached_property

import tsas_cli as tsas

FORCES = ("preload_N", "preload_correction_N", "load_stiffness_N_per_mm", "tendon_stiffness_N")


class Answers:
    """The whole way from files to a verdict; each stage runs when it is first asked for."""

    def __init__(self, raw, folder):
        self.raw = raw
        sources, path = raw.write(folder)
        self.dataset = tsas.ingest(sources, map=path, out=folder / "dataset").dataset

    def columns(self):
        """Return the columns of each run, as ingested."""
        return {recording.run.id: recording.columns for recording in self.dataset}

    @cached_property
    def calibrate(self):
        return tsas.calibrate(self.dataset, despite=("filtered",))

    @cached_property
    def diagnose(self):
        """What diagnose says; samples laid between samples look filtered, and are."""
        return tsas.diagnose(self.dataset, despite=("filtered",))

    @property
    def verdict(self):
        """The verdict with what is named and its rivals."""
        said = self.diagnose.summary
        return said["verdict"], [(c["effect"], sorted(c["rivals"])) for c in said["named"]]


def fitted(result):
    """Return what a stage has fitted, by name and run."""
    return {(e.name, e.run): e for e in result.model.estimates if e.origin == "fitted"}


def apart(ours, theirs, *, names=None, times=1.0, moved=None, shared_only=False):
    """Return by how many standard errors a parameter of two results of a stage differs at most.

    `names` is what the second calls the runs of the first, `times` by what its forces are larger,
    `moved` by what other parameters are. With `shared_only` those of one run do not count.
    """
    found, other = {}, fitted(theirs)
    for (name, run), one in fitted(ours).items():
        if shared_only and (run is not None or name == "preload_correction_N"):
            continue
        same = other[name, (names or {}).get(run, run)]
        scale = times if name in FORCES else 1.0
        off = same.value / scale - one.value - (moved or {}).get(name, 0.0)
        found[name, run] = abs(off) / max(one.stderr, same.stderr / scale)
    assert len(found) > 1
    return float(max(found.values()))
