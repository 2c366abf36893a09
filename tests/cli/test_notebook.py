"""What a notebook shows: tables and pictures of results, gaps, identifications and diagnoses."""

import html

import pytest
from matplotlib.figure import Figure

import seatsim
from seatsim.recordings.gap import Gap, NoiseFloor

from ..report.diagnoses import CASES

GAP = Gap(0.2, {"damper_force": 0.2, "<b>": 0.1}, NoiseFloor(overall=0.0, channels={"damper_force": 0.01, "<b>": 0.0}))


def test_a_gap_is_a_table_and_a_picture():
    assert "<td>damper_force</td><td>0.2</td><td>0.01</td>" in GAP._repr_html_()
    assert "<b>" not in GAP._repr_html_()
    pictures = GAP.plot()
    assert isinstance(pictures["gap"], Figure)
    assert pictures._repr_html_().startswith('<img alt="gap" src="data:image/png;base64,')


@pytest.mark.parametrize("case", CASES)
def test_a_diagnosis_is_its_sentence_and_pictures(case):
    diagnosis = CASES[case]()
    assert f"<p>{html.escape(diagnosis.sentence)}</p>" in diagnosis._repr_html_()
    assert all(effect in diagnosis._repr_html_() for effect in diagnosis.selected)
    assert list(diagnosis.plot("gaps")) == ["gaps"]


def test_a_result_is_its_table_and_pictures(seat_file):
    result = seatsim.run(seat_file, {"excitation.duration": 2.0})
    assert "seat_factor" in result._repr_html_()
    assert list(result.plot("psd", "damper_loops")) == ["psd", "damper_loops"]
    with pytest.raises(seatsim.InputError, match=r"no picture is called 'pds' \(did you mean 'psd'\?\)"):
        result.plot("pds")
