"""The report of a diagnosis: the answer first, then every section with content; safe, small, the same twice."""

import re
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import cache
from html.parser import HTMLParser

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.text import Text
from seatsim.report.html import Html, join, make_list, make_table, tag

from seatsim.diagnosis.result import (
    Cause,
    Collinearity,
    ComfortFigure,
    Diagnosis,
    DiscrepancySignal,
    Estimate,
    Evidence,
    GapFigures,
    Gaps,
    ProposedExperiment,
    Share,
    Trace,
)
from seatsim.plots.diagnosis import answer as diagnosis_answer
from seatsim.plots.diagnosis import collinearity as diagnosis_collinearity
from seatsim.plots.diagnosis import discrepancy as diagnosis_discrepancy
from seatsim.plots.diagnosis import maps as diagnosis_maps
from seatsim.plots.diagnosis import signals as diagnosis_signals  # fmt: skip
from seatsim.plots.diagnosis.answer import read_gap, select_stages
from seatsim.plots.diagnosis.bins import FEWEST, bin_rms, drop_start, find_window, find_worst
from seatsim.report import write_report
from seatsim.report.formatting import (
    describe_effect,
    format_estimate,
    format_percent,
    format_sentence,
    format_value,
)
from seatsim.schema.text import join_names

RATE = 500.0
SEAT = {
    "damper_force": ("N", 2.5), "frame_acceleration": ("m/s^2", 0.03), "driver_acceleration": ("m/s^2", 0.015),
    "suspension_displacement": ("m", 5e-5), "coil_current": ("A", 0.003),
}  # fmt: skip
EFFECTS = [
    "damper.remanence", "damper.magnetic_saturation", "damper.seal_friction", "suspension.friction", "coil.lag",
    "damper.thermal_fade", "suspension.progressive_spring", "cushion.hardening", "driver.mass", "sensor.gain",
    "sensor.clock_skew", "damper.free_play",
]  # fmt: skip
PARAMETERS = {
    "damper.remanence": {"width": Estimate(0.0812, 0.0041, "A"), "lift": Estimate(0.4, 0.05, "-")},
    "damper.seal_friction": {"force": Estimate(44.7, 1.3, "N")},
    "suspension.friction": {"force": Estimate(45.2, 1.2, "N")},
    "sensor.gain": {"channel": "driver_acceleration", "gain": Estimate(1.02, 0.01, "-")},
}


def narrow(rng, n, low, high):
    """Return noise within a band, of unit RMS."""
    spectrum = np.fft.rfft(rng.standard_normal(n))
    frequency = np.fft.rfftfreq(n, 1 / RATE)
    values = np.fft.irfft(spectrum * ((frequency > low) & (frequency < high)), n)
    return values / np.std(values)


@cache
def rig(seconds=24.0, bench=False):
    """Return motion and signals of a made-up rig, and what its simulation lacks: more force after current drops."""
    rng, n = np.random.default_rng(4), round(seconds * RATE)
    x = 0.012 * narrow(rng, n, 0.7, 3.0)
    v = np.gradient(x, 1 / RATE)
    current = np.clip(0.4 + 0.3 * narrow(rng, n, 0.3, 4.0), 0, 1)
    lacks = 70 * np.tanh(v / 0.02) * (np.gradient(current) < 0) * current
    force = 300 * v + (60 + 600 * current) * np.tanh(v / 0.03) + lacks
    shaking = 1.2 * narrow(rng, n, 1.0, 12.0)
    true = {
        "damper_force": force, "frame_acceleration": shaking - lacks / 20, "driver_acceleration": 0.5 * shaking,
        "suspension_displacement": x, "coil_current": current,
    }  # fmt: skip
    part = {"damper_force": 1.0, "frame_acceleration": -0.05, "driver_acceleration": 0.006,
            "suspension_displacement": 3e-6, "coil_current": 2e-5}  # fmt: skip
    motion = {"velocity": v, "displacement": x, "coil_current": current}
    motion |= {} if bench else {"damper_temperature": 20 + 15 * np.linspace(0, 1, n)}
    return motion, true, {name: factor * lacks for name, factor in part.items()}


