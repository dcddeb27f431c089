"""What cannot be judged without a channel is said once, with the runs that lack it."""

from tests.counted import Counted
from tsas_cli.stages.calibrate import calibrate
from tsas_cli.stages.check import unrecorded

ALL = ("time_s", "x_in_mm", "x_out_mm", "f_in_N", "f_out_N")


def said(*runs):
    return list(unrecorded(runs))


def test_nothing_is_missing():
    assert said(ALL, ALL) == []


def test_a_missing_channel_and_one_that_some_runs_lack():
    proximal, distal = said(ALL[:3] + ALL[4:], ALL[:3])
    assert proximal.startswith("f_in is not recorded: without it, the level of friction rests on")
    assert distal.startswith("f_out is not recorded in 1 of 2 runs: without it, the tension at")


def test_a_stage_says_it_before_it_is_done(dataset):
    class Heard(Counted):
        said = ()

        def say(self, sentence):
            self.said += ((sentence, self.done),)

    heard = Heard()
    calibrate(dataset, step=heard)
    assert any(
        s.startswith("f_out is not recorded") and done < heard.done for s, done in heard.said
    )
