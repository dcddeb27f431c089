import numpy as np

from tsas_cli.records.base import PhaseSegment
from tsas_cli.reporting.names import phase_of_samples


def test_each_sample_has_the_phase_of_its_segment_up_to_and_with_its_end():
    time_s = np.arange(6) * 0.1
    segments = [
        PhaseSegment(start_s=time_s[1], end_s=time_s[2], phase="contraction"),
        PhaseSegment(start_s=time_s[3], end_s=time_s[3], phase="loosening"),
        PhaseSegment(start_s=time_s[4], end_s=time_s[4], phase="a word of tomorrow"),
    ]
    expected = ["unknown", "contraction", "contraction", "loosening", "unknown", "unknown"]
    assert phase_of_samples(time_s, segments).tolist() == expected