def traces(channels, after=0.1, gap=1.0, runs=("run-c",), bench=False):
    _, true, lacks = rig(bench=bench)
    rng, found = np.random.default_rng(5), []
    for run in runs:
        for name in channels:
            unit, noise = SEAT[name]
            measured = true[name] + noise * rng.standard_normal(len(true[name]))
            nominal, better = (true[name] - part * lacks[name] for part in (gap, after * gap))
            rows = np.arange(len(measured)) / RATE
            found.append(Trace(run, name, unit, noise, rows, measured, nominal, nominal, better))
    return found


def gaps_of(found):
    def pooled(courses):
        channels = {t.channel: float(np.sqrt(np.mean(course**2)) / np.std(t.measured)) for t, course in courses}
        return GapFigures(float(np.sqrt(np.mean(np.square(list(channels.values()))))), channels)

    before = pooled([(t, t.measured - t.nominal) for t in found])
    after = pooled([(t, t.measured - t.after) for t in found])
    floor = pooled([(t, np.full(9, t.noise_rms)) for t in found])
    calibrated = GapFigures(0.97 * before.overall, {k: 0.97 * g for k, g in before.channels.items()})
    shrink = 1 - after.overall / before.overall
    return Gaps(before, calibrated, after, floor, shrink, (shrink - 0.04, shrink + 0.03))


def alike():
    matrix = np.abs(np.random.default_rng(3).normal(0, 0.2, (len(EFFECTS), len(EFFECTS))))
    matrix = np.clip((matrix + matrix.T) / 2, 0, 1)
    matrix[2, 3] = matrix[3, 2] = 0.99
    np.fill_diagonal(matrix, 1)
    return Collinearity(EFFECTS, matrix)


def ranked(first):
    """Return all effects, the given ones first with their probabilities, the others ever less probable."""
    rest = [name for name in EFFECTS if name not in first]
    likely = {**first, **{name: 0.04 / (k + 1) for k, name in enumerate(rest)}}
    return [Cause(name, p, 0.87 * p if p > 0.1 else 0.02, PARAMETERS.get(name, {})) for name, p in likely.items()]


def known(channels=tuple(SEAT), bench=False, runs=("run-c",)):
    found = traces(channels, bench=bench, runs=runs)
    comfort = [("RMS driver acceleration", "m/s^2", 0.61, 0.72, 0.615), ("RMS displacement", "m", 0.012, 0.0108, 0.012)]
    return Diagnosis(
        name="field-07", verdict="known",
        sentence="the yield force remembers past current (damper.remanence, 0.08 A): it explains 87 % of the gap",
        where=[Share("damper", 0.93), Share("coil", 0.04), Share("sensor", 0.03)],
        causes=ranked({"damper.remanence": 0.97}), probability_none=0.0, probability_unknown=0.02,
        selected=["damper.remanence"], stochastic="", indistinguishable=[], experiment=None, held_out=list(runs),
        isolable=[["damper"], ["coil"], ["suspension", "floor"], ["cushion"], ["driver", "sensor"]],
        gap=gaps_of(found), notes=["no run is warmer than 35 degC: thermal fade cannot be assessed"],
        augmented={},
        evidence=Evidence(found, rig(bench=bench)[0], None, alike(), [] if bench else comfort),
    )  # fmt: skip


def ambiguous():
    first = {"suspension.friction": 0.55, "damper.seal_friction": 0.45}
    reason = "at zero current the damper's own force is small, so that a load cell sees the friction of the seal alone"
    return replace(
        known(("frame_acceleration", "driver_acceleration", "suspension_displacement")), verdict="ambiguous",
        sentence="friction of 45 N in the linkage or at the damper's seal explains 83 % of the gap; without a load"
        " cell they cannot be distinguished",
        where=[Share("suspension", 0.5), Share("damper", 0.5)], causes=ranked(first),
        selected=["suspension.friction"], indistinguishable=[list(first)],
        experiment=ProposedExperiment("intervention", "add_load_cell", reason, 0.9876, 0.3456),
    )  # fmt: skip


