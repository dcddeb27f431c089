import json
import re
import shutil

import pytest

from tests.commands.documented import documented
from tests.commands.test_track import QUICK
from tests.reporting.test_page import Outline
from tsas_cli.comparing import tracked
from tsas_cli.comparing.tracked import are_tracked, compare_tracked, tables
from tsas_cli.reporting.comparing import tracked_page
from tsas_cli.stages.track import track
from tsas_cli.support.errors import InputError

WEAKER = QUICK + "[controllers.pid]\nproportional_rpm_per_mm = 2.0\n"


@pytest.fixture(scope="module")
def root(tmp_path_factory):
    """Folders of a PID controller, and of a weaker one."""
    root = tmp_path_factory.mktemp("tracked")
    for name, text in (("usual", QUICK), ("weaker", WEAKER)):
        (root / f"{name}.toml").write_text(text, encoding="utf-8")
        track(settings=root / f"{name}.toml", controllers="pid", seeds=2, out=root / name)
    return root


@pytest.fixture(scope="module")
def it(root):
    return compare_tracked(root / "usual", root / "weaker")


def ratio(it):
    (rmse,) = (one for one in it.record.scores if one.score == "rmse_N")
    return rmse.ratio


def test_the_setting_that_differs_is_named_with_both_values(it):
    known = {s.name: (s.a, s.b) for s in it.record.settings}
    assert known.pop("settings.controllers.pid.proportional_rpm_per_mm") == (25.0, 2.0)
    assert set(known) == {"settings.file", "settings.sha256"}
    assert not any("another one" in note for note in it.record.notes)


def test_the_scores_stand_beside_each_other_and_turn_with_the_sides(root, it):
    (both,) = it.followed
    for side, result in zip(("usual", "weaker"), both, strict=True):
        (said,) = json.loads((root / side / "tracking.json").read_text())["results"]
        assert result.scores["rmse_N"].mean == said["scores"]["rmse_N"]["mean"]
    scatter = max(r.scores["rmse_N"].sd / r.scores["rmse_N"].mean for r in both)
    assert ratio(it) > 1.0 + 10.0 * scatter > 1.0
    turned = compare_tracked(root / "weaker", root / "usual")
    assert ratio(turned) == pytest.approx(1.0 / ratio(it))


def test_the_same_folder_differs_in_nothing(root):
    it = compare_tracked(root / "usual", root / "usual")
    assert it.record.settings == ()
    assert ratio(it) == 1.0
    assert "Both were asked for the same." in it.record.notes


def test_a_condition_of_the_same_name_that_is_another_one_is_not_matched(root, tmp_path):
    how = {"settings": root / "usual.toml", "controllers": "pid"}
    for name, value in (("one", 0.2), ("two", 0.3)):
        track(**how, disturb=f"friction_coefficient={value}", out=tmp_path / name)
    it = compare_tracked(tmp_path / "one", tmp_path / "two")
    assert it.followed == []
    alone = [note.partition(" alone")[0] for note in it.record.notes if " alone, " in note]
    assert alone == ["In A", "In B"]


def test_another_plant_is_another_task(root, tmp_path):
    shutil.copytree(root / "usual", tmp_path / "usual")
    path = tmp_path / "usual" / "tracking.json"
    content = json.loads(path.read_text())
    content["plant"] = {"file": "<b>.toml", "sha256": "0" * 64}
    path.write_text(json.dumps(content))
    it = compare_tracked(root / "usual", tmp_path / "usual")
    assert any("another one (plant.file, plant.sha256)" in note for note in it.record.notes)
    page = tracked_page(it)
    assert "&lt;b&gt;.toml" in page
    assert "<b>" not in page


def test_everything_that_is_printed_is_in_the_json_whose_keys_are_documented(it):
    content = it.record
    assert set(content.content()) <= documented("compare.json")
    printed = {title: rows for title, _, rows in tables(content)}
    assert len(printed["scores"]) == len(content.scores) == 4
    assert len(printed["what differs in the call"]) == len(content.settings)
    assert content.scores[0].score == "rmse_N"
    assert content.scores[0].a.sd is not None


def test_the_page_is_well_formed_and_shows_both_errors(it):
    outline = Outline(tracked_page(it))
    steps = [b - a for a, b in zip(outline.headings, outline.headings[1:], strict=False)]
    assert max(steps) == 1
    (label,) = (svg["aria-label"] for svg in outline.pictures)
    assert re.search(r"of A and of B\. pid, undisturbed: RMSE [\d.]+ ± [\d.]+ N in A", label)


def test_tracked_runs_are_held_against_tracked_runs_only(root, tmp_path):
    assert are_tracked(root / "usual", root / "weaker")
    assert not are_tracked(tmp_path, tmp_path)
    for pair in ((root / "usual", tmp_path), (tmp_path, root / "usual")):
        with pytest.raises(InputError, match="tracked runs only") as error:
            are_tracked(*pair)
        assert error.value.where == str(tmp_path)


def test_the_same_files_seen_from_elsewhere_are_the_same_settings():
    here, there = (
        {"plant": {"file": "model.toml", "folder": folder, "sha256": "ab"}}
        for folder in ("..", "../..")
    )
    assert tracked._settings(here, there) == []
    assert len(tracked._settings(here, {"plant": {"file": "other.toml"}})) == 2
