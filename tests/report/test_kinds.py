"""Reports of runs, comparisons, gaps, identifications, characterisations: the answer, what to do, the figures."""

from dataclasses import replace

import pytest

from seatsim.characterisation.summary import Characterisation
from seatsim.characterisation.tabulate import make_sheet
from seatsim.plots.bench.identification import plot_predictions
from seatsim.report.dampers import report_characterisation, report_identification
from seatsim.report.gap import report_gap, say_gap
from seatsim.report.rendering import render_report
from seatsim.report.runs import report_runs

from .kinds import gap, identification, pair, pictures, render, runs
from .outline import Outline


def test_a_run_says_comfort_and_travel():
    outline = Outline(render_report(report_runs(runs()[:1], pictures(), "seatsim run seat.yaml", "seat")))
    assert "the driver feels" in outline.headings[0] and "m/s² (weighted RMS)" in outline.headings[0]
    assert outline.anchors[:4] == ["figures", "signals", "spectra", "loops"] and outline.anchors[-1] == "method"
    assert outline.rows("Every figure of the run")["RMS suspension travel"][0].endswith(" mm")
    assert "seatsim run seat.yaml" in outline.words
    assert outline.rows("Settings")["plant.driver_mass"] == ["kg", "60"]


def test_a_run_that_cannot_be_relied_on_is_marked_and_never_the_best():
    best = min(runs(), key=lambda run: run.metrics["driver_acceleration_weighted"].value)
    doubted = [replace(run, unverified=("a reason",)) if run is best else run for run in runs()]
    outline = Outline(render_report(report_runs(doubted, {}, "seatsim compare seat.yaml", "seat")))
    name = best.scenario.label["variant"]
    assert f"“{name}” is the most comfortable" not in outline.headings[0]
    assert f"{name} *" in outline.rows("Figures of each run")
    for said in ("* unverified, and never the best", "is unverified: a reason."):
        assert any(said in words for words in outline.words)


def test_a_gap_says_where_it_is_largest_and_what_to_do():
    outline = Outline(render("gap"))
    assert "furthest off in the damper force, by 30 %" in outline.headings[0]
    assert any("seatsim diagnose" in words for words in outline.words) and "A note." in outline.words
    assert outline.rows("Gap of each run")["damper force"][0] == "29 %"
    assert any(heading.startswith("Damper force, RMS difference: ") for heading in outline.headings)
    assert say_gap(gap(0.021)).endswith("there is nothing left to explain.")


def test_an_identification_says_how_well_it_predicts_and_what_the_data_leave_open():
    outline = Outline(render("identification"))
    assert outline.headings[0].startswith("bouc_wen predicts the damper's force well: a fit of 93.2 %")
    assert outline.headings[0].endswith("on records that took no part in the fit.")
    assert any("do not determine k0" in words for words in outline.words)
    assert outline.rows("Fitted values")["k0 (not determined)"] == ["N/m", "3.0000", "59"]


def test_a_characterisation_says_force_and_response():
    outline = Outline(render("characterisation"))
    assert outline.headings[0].startswith("Moved by ±10 mm at 1 Hz, the damper gives up to 450 N at 1 A, 4.5 times its")
    assert outline.headings[0].endswith(" its force at 0 A; it follows a step of the current to 90 % within 18.0 ms.")
    figures = outline.rows("Largest forces")
    assert figures["a"][figures["record"].index("offset [N]")] == "0" and "steps" in outline.anchors
    assert any("three currents" in words for words in outline.words)


@pytest.mark.parametrize("text", ["<img src=x onerror=alert(1)>", "</script><script>alert(1)</script>", "{{ 7*7 }}"])
def test_text_of_files_stays_text_in_every_kind(text):
    hostile = identification(["test"])
    hostile.model, hostile.notes = text, [text]
    hostile.assessments[0] = hostile.assessments[0]._replace(record=hostile.assessments[0].record._replace(name=text))
    empty = Characterisation(text, text, [], [], [text], make_sheet([], []))
    pages = [
        render_report(report_identification(hostile, {"loops": plot_predictions(hostile)}, text)),
        render_report(report_gap(text, gap(0.3, **{text: pair(3.0)}), text)),
        render_report(report_characterisation(empty, {}, text)),
    ]
    for page in pages:
        assert text in " ".join(Outline(page).words) and page.count("<script>") == 1 and "<img src=x" not in page
