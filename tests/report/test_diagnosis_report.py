"""The report of a diagnosis: the answer first, then every section with content; safe, small, the same twice."""

import re
from dataclasses import replace

import numpy as np
import pytest

from seatsim.diagnosis import result
from seatsim.diagnosis.result import Cause, Estimate, GapFigures
from seatsim.report.diagnosis import report_diagnosis, say_action, say_cause
from seatsim.report.formatting import format_sentence, read_words
from seatsim.report.rendering import render_report
from seatsim.schema.printing import format_percent
from seatsim.schema.registry import names

from ..text import words
from .diagnoses import CASES, known, with_every_run
from .kinds import render
from .outline import Outline

SHORT = ["gaps", "signals", "comfort", "notes", "method"]
FULL = ["causes", "gaps", "signals", "confusions", "maps", "comfort", "notes", "method"]
SHOWN = {
    "none": SHORT, "known": FULL, "ambiguous": FULL, "bench": [name for name in FULL if name != "comfort"],
    "unknown": words("causes gaps signals missing confusions maps comfort notes method"),
}  # fmt: skip
ANSWERS = {
    "none": "The simulation fits the recording",
    "known": "The damper remembers past current (0.0812 A stays behind). That explains ",
    "ambiguous": "Either the linkage of the suspension rubs with 45.2 N, or it is damper.seal_friction",
    "unknown": "Something that no known effect explains makes the gap of ",
    "bench": "The damper remembers past current",
}
OTHERS = {case: make for case, make in CASES.items() if case != "known"}


@pytest.fixture(scope="module")
def pages():
    """Diagnosis and page of each case."""
    found = {case: (diagnosis := make(), render_report(report_diagnosis(diagnosis))) for case, make in OTHERS.items()}
    return found | {"known": (with_every_run(), render("diagnosis"))}


@pytest.mark.parametrize("case", CASES)
def test_a_page_asks_for_nothing_and_begins_with_the_answer(case, pages):
    diagnosis, text = pages[case]
    outline = Outline(text)
    assert len(text.encode()) < 700_000
    assert "default-src &#39;none&#39;" in text and "connect-src" not in text
    assert all(reference.startswith(("#", "data:image/svg+xml,")) for reference in outline.references)
    assert outline.headings[0].startswith(ANSWERS[case])
    assert text.index("<h1>") < text.index("What to do next") < text.index("<section")
    assert outline.anchors == SHOWN[case]
    assert format_sentence(diagnosis.sentence) in outline.words


def test_the_table_has_the_gaps_of_each_channel(pages):
    diagnosis, text = pages["known"]
    cells = Outline(text).rows("Gaps on run-c")
    gap = diagnosis.gap
    stages = [gap.before, gap.calibrated, gap.after, gap.floor]
    assert cells["overall"] == [*(format_percent(stage.overall) for stage in stages), format_percent(gap.shrink)]
    force = [stage.channels["damper_force"] for stage in stages]
    assert cells["damper force"] == [*map(format_percent, force), format_percent(1 - force[2] / force[0])]


def test_what_no_effect_explains_stands_beside_the_causes(pages):
    cells = Outline(pages["unknown"][1]).rows("The likely effects")
    assert cells["another cause"][2] == "94 %" and cells["no effect at all"][2] == "0 %"
    assert [name for name in cells if name.endswith("other effects")] and "damper.magnetic_saturation" in cells


def test_refitted_parameters_stand_between_their_bounds_and_are_flagged_there(pages):
    cells = Outline(pages["known"][1]).rows("Parameters refitted")
    assert cells["plant.suspension_damping (at its bound)"] == ["N·s/m", "150", "147.0", "147 to 153"]
    assert cells["plant.frame_mass"] == ["kg", "20", "20.20", "19.6 to 20.4"]


