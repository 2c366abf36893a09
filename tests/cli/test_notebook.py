"""What a notebook shows: tables and pictures of results, gaps, identifications and diagnoses."""

import html

import pytest
from matplotlib.figure import Figure

import seatsim
from seatsim.recordings.gap import Gap, GapFigures

from ..report.diagnoses import CASES

GAP = Gap(0.2, {"damper_force": 0.2, "<b>": 0.1}, GapFigures(0.0, {"damper_force": 0.01, "<b>": 0.0}))


def test_a_gap_is_a_table_and_a_picture():
    shown = GAP._repr_html_()
    assert "<td>channels.damper_force</td><td>0.2</td>" in shown
    assert "<td>floor.overall</td><td>not stated</td>" in shown
    assert "<b>" not in GAP._repr_html_()
    pictures = seatsim.plot(GAP)
    assert isinstance(pictures["gap"], Figure)
    assert pictures._repr_html_().startswith('<img alt="gap" src="data:image/png;base64,')


@pytest.mark.parametrize("case", CASES)
def test_a_diagnosis_is_its_sentence_and_pictures(case):
    diagnosis = CASES[case]()
    assert f"<td>{html.escape(diagnosis.sentence)}</td>" in diagnosis._repr_html_()
    assert all(effect in diagnosis._repr_html_() for effect in diagnosis.selected)
    assert list(seatsim.plot(diagnosis, "gaps")) == ["gaps"]


def test_a_result_is_its_table_and_pictures(seat_file):
    result = seatsim.run(seat_file, {"excitation.duration": 2.0})
    assert "seat_factor" in result._repr_html_()
    assert list(seatsim.plot(result, "psd", "damper_loops")) == ["psd", "damper_loops"]
    with pytest.raises(seatsim.InputError, match=r"no picture is called 'pds' \(did you mean 'psd'\?\)"):
        seatsim.plot(result, "pds")
    with pytest.raises(seatsim.InputError, match="nothing is drawn of a str"):
        seatsim.plot("em6")
