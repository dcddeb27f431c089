from collections import Counter
from dataclasses import replace

import pytest

from tsas_cli.effects import EFFECTS
from tsas_studies.challenge.cases import BUILDING, FULL, PAIRS, SCORING, SIZES, TRIPLES, cases, part
from tsas_studies.challenge.faults import FAULTS
from tsas_studies.challenge.near import NEAR_FULL, RESERVED
from tsas_studies.challenge.recording_faults import RECORDING_FAULTS
from tsas_studies.challenge.rig.hidden import CATALOGUE as HIDEABLE
from tsas_studies.challenge.rig.near import NEAR
from tsas_studies.challenge.rig.unknowns import UNKNOWNS

KINDS = ("near", "fault")
ALL = cases(7)
CLEAN = [case for case in ALL if case.conditions == "clean"]
NO_SIZE = "an effect has its place in the rig (rig/hidden.py) and its full size (near.NEAR_FULL)"
CATALOGUE = {effect.name: {p.name: p for p in effect.parameters} for effect in EFFECTS}


def mixed(case):
    return case.name.startswith("mixed")


def test_every_effect_is_there_at_every_size_and_the_rest_beside_it():
    one = Counter((c.hidden[0].cause, c.size) for c in CLEAN if c.kind == "one")
    assert one == {(effect, size): 1 for effect in CATALOGUE for size in SIZES}, NO_SIZE
    assert {c.hidden[0].cause for c in CLEAN if c.kind == "unknown"} == set(UNKNOWNS)
    for kind, known, many in (("pair", PAIRS, 2), ("triple", TRIPLES, 3)):
        sets = [{h.cause for h in c.hidden} for c in CLEAN if c.kind == kind]
        assert all(set(effects) in sets for effects in known)
        assert len(sets) > len(known) >= 3 * many - 3
        assert all(len(causes) == many for causes in sets)
    assert all(c.hidden == () for c in ALL if c.kind == "nothing")
    near = Counter((c.hidden[0].cause, c.size) for c in CLEAN if c.kind == "near" and not mixed(c))
    causes = set(NEAR_FULL) & set(NEAR) - RESERVED
    assert near == {(cause, size): 1 for cause in causes for size in SIZES}
    faults = Counter((c.hidden[0].cause, c.size) for c in CLEAN if c.kind == "fault")
    assert faults == {(fault, size): 1 for fault in set(FAULTS) - RESERVED for size in SIZES}
    assert set(NEAR) <= set(NEAR_FULL) | set(FAULTS)
    of_recording = {(c.hidden[0].cause, c.size) for c in CLEAN if c.kind == "recording"}
    assert of_recording == {(name, s) for name, f in RECORDING_FAULTS.items() for s in f.sizes}
    assert all(len({h.cause for h in c.hidden}) == 3 for c in CLEAN if mixed(c))
    assert sum(map(mixed, CLEAN)) == len(SIZES)


def test_every_clean_case_but_small_faults_is_there_again_under_realistic_conditions():
    again = [
        replace(c, name=c.name.removesuffix(", realistic"), conditions="clean")
        for c in ALL
        if c.conditions == "realistic"
    ]
    assert again == [c for c in CLEAN if c.kind not in ("fault", "recording")]
    slow = [c for c in ALL if c.conditions == "slow"]
    assert {c.kind for c in slow} == {"nothing"}
    assert len(slow) == len([c for c in CLEAN if c.kind == "nothing"])
    assert len({(c.number, c.conditions) for c in ALL}) == len(ALL)


def test_the_first_cases_keep_their_numbers_whatever_else_is_added():
    """Their recordings are drawn from it, and sets made before have to be made again."""
    first = [c for c in CLEAN if c.number < 1000]
    assert [c.number for c in first] == list(range(79))
    assert (first[0].name, first[78].name) == ("backlash, size 1", "end_stop")


