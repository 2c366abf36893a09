"""What a notebook shows: tables and pictures of results, gaps, identifications and diagnoses."""

import html

import pytest
from matplotlib.figure import Figure

import seatsim
from seatsim.recordings.gap import Gap, GapFigures

from ..report.diagnoses import CASES
from ..report.kinds import gap, pair

GAP = Gap(0.2, {"damper_force": 0.2, "<b>": 0.1}, GapFigures(0.0, {"damper_force": 0.01, "<b>": 0.0}))


def test_a_gap_is_a_table_and_a_picture():
    shown = "".join(GAP._repr_html_().split())
    assert "<th>channels.damper_force</th><td>0.2</td>" in shown
    assert "<th>floor.overall</th><td>notstated</td>" in shown
    assert "<b>" not in GAP._repr_html_()
    pictures = seatsim.plot(gap(0.3, a=pair(5.0)))
    assert isinstance(pictures["signal_damper_force"], Figure)
    assert pictures._repr_html_().startswith('<img alt="signal_damper_force" src="data:image/png;base64,')


@pytest.mark.parametrize("case", CASES)
def test_a_diagnosis_is_its_sentence_and_pictures(case):
    diagnosis = CASES[case]()
    assert f"<td>{html.escape(diagnosis.sentence, quote=False)}</td>" in diagnosis._repr_html_()
    assert all(effect in diagnosis._repr_html_() for effect in diagnosis.selected)
    *_, last = seatsim.plot(diagnosis)
    assert list(seatsim.plot(diagnosis, last)) == [last]


def test_a_result_is_its_table_and_pictures(seat_file):
    result = seatsim.run(seat_file, {"excitation.duration": 2.0})
    assert "seat_factor" in result._repr_html_()
    assert list(seatsim.plot(result, "psd", "force_velocity")) == ["psd", "force_velocity"]
    with pytest.raises(seatsim.InputError, match=r"no picture is called 'pds' \(did you mean 'psd'\?\)"):
        seatsim.plot(result, "pds")
    with pytest.raises(seatsim.InputError, match="nothing is drawn of a str"):
        seatsim.plot("em6")
