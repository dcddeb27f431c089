import re
from html import unescape

import pytest

from tests.reporting.conftest import no_curves
from tests.reporting.made_diagnoses import REASONS, make_diagnosis
from tests.reporting.made_folders import edited, make_dataset, page_from
from tests.reporting.test_page import Outline, headings, rows
from tsas_cli.effects import EFFECTS
from tsas_cli.reporting.inputs import read_inputs
from tsas_cli.reporting.numbers import plain


@pytest.fixture(scope="module")
def dataset(tmp_path_factory):
    return make_dataset(tmp_path_factory.mktemp("diagnosis") / "dataset", ("a",), samples=400)


@pytest.fixture(scope="module")
def sections(dataset):
    """The section of the diagnosis, by verdict."""
    with no_curves():
        return {v: written(make_diagnosis(dataset, dataset.parent / v, v)) for v in REASONS}


def written(folder):
    whole = page_from(folder)
    Outline(whole)
    return whole[whole.index('<section id="diagnosis"') : whole.index('<section id="recordings"')]


@pytest.fixture
def of(dataset, tmp_path, undrawn):
    """Return a function that makes the section of a diagnosis whose file says more."""
    return lambda verdict, **more: written(make_diagnosis(dataset, tmp_path / "d", verdict, **more))


@pytest.fixture
def named(dataset, tmp_path, undrawn):
    """Return a function that makes the section after a change of what is named."""

    def make(**changed):
        folder = make_diagnosis(dataset, tmp_path / "d", "named")
        with edited(folder / "diagnosis.json") as content:
            content["named"][0] |= changed
        return written(folder)

    return make


def words(text):
    return unescape(re.sub("<[^>]*>", "", text))


def labels(text):
    return [unescape(label) for label in re.findall('aria-label="([^"]*)"', text)]


@pytest.mark.parametrize("verdict", REASONS)
def test_the_first_sentence_is_the_verdict(sections, verdict):
    first = ("Undecided: " if verdict == "undecided" else "") + REASONS[verdict]
    assert f">Diagnosis</a></h2>\n<p>{first}</p>" in sections[verdict]


def test_a_named_cause_says_what_it_is_with_equation_and_gain(sections):
    text = sections["named"]
    sentence = next(e.sentence for e in EFFECTS if e.name == "free_tendon")
    order = [
        ">Tendon outside the sheath</a></h3>",
        sentence,
        "<code>proximal_length_mm</code> 152.0 mm, 95 % interval 145.9 to 158.1</li>",
        "x_in − x_sheath = (T0 − F0)·l/EA",
        "lowers the normalised residual by 48.2 % (95 % interval 44.9 to 51.0 %).",
        "Cannot tell",
        "The preload stays open: no run is at &lt;rest&gt;.",
        "What is left",
        "Each of 4 runs is predicted",
        "What was tried",
    ]
    places = [text.index(gains_part) for gains_part in order]
    assert places == sorted(places)
    assert "indistinguishable from" not in text
    assert "distal_length_mm 0.000 mm, at its bound\n" in words(text)


def test_an_equation_of_several_lines_stands_on_several(named):
    assert "<code>a &lt; b</code>\n<code>c = d</code>" in named(equation="a < b,  c = d")


def test_an_ambiguous_cause_shares_its_heading_with_its_rival(sections):
    text = sections["ambiguous"]
    assert headings(text, 3)[0] == "Tendon outside the sheath (or compliance of the drive)"
    sentence = next(e.sentence for e in EFFECTS if e.name == "drive_compliance")
    rival = "indistinguishable from compliance of the drive (drive_compliance)."
    assert f"In these recordings it is {rival} {sentence}" in words(text)