def unknown(channels=tuple(SEAT)):
    motion, _, lacks = rig()
    rows = np.arange(len(motion["velocity"])) / RATE
    force = lacks["damper_force"] + 3 * np.random.default_rng(6).standard_normal(len(rows))
    words = ["It follows the sign of the velocity.", "It is there only while the current falls."]
    discrepancy = DiscrepancySignal("damper", "force", "N", rows, force, words)
    base = known(channels)
    found = [replace(trace, after=trace.calibrated) for trace in base.evidence.traces]
    return replace(
        base, verdict="unknown", sentence="a force of 70 N in the damper stays that no effect of the library explains",
        causes=ranked({"damper.magnetic_saturation": 0.3}), probability_unknown=0.94, selected=[],
        gap=gaps_of(found), evidence=replace(base.evidence, traces=found, discrepancy=discrepancy),
    )  # fmt: skip


def none():
    base = known()
    found = traces(tuple(SEAT), gap=0.0)
    return replace(
        base, verdict="none", sentence="there is no gap beyond noise and the tolerance of the parameters", where=[],
        causes=ranked({}), probability_none=0.98, probability_unknown=0.01, selected=[], gap=gaps_of(found),
        evidence=replace(base.evidence, traces=found),
    )  # fmt: skip


def bench():
    return replace(known(("damper_force", "coil_current"), bench=True), isolable=[["damper"], ["coil", "sensor"]])


CASES = {
    "none": none,
    "known": known,
    "ambiguous": ambiguous,
    "unknown": lambda: unknown(("damper_force",)),
    "bench": bench,
}
SHORT = ["gaps", "comfort", "notes"]
SHOWN = {
    "none": SHORT,
    "known": ["gaps", "causes", "confusions", "signals", "maps", "spectra", "comfort", "notes", "use"],
    "ambiguous": ["gaps", "causes", "confusions", "signals", "maps", "spectra", "comfort", "notes", "use"],
    "unknown": ["gaps", "causes", "missing", "confusions", "signals", "maps", "spectra", "comfort", "notes", "use"],
    "bench": ["gaps", "causes", "confusions", "signals", "maps", "spectra", "notes", "use"],
}
BADGES = {
    "none": "No material gap", "known": "Cause known", "ambiguous": "Ambiguous", "unknown": "Cause unknown",
    "bench": "Cause known",
}  # fmt: skip


class Outline(HTMLParser):
    """Text, headings, anchors and references of a page; every element has to be closed in its turn."""

    def __init__(self, text):
        super().__init__()
        self.open, self.anchors, self.references, self.headings, self.words = [], [], [], [], []
        self.feed(text)
        assert not self.open

    def handle_starttag(self, tag, attrs):
        given = dict(attrs)
        if tag not in ("img", "meta", "br"):
            self.open.append(tag)
        if tag == "section":
            self.anchors.append(given["id"])
        if tag == "img":
            assert given["alt"] and int(given["width"]) > 400
        self.references += [given[key] for key in ("src", "href") if key in given]
        assert tag not in ("script", "link", "iframe") and not any(key.startswith("on") for key in given)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open and self.open[-1] in ("h1", "h2", "h3"):
            self.headings.append(data)
        if "style" not in self.open:
            self.words.append(data)


@pytest.fixture
def drawn(monkeypatch):
    """Leave out the drawing of pictures, which takes most of the time; the pages are complete otherwise."""
    figures = []
    monkeypatch.setattr("seatsim.report.html.render_png", lambda figure: figures.append(figure) or b"picture")
    return figures


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    """Diagnosis and page of each case, without drawn pictures."""
    folder, found = tmp_path_factory.mktemp("pages"), {}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("seatsim.report.html.render_png", lambda figure: b"picture")
        for case, make in CASES.items():
            diagnosis = make()
            found[case] = diagnosis, write_report(diagnosis, folder / f"{case}.html").read_text(encoding="utf-8")
    return found