def test_every_run_is_drawn_and_the_held_out_one_is_named(pages):
    blocks = [block for section in report_diagnosis(pages["known"][0]).sections for block in section.blocks]
    block = next(each for each in blocks if type(each).__name__ == "Signals" and each.identity == "signals-time")
    assert list(block.runs) == ["run-c (held out)", "run-a", "run-b"]
    assert len(block.data["panels"]) == 5 and all(len(panel["runs"]) == 3 for panel in block.data["panels"])


def test_hostile_names_are_text():
    bad = "</script><script>alert('x')</script>$a$ & \"b\" {{ 7 * 7 }}"
    found = known(("damper_force",))
    traces = [replace(trace, run=bad, channel=bad, unit=bad) for trace in found.evidence.traces]
    found = replace(
        found, name=bad, sentence=bad, notes=[bad], held_out=[bad], selected=[bad], isolable=[[bad]],
        where=[result.Share(bad, 1.0)], causes=[Cause(bad, 0.9, 0.8, {bad: Estimate(1.0, 0.1, bad), "in": bad})],
        indistinguishable=[[bad, "coil.lag"]], experiment=result.ProposedExperiment("none", bad, bad, 1.0, 1.0),
        evidence=replace(
            found.evidence, traces=traces, comfort=[result.ComfortFigure(bad, bad, 1.0, 1.0, 1.0)],
            collinearity=result.Collinearity([bad, "b"], np.eye(2)),
        ),
    )  # fmt: skip
    text = render_report(report_diagnosis(found))
    assert "<script>alert" not in text and "49" not in text.partition("<nav")[0].partition("<main")[2]
    outline = Outline(text)
    assert any("<script>" in words for words in outline.words)
    # The scripts of the page are its own one and data, which no browser runs.
    assert set(re.findall(r"<script[^>]*>", text)) == {"<script>", '<script type="application/json">'}
    assert text.count("<script>") == 1


def test_little_is_known():
    """No traces, no motion, no gaps by channel, numbers that are none: what is left is printed."""
    found = known()
    nothing = result.Evidence([], {}, None, result.Collinearity([], np.zeros((0, 0))), [])
    gap = result.Gaps(*[GapFigures(size, {}) for size in (0.3, 0.29, 0.1, np.nan)], np.nan, (np.nan, np.nan))
    lists = dict.fromkeys(("notes", "held_out", "isolable", "where", "selected", "parameters"), ())
    found = replace(found, evidence=nothing, gap=gap, **lists)
    outline = Outline(render_report(report_diagnosis(found)))
    assert outline.anchors == ["causes", "gaps", "method"]
    assert "–" in outline.words and not any("nan" in words for words in outline.words)


def test_a_group_names_both_blocks_and_what_would_decide(pages):
    outline = Outline(pages["ambiguous"][1])
    assert outline.rows("The gap lies in the suspension or damper")["damper"] == ["50 %"]
    assert outline.rows("Likeness")["add load cell"] == ["intervention", "0.988", "0.346"]
    assert any("cannot distinguish suspension.friction and damper.seal_friction" in words for words in outline.words)
    assert any("To tell the likely causes apart: add load cell" in text for text in outline.words)


def test_every_effect_is_said_in_plain_words():
    assert set(read_words().effects) == set(names("effect"))
    for shift, side in ((0.0166, "late"), (-0.0166, "early")):
        cause = Cause("sensor.clock_skew", 1.0, 0.9, {"shift": Estimate(shift, 0.0001, "s")})
        assert say_cause(cause) == f"the controller's log is 16.6 ms {side}"
    gain = {"channel": "driver_acceleration", "error": Estimate(0.1, 0.01, "-")}
    assert say_cause(Cause("sensor.gain", 1.0, 0.9, gain)) == "the channel driver acceleration reads with a wrong scale"
    assert all("{" not in say_cause(Cause(name, 1.0, 0.9, {})) and say_action(name) for name in read_words().effects)
    assert say_cause(Cause("own.effect", 1.0, 0.9, {})).startswith("own.effect is at work")