def test_errors_before_and_after_stand_in_their_columns(sections, dataset):
    found = rows(sections["named"])
    noise = read_inputs([dataset]).noise["f_in_N"]
    over = [plain(rms / noise, 3) for rms in (0.91, 0.11)]
    header = ["channel", "nominal model", "extended model", "attainable", "noise level", "unit"]
    assert [*header, "nominal, normalised", "extended, normalised"] in found
    assert ["f_in_N", "0.910", "0.110", "0.105", plain(noise, 3), "N", *over] in found
    (bars,) = (label for label in labels(sections["named"]) if "held-out data. " in label)
    assert "tension at the drive: nominal model 0.910, extended model 0.110, attain" in bars


@pytest.mark.parametrize("verdict", ["sufficient", "unexplained"])
def test_without_a_name_there_is_no_after(sections, verdict):
    text = sections[verdict]
    header = ["channel", "nominal model", "attainable", "noise level", "unit"]
    assert [*header, "nominal, normalised"] in rows(text)
    assert "var(--after)" not in text
    assert "Residual on held-out data" in headings(text, 3)


def test_where_no_less_is_attainable_that_is_said_once(of):
    reached = {"rmse_before": 1.0, "rmse_after": 0.1, "noise_floor": 0.11, "attainable": 0.1}
    text = of("named", channels=dict.fromkeys(("f_in_N", "f_out_N"), reached))
    assert words(text).count("attainable") == 0
    assert "signals leaves no less" in words(text)
    assert not any("attainable" in label for label in labels(text))


def test_a_long_verdict_is_a_paragraph_and_a_list(of):
    said = "First of 1.5 N. Second. Third of f_in_N. Fourth."
    text = of("unexplained", reason=said, candidates=[])
    assert "Screening left no effect" in text
    assert "<p>First of 1.5 N. Second.</p>" in text
    assert re.findall("<li>([TF][^<]*)</li>", text)[:2] == ["Third of f_in_N.", "Fourth."]


def test_what_a_stand_in_fails_to_prove_is_said_once(of):
    failed = ["may be zero", "is not constant"]
    parameters = {"play_mm": {"value": 0.2, "unit": "mm"}}
    stand_in = {"effect": "backlash", "parameters": parameters, "failed": failed}
    text = of("partly", reason="It is not proven: it may be zero.", stand_ins=[stand_in])
    assert words(text).count("may be zero") == 1
    assert "It is not constant." in words(text)


def test_what_is_left_is_said_with_its_size_and_nothing_of_too_little_data(sections):
    text = words(sections["unexplained"])
    assert "remaining residual is 38.4; 1" in text
    assert "after what is named" not in text
    assert "residual, 12 % is left after what is named" in words(sections["named"])
    assert headings(sections["undecided"], 3) == []
    assert "<svg" not in sections["undecided"]


def maps_of(text):
    return [label for label in labels(text) if label.startswith("Mean residual over")]


def test_errors_that_do_not_stand_out_of_the_noise_are_not_drawn(of):
    flat = {"from": 0.0, "to": 1.0, "label": "", "mean": 0.1, "sd": 1.0, "samples": 9}
    text = of("sufficient", residual_map={"before": {"f_in_N": {"x_in_mm": [flat, flat]}}})
    assert "Over no signal does the residual stand out of the noise." in text
    assert not maps_of(text)


def test_maps_show_the_strongest_first_and_only_the_channels_that_are_off(sections):
    shown = maps_of(sections["named"])
    assert "over the phase of the cycle" in shown[0]
    assert (
        "f_in_N: nominal model −0.91 to 8.2 with scatter up to 1.0, extended model −0.020 to 0.18"
        in shown[0]
    )
    assert len(shown) == 4
    assert not any("f_out_N:" in label for label in shown)


def test_an_error_that_shows_only_in_the_scatter_is_drawn(of):
    bins = [
        {"from": k, "to": k + 1.0, "label": "", "mean": 0.0, "sd": sd, "samples": 9}
        for k, sd in enumerate((8.0, 1.0, 1.0))
    ]
    maps = {"before": {"f_in_N": {"travel_since_reversal_mm": bins}}}
    (label,) = maps_of(of("unexplained", residual_map=maps))
    assert "f_in_N: 0.0 to 0.0 with scatter up to 8.0" in label