@pytest.mark.parametrize("case", CASES)
def test_the_answer_comes_first_and_empty_sections_vanish(case, pages):
    diagnosis, text = pages[case]
    outline = Outline(text)
    assert outline.headings[0] == format_sentence(diagnosis.sentence)
    assert text.index("<h1>") < text.index("<section") and text.index("badge") < text.index("<h1>")
    assert f" {BADGES[case]}" in outline.words
    assert outline.anchors == SHOWN[case]
    # No network is needed.
    assert all(reference.startswith(("data:image/png;base64,", "#")) for reference in outline.references)
    assert "http" not in text and "url(" not in text and "@import" not in text


def test_the_table_has_the_gaps_of_each_channel(pages):
    diagnosis, text = pages["known"]
    rows = re.findall(r"<tr[^>]*><th scope=.row.>([^<]*)</th>(.*?)</tr>", text)
    cells = {name: re.findall(r"<td[^>]*>([^<]*)</td>", row) for name, row in rows}
    gap = diagnosis.gap
    stages = [gap.before, gap.calibrated, gap.after, gap.floor]
    assert cells["overall"] == [*(format_percent(stage.overall) for stage in stages), format_percent(gap.shrink)]
    force = [stage.channels["damper_force"] for stage in stages]
    assert cells["damper force"] == [*map(format_percent, force), format_percent(1 - force[2] / force[0])]


def test_hostile_names_are_text(drawn, tmp_path):
    bad = "<script>alert('x')</script>$a$ & \"b\""
    found = known(("damper_force",))
    traces = [replace(trace, run=bad, channel=bad, unit=bad) for trace in found.evidence.traces]
    found = replace(
        found, name=bad, sentence=bad, notes=[bad], held_out=[bad], selected=[bad], isolable=[[bad]],
        where=[Share(bad, 1.0)], causes=[Cause(bad, 0.9, 0.8, {bad: Estimate(1.0, 0.1, bad), "in": bad})],
        indistinguishable=[[bad, "coil.lag"]], experiment=ProposedExperiment("none", bad, bad, 1.0, 1.0),
        evidence=replace(
            found.evidence, traces=traces, comfort=[ComfortFigure(bad, bad, 1.0, 1.0, 1.0)],
            collinearity=Collinearity([bad, "b"], np.eye(2)),
        ),
    )  # fmt: skip
    outline = Outline(write_report(found, tmp_path / "report.html").read_text(encoding="utf-8"))
    assert any("<script>" in words for words in outline.words)
    for figure in drawn:
        FigureCanvasAgg(figure).draw()


def test_little_is_known(drawn, tmp_path):
    """No traces, no motion, no gaps by channel, numbers that are none: what is left is printed."""
    found = known()
    nothing = Evidence([], {}, None, Collinearity([], np.zeros((0, 0))), [])
    figures = [GapFigures(size, {}) for size in (0.3, 0.29, 0.1, np.nan)]
    gap = Gaps(*figures, np.nan, (np.nan, np.nan))
    found = replace(found, evidence=nothing, gap=gap, notes=[], held_out=[], isolable=[], where=[], selected=[])
    outline = Outline(write_report(found, tmp_path / "report.html").read_text(encoding="utf-8"))
    assert outline.anchors == ["gaps", "causes", "use"]
    assert "–" in outline.words and not any("nan" in words for words in outline.words)


def test_short_runs_and_motion_that_stands_still(drawn, tmp_path):
    found = known(("damper_force", "coil_current"))
    cut = slice(0, 560)
    names = ("time", "measured", "nominal", "calibrated", "after")
    traces = [replace(t, **{name: getattr(t, name)[cut] for name in names}) for t in found.evidence.traces]
    motion = {"velocity": np.zeros(560), "coil_current": np.zeros(560)}
    found = replace(found, evidence=replace(found.evidence, traces=traces, motion=motion))
    outline = Outline(write_report(found, tmp_path / "report.html").read_text(encoding="utf-8"))
    assert "signals" in outline.anchors


