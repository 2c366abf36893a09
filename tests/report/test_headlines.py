"""What a report of runs says first: for each of some small scenarios the sentences that an expert would write, no more.

Figures may differ by 2 %, the words by nothing.
"""

import re

import pytest

from seatsim.report.runs import report_runs
from seatsim.scenario.loading import load
from seatsim.schema.errors import SeatsimError
from seatsim.simulation.runs import run_many

from ..text import beside, parse
from .kinds import SEAT

NUMBER = re.compile(r"(?<![\w.])\d+(?:\.\d+)?(?= m/s²| %| mm| times| from|,)")
CASES = parse(beside(__file__, "headlines.yaml"))


def report(settings):
    """Return the report of a seat with changes, and of its runs that failed."""
    found = [one for _, one in run_many(load(SEAT, settings), lambda _: None)]
    failures = [str(one) for one in found if isinstance(one, SeatsimError)]
    runs = [one for one in found if not isinstance(one, SeatsimError)]
    return report_runs(runs, {}, "seatsim run seat.yaml", "seat", failures)


@pytest.mark.parametrize("name", CASES)
def test_a_report_says_what_an_expert_would_and_no_more(name):
    expected, found = CASES[name]["said"], report(CASES[name]["settings"])
    said = [found.answer, *found.lead, *found.next_steps]
    assert [NUMBER.sub("#", text) for text in said] == [NUMBER.sub("#", text) for text in expected]
    for text, wanted in zip(said, expected, strict=True):
        figures, known = ([float(figure) for figure in NUMBER.findall(each)] for each in (text, wanted))
        assert figures == pytest.approx(known, rel=0.02, abs=0.06)