def test_some_causes_are_hidden_with_the_seeds_for_scoring_alone():
    assert len(RESERVED) == 6
    scoring = cases(SCORING[0])
    hidden = {
        kind: {h.cause for c in scoring if c.kind == kind for h in c.hidden} for kind in KINDS
    }
    assert hidden["near"] == set(NEAR_FULL) - set(CATALOGUE) > RESERVED
    assert hidden["fault"] == set(FAULTS)
    for seed in (*BUILDING[:3], BUILDING[-1], SCORING[0] - 1):
        assert not RESERVED & {h.cause for c in cases(seed) for h in c.hidden}


def test_near_causes_have_the_rigs_parameters_and_their_own_chance():
    for cause, variants in (*NEAR_FULL.items(), *FAULTS.items()):
        known = {**HIDEABLE, **NEAR, **UNKNOWNS}[cause]
        assert all({*v.scaled, *v.drawn} <= set(known) for v in variants)
    rolls = [
        next(c for c in cases(seed) if c.name == "strand_roll, size 0.4").hidden[0].parameters
        for seed in range(40)
    ]
    full = NEAR_FULL["strand_roll"][0].scaled["share"]
    shares = [roll["share"] / (0.4 * full) for roll in rolls]
    assert 0.8 <= min(shares) < 0.85
    assert 1.15 < max(shares) <= 1.2


def test_a_seed_tells_the_cases():
    assert cases(7) == ALL
    assert cases(8) != ALL


@pytest.mark.parametrize("seed", range(20))
def test_parameters_are_the_catalogues_inside_its_bounds_and_not_neutral(seed):
    for case in cases(seed):
        for hidden in case.hidden if case.kind in ("one", "pair", "triple") else ():
            known = CATALOGUE[hidden.cause]
            values = hidden.parameters
            assert all(known[p].lower <= value <= known[p].upper for p, value in values.items())
            moved = [p for p in values if not known[p].shape and values[p] != known[p].neutral]
            assert moved, hidden


def test_sizes_scale_and_vary_by_a_fifth():
    """The first two of a seed are a backlash at both sizes."""
    first = [cases(seed)[:2] for seed in range(100)]
    full = FULL["backlash"][0]["play_mm"]
    for k, size in enumerate(SIZES):
        assert {of[k].name for of in first} == {f"backlash, size {size:g}"}
        ratio = [of[k].hidden[0].parameters["play_mm"] / (full * size) for of in first]
        assert 0.8 <= min(ratio) < 0.82
        assert 1.18 < max(ratio) <= 1.2


def test_signs_vary_where_they_can_and_gains_stay_about_one():
    found = {"f_out_gain": [], "asymmetry": [], "friction_N": []}
    for seed in range(40):
        for case in cases(seed):
            for hidden in case.hidden if case.kind == "one" else ():
                for name in found.keys() & hidden.parameters.keys():
                    found[name].append(hidden.parameters[name])
    assert min(found["f_out_gain"]) < 1.0 < max(found["f_out_gain"])
    assert all(0.9 < gain < 1.1 for gain in found["f_out_gain"])
    assert min(found["asymmetry"]) < 0.0 < max(found["asymmetry"])
    assert min(found["friction_N"]) > 0.0


def test_seeds_to_build_with_and_to_score_with_are_apart():
    assert not set(BUILDING) & set(SCORING)


def test_a_small_part_has_each_effect_once_at_full_size_and_a_few_of_what_is_none():
    small = part(ALL)
    one = Counter(c.hidden[0].cause for c in small if c.kind == "one")
    assert one == dict.fromkeys(CATALOGUE, 1), NO_SIZE
    assert {c.size for c in small if c.kind == "one"} == {1.0}
    assert Counter(c.kind for c in small if c.kind != "one") == {
        "nothing": 2,
        "unknown": 2,
        "near": 2,
        "fault": 2,
        "recording": 2,
    }
    assert all(case in ALL for case in small)