def test_a_group_names_both_blocks_and_what_would_decide(pages):
    outline = Outline(pages["ambiguous"][1])
    assert "The gap lies in the suspension or the damper" in outline.headings
    assert "suspension.friction 55 % or damper.seal_friction 45 %" in outline.headings
    assert "Add load cell." in outline.words and "0.3456" in outline.words
    assert any("cannot distinguish suspension.friction and damper.seal_friction" in words for words in outline.words)


def test_the_nominal_simulation_is_not_called_one_with_effects(pages):
    outline = Outline(pages["unknown"][1])
    assert not any("with effect" in words for words in outline.words)


def test_a_whole_page_is_small_quick_and_the_same_from_any_thread(tmp_path):
    diagnosis = known(("damper_force",), bench=True)
    diagnosis = replace(diagnosis, evidence=replace(diagnosis.evidence, motion={"coil_current": np.zeros(9)}))
    begin = time.process_time()
    with ThreadPoolExecutor(2) as pool:
        first, second = pool.map(lambda k: write_report(diagnosis, tmp_path / f"{k}.html").read_bytes(), (1, 2))
    assert time.process_time() - begin < 2 * 5.0
    assert first == second and len(first) < 1e6


@pytest.fixture(scope="module")
def pictures():
    diagnosis = replace(unknown(("damper_force",)), selected=["damper.magnetic_saturation"])
    found = [
        diagnosis_answer.plot_gaps(diagnosis),
        diagnosis_answer.plot_location(diagnosis),
        diagnosis_answer.plot_ranking(diagnosis),
    ]
    found += [diagnosis_collinearity.plot_collinearity(diagnosis), *diagnosis_discrepancy.plot_discrepancy(diagnosis)]
    found += [*diagnosis_signals.plot_signals(diagnosis), *diagnosis_signals.plot_spectra(diagnosis)]
    found += diagnosis_maps.plot_maps(diagnosis)
    for picture in found:
        FigureCanvasAgg(picture.figure).draw()
    return found


def test_texts_are_legible_and_inside_the_picture(pictures):
    for picture in pictures:
        width, height = picture.figure.canvas.get_width_height()
        assert min(text.get_fontsize() for text in picture.figure.findobj(Text)) >= 9
        for part in [*picture.figure.axes, *picture.figure.legends]:
            box = part.get_tightbbox()
            assert box.x0 >= 0 and box.x1 <= width and box.y0 >= 0 and box.y1 <= height, (picture.title, part, box)


def test_every_scale_has_a_unit_and_lines_have_a_legend(pictures):
    for picture in pictures:
        if picture.title.startswith("Most collinear"):
            continue
        panels = picture.figure.axes
        assert any(axes.get_xlabel().endswith("]") for axes in panels)
        for axes in panels:
            numbered = any(
                re.search(r"\d", label.get_text()) for label in axes.get_yticklabels() if label.get_visible()
            )
            assert not numbered or axes.get_ylabel().endswith("]"), picture.title
        if len(panels[0].lines) > 2 and "Missing" not in picture.title:
            assert picture.figure.legends, picture.title


def test_a_window_holds_the_burst():
    rows = np.arange(10_000) / RATE
    values = np.where((rows > 12.4) & (rows < 13.9), 1.0, 0.01)
    window = find_window(rows, values, 2.0)
    assert window.start <= 12.4 and window.end >= 13.9 and window.end - window.start == pytest.approx(2.0)
    assert tuple(find_window(rows[:50], values[:50], 2.0)) == (0.0, pytest.approx(0.098))


def test_bins_of_few_samples_stay_empty():
    x = np.concatenate([np.full(FEWEST, 0.5), np.full(FEWEST - 1, 1.5)])
    level = bin_rms(x, np.full(len(x), -3.0), np.array([0.0, 1.0, 2.0]))
    assert level[0] == 3.0 and np.isnan(level[1])