def test_candidates_stand_in_order_with_gain_and_test_statistic(sections):
    found = rows(sections["named"])
    first = found.index(["free_tendon + backlash", "87.2", "6.0", "yes", ""])
    assert found[first + 1][:4] == ["backlash", "43.6", "5.0", "yes"]
    assert found[first + 5][-1] == "did not converge"
    assert "Hypotheses, 10 of 12, best first" in sections["named"]
    assert "bend_drift" not in sections["named"]


def test_what_is_named_and_its_rivals_are_marked_wherever_they_rank(of):
    alone = {"gain_percent": 9.0, "test_statistic": 3.0, "convincing": True, "mean_square": 1.0}
    tried = [{"effects": ["backlash", f"e{n}"], **alone} for n in range(12)]
    tried += [{"effects": [e], **alone} for e in ("free_tendon", "presliding", "drive_compliance")]
    text = of("ambiguous", candidates=tried)
    marks = {row[0]: row[-1] for row in rows(text) if len(row) == 5 and row[-1]}
    assert marks["free_tendon"] == "named"
    assert marks["drive_compliance"] == "rival"
    assert "presliding" not in marks
    assert ">backlash + e9<" in text
    assert ">backlash + e10<" not in text


def test_effects_that_look_alike_are_grouped_and_hidden_ones_named(sections):
    text = words(sections["named"])
    group = "drive_compliance, free_tendon and sheath_compression (similarity at least 0.97)"
    assert group in text
    assert "direction_dependent_friction and force_sensor_gain (sim" in text
    assert text.count("for some values of their parameters") == 1
    assert "indistinguishable" not in text
    assert "backlash and" not in text
    assert "These inputs hardly show load_inertia at" in text


@pytest.mark.usefixtures("undrawn")
def test_the_command_names_the_model_that_was_diagnosed(dataset, tmp_path):
    folder = make_diagnosis(dataset, tmp_path / "d", "undecided")
    assert f"tsas diagnose {dataset} --out {folder}" in page_from(folder)
    model = {"file": "my model.toml", "sha256": "ab" * 32}
    folder = make_diagnosis(dataset, tmp_path / "d", "undecided", model=model)
    text = unescape(page_from(folder))
    assert f"tsas diagnose {dataset} --model 'my model.toml' --out {folder}" in text
    assert "ab" * 32 in text


@pytest.mark.usefixtures("undrawn")
def test_a_diagnosis_of_minimal_keys_makes_a_page(dataset, tmp_path):
    folder = make_diagnosis(dataset, tmp_path / "d", "named")
    kept = {"format", "stage", "version", "dataset", "verdict", "reason", "named", "channels"}
    with edited(folder / "diagnosis.json") as content:
        for name in content.keys() - kept:
            del content[name]
        for name in ("title", "equation", "gain_percent", "gain_interval_percent"):
            del content["named"][0][name]
    text = written(folder)
    law = next(e.equation for e in EFFECTS if e.name == "free_tendon")
    assert all(f"<code>{line}</code>" in text for line in law.split(",  "))


def test_a_loss_is_no_reduction(of):
    tried = [
        {"effects": [name], "gain_percent": gain, "test_statistic": 3.0}
        for name, gain in (("free_tendon", 48.2), ("backlash", 7.0), ("presliding", -935.0))
    ]
    text = of("named", candidates=tried)
    shown = {("free_tendon", "48.2"), ("backlash", "7.0"), ("presliding", "none")}
    assert shown <= {tuple(row[:2]) for row in rows(text)}
    assert "935" not in text


def test_a_parameter_of_a_channel_that_was_not_recorded_is_not_shown(named):
    delay = {"value": 0.1, "unit": "s", "interval_low": 0.0, "interval_high": 0.2}
    parameters = {"f_in_delay_s": delay, "x_out_delay_s": delay}
    text = named(effect="channel_delay", parameters=parameters)
    assert "f_in_delay_s" in text
    assert "x_out_delay_s" not in text
