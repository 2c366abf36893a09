"""What a report of runs says first: for each of some small scenarios the sentences that an expert would write, no more.

Figures may differ by 2 %, the words by nothing.
"""

import re

import pytest

from seatsim.report.runs import report_runs
from seatsim.scenario.loading import load
from seatsim.schema.errors import SeatsimError
from seatsim.simulation.runs import run_many

from .kinds import SEAT, passive

NUMBER = re.compile(r"(?<![\w.])\d+(?:\.\d+)?(?= m/s²| %| mm| times| from|,)")


ZERO, LOW, MIDDLE = passive(0.0), passive(0.1), passive(0.3)
THREE = {"skyhook": {}, "0 A": ZERO, "0.1 A": LOW}
OTHERS = "Check that the order holds on other roads and with other drivers: seatsim sweep varies both."
TRY = "try other settings of its law and other suspension damping."
STOPS = "the suspension meets its end stops."
HIT = f"Look at the travel of “0 A” (4 times) and “0.1 A” (2 times): {STOPS}"
PASSIVE = (
    "“0 A” is the most comfortable: the driver feels 0.960 m/s² (weighted RMS), 8.7 % less than with the next run,"
    " “0.1 A”, at 50 % more travel (RMS)."
)
CASES = {
    "a single run": ({}, [
        "seat: the driver feels 0.781 m/s² (weighted RMS), 40 % less than the floor moves; the suspension travels up to"
        " 38.0 mm from its rest and never meets its end stops.",
        "Compare it with other laws or settings: seatsim compare takes several scenarios or a sweep.",
    ]),
    "a law and passive dampers": ({"variants": THREE}, [
        "Of 3 runs “skyhook” is the most comfortable: the driver feels 0.781 m/s² (weighted RMS), 19 % less than with"
        " the best passive run, “0 A”, at 38 % less travel (RMS).",
        HIT, OTHERS,
    ]),
    "temperatures": ({"temperature": [20.0, 50.0, 80.0]}, [
        "Under 3 conditions the driver feels 0.690 m/s² to 0.781 m/s² (weighted RMS); the worst is “20 °C”, the mildest"
        " “80 °C”.",
    ]),
    "laws on floors": ({"variants": THREE, "sweep": {"excitation.spectral_class": ["EM2", "EM5", "EM6"]}}, [
        "Which run is the most comfortable depends on the condition. At the worst, class EM2, it is"
        " “skyhook”: the driver feels 0.781 m/s² (weighted RMS), 19 % less than with the best passive run, “0 A”, at"
        " 38 % less travel (RMS).",
        "At class EM5 it is “0 A”: the driver feels 0.569 m/s² (weighted RMS); control does not make it less:"
        " with “skyhook” it is 4.3 % more, at 32 % less travel (RMS).",
        "At class EM6 it is “0 A”: the driver feels 0.379 m/s² (weighted RMS); control does not make it less:"
        " with “skyhook” it is 5.8 % more, at 7.0 % less travel (RMS).",
        "Look at the travel of “0 A, class EM2” (4 times) and “0.1 A, class EM2” (2 times):"
        f" {STOPS}",
    ]),
    "a law that is best everywhere": ({"variants": {"skyhook": {}, "0 A": ZERO}, "sweep": {"seed": [0, 1]}}, [
        "“skyhook” is the most comfortable under both conditions. The worst of them is seed 0: the driver feels 0.781"
        " m/s² (weighted RMS), 19 % less than with the best passive run, “0 A”, at 38 % less travel (RMS).",
        f"Look at the travel of “0 A, seed 1” (7 times) and “0 A, seed 0” (4 times): {STOPS}",
        f"The driver feels more than the floor moves in “0 A, seed 1” (SEAT factor 1.46): {TRY}",
    ]),
    "a law that is worse than none": ({"variants": {"skyhook": {"controller.damping": 6e3}, "0.1 A": LOW}}, [
        "Of 2 runs “0.1 A” is the most comfortable: the driver feels 1.05 m/s² (weighted RMS); control does not make it"
        " less: with “skyhook” it is 14 % more, at 36 % less travel (RMS).",
        f"Look at the travel of “0.1 A” (2 times): {STOPS}", OTHERS,
    ]),
    "end stops": ({"variants": {
        f"{share:.0%}": ZERO | {"damper.parameters.c_a": 120.0 * share} for share in (0.2, 0.4, 0.6, 0.8, 1.0)
    }}, [
        "Of 5 runs “100%” is the most comfortable: the driver feels 0.960 m/s² (weighted RMS), 17 % less than with the"
        " next run, “80%”, at 5.5 % less travel (RMS).",
        f"Look at the travel of “20%” (16 times), “40%” (15 times), “60%” (8 times) and 2 others: {STOPS}",
        "The driver feels more than the floor moves in “20%” (SEAT factor 2.08), “40%” (SEAT factor 1.85) and “60%”"
        f" (SEAT factor 1.11): {TRY}",
        OTHERS,
    ]),
    "a run that fails": ({"variants": {"0 A": ZERO, "0.1 A": LOW, "x": ZERO | {"damper.parameters.k0": -1e9}}}, [
        f"Of 2 runs {PASSIVE}",
        "1 of 3 runs failed: seat (x): no solution beyond 0.115 s, where it leaves all bounds or is too stiff (on"
        " average more than 100 parts of a step); check the signs of gains and stiffnesses, and the damper's"
        " parameters.",
        HIT, OTHERS,
    ]),
    "a temperature outside the data": ({"variants": {"0 A": ZERO, "0.1 A": LOW}, "temperature": [-10.0, 20.0]}, [
        f"20 °C: Of 2 runs {PASSIVE}",
        "The figures of “0 A, -10 °C” and “0.1 A, -10 °C” cannot be relied on; the notes say why.",
        f"Look at the travel of “0 A, 20 °C” (4 times) and “0.1 A, 20 °C” (2 times): {STOPS}",
    ]),
    "no passive run": ({"variants": {"soft": {"controller.damping": 500.0}, "hard": {"controller.damping": 2e3}}}, [
        "Of 2 runs “soft” is the most comfortable: the driver feels 0.743 m/s² (weighted RMS), 20 % less than with the"
        " next run, “hard”, at 55 % more travel (RMS); no passive run is there to compare with.",
        OTHERS,
    ]),
}  # fmt: skip


def report(settings):
    """Return the report of a seat with changes, and of its runs that failed."""
    found = [one for _, one in run_many(load(SEAT, settings), lambda _: None)]
    failures = [str(one) for one in found if isinstance(one, SeatsimError)]
    runs = [one for one in found if not isinstance(one, SeatsimError)]
    return report_runs(runs, {}, "seatsim run seat.yaml", "seat", failures)


@pytest.mark.parametrize(("settings", "expected"), CASES.values(), ids=CASES)
def test_a_report_says_what_an_expert_would_and_no_more(settings, expected):
    found = report(settings)
    said = [found.answer, *found.lead, *found.next_steps]
    assert [NUMBER.sub("#", text) for text in said] == [NUMBER.sub("#", text) for text in expected]
    for text, wanted in zip(said, expected, strict=True):
        figures, known = ([float(figure) for figure in NUMBER.findall(each)] for each in (text, wanted))
        assert figures == pytest.approx(known, rel=0.02, abs=0.06)