def test_the_first_second_is_left_out_and_the_worst_channel_is_mapped():
    diagnosis = known()
    trace, motion = find_worst(diagnosis)
    assert trace.channel == "frame_acceleration" and trace.time[0] == 1.0
    assert len(motion["velocity"]) == len(trace.time) == len(drop_start(diagnosis.evidence.traces[0]).time)
    assert len(drop_start(trace).time) == len(trace.time)


def test_a_white_residual_of_the_noise_is_one_in_every_band():
    rng = np.random.default_rng(0)
    rows, noise = np.arange(30_000) / RATE, 0.2
    clean = np.sin(rows)
    measured = clean + noise * rng.standard_normal(len(rows))
    trace = Trace("run-a", "damper_force", "N", noise, rows, measured, clean, clean, clean)
    base = known()
    diagnosis = replace(base, evidence=replace(base.evidence, traces=[trace], motion={}))
    picture = next(p for p in diagnosis_maps.plot_maps(diagnosis) if p.title.startswith("Over frequency"))
    level = picture.figure.axes[0].lines[0].get_ydata()
    np.testing.assert_allclose(level, 1.0, atol=0.25)
    assert level[-1] == pytest.approx(1.0, abs=0.03)


def test_numbers_as_they_are_printed():
    assert [format_percent(value) for value in (0.314, 0.0314, 0.0, None, np.nan)] == ["31 %", "3.1 %", "0 %", "–", "–"]
    assert format_estimate(Estimate(0.08124, 0.0041, "A")) == "0.0812 ± 0.0041 A"
    assert format_estimate(Estimate(4512.3, 130.0, "N s/m")) == "4512 ± 130 N·s/m"
    assert format_estimate(Estimate(1.5, np.inf, "-")) == "1.5"
    assert format_estimate("driver_acceleration") == "driver_acceleration"
    assert format_sentence("no run is warmer than 35 degC") == "No run is warmer than 35 °C."
    assert format_sentence("damper.remanence is at work.") == "damper.remanence is at work."
    assert tag("p", "a < b", class_="x", title="") == '<p class="x">a &lt; b</p>'


def test_text_is_escaped_and_markup_is_not():
    assert join(["a < b", Html("<b>c</b>")], " & ") == "a &lt; b &amp; <b>c</b>"
    assert make_list([]) == "" and make_list(["<"]) == "<ul><li>&lt;</li></ul>"
    assert tag("img", alt='"', aria_label="x") == '<img alt="&quot;" aria-label="x">'


def test_a_table_tells_words_from_numbers_and_marks_rows():
    text = make_table(["name", "value"], [["a", "1"], ["b", "2"]], words=1, strong=[1])
    assert text.count('<td class="number">') == 2 and text.count('<th scope="row">') == 2
    assert '<tr class="strong"><th scope="row">b</th>' in text and '<tr><th scope="row">a</th>' in text


def test_words_as_they_are_printed():
    assert join_names(["a"]) == "a" and join_names(["a", "b", "c"], "or") == "a, b or c"
    assert [format_value(value) for value in ("x", 12.3456, ["a", "b"], {"c": 1}, True)] == [
        "x", "12.35", "a, b", '{"c": 1}', "true",
    ]  # fmt: skip
    assert describe_effect("no.such_effect") == ""
    assert describe_effect("suspension.friction") and "`" not in describe_effect("suspension.friction")


def test_the_gap_of_a_stage_is_read_by_channel():
    gaps = known().gap
    assert read_gap(gaps, "after", "overall") == gaps.after.overall
    assert read_gap(gaps, "before", "damper_force") == gaps.before.channels["damper_force"]
    assert read_gap(gaps, "floor", "no_such_channel") is None
    assert [stage.key for stage in select_stages(known())] == ["floor", "before", "calibrated", "after"]
    assert [stage.key for stage in select_stages(none())] == ["floor", "before", "calibrated"]
