"""The ledger of conformance: figures of seatsim beside references, entered by the tests that hold them together.

`pytest --ledger` writes the rows of the tests that use the fixture `conform` to `docs/conformance.csv`. It fails where
a row came, went, or moved by more than a tenth of its tolerance: look at the differences, then commit them.
"""

import csv
import sys
from pathlib import Path

import pytest

import controllers
import seatsim

PRODUCT = tuple(str(Path(package.__file__).parent) for package in (controllers, seatsim))
COLUMNS = ("claim", "reference", "expected", "figure", "tolerance", "test")


@pytest.fixture
def conform(request):
    """Return the check of a figure against its reference, which enters both into the ledger.

    The reference names its kind where it is not in print: recalled, read, derived. A deviation is expected to be 0.
    """
    called = []

    def note_first_call(frame, event, _):
        if frame.f_code.co_filename.startswith(PRODUCT):
            called.append(frame.f_code.co_qualname)
            sys.setprofile(None)

    def check(claim, reference, figure, expected=0.0, *, tolerance):
        assert called, f"{claim}: no function of seatsim was called"
        assert abs(figure - expected) <= tolerance, f"{claim}: {figure} is not {expected} within {tolerance}"
        size = max(abs(figure), abs(expected))
        # Enough to show a twentieth of the tolerance.
        digits = len(f"{size / tolerance:.0f}") + 2 if size > tolerance else 2
        values = f"{expected:.{digits}g}", f"{figure:.{digits}g}", f"{tolerance:.2g}"
        request.node.user_properties.append(("row", (claim, reference, *values, request.node.nodeid.split("[")[0])))

    sys.setprofile(note_first_call)
    yield check
    sys.setprofile(None)


class Ledger:
    """The rows of a session and the file that keeps them."""

    def __init__(self, path):
        self.path, self.rows, self.differences = path, {}, []

    def pytest_sessionstart(self, session):
        """Refuse a choice of tests, by which the rows of all others would go."""
        if session.config.args_source is pytest.Config.ArgsSource.ARGS and not hasattr(session.config, "workerinput"):
            raise pytest.UsageError("--ledger writes the rows of all tests: give it no path")

    def pytest_runtest_logreport(self, report):
        """Take the rows of a test that passed."""
        if report.when == "call" and report.passed:
            for row in (value for name, value in report.user_properties if name == "row"):
                key = row[0], row[1], row[5]
                assert key not in self.rows, f"two rows say the same: {key}"
                self.rows[key] = row

    def pytest_sessionfinish(self, session, exitstatus):
        """Write the rows where all tests passed, and fail where they are not those of the file."""
        if exitstatus or not self.rows or hasattr(session.config, "workerinput"):
            return
        with self.path.open(encoding="utf-8", newline="") as file:
            kept = {(row[0], row[1], row[5]): tuple(row) for row in list(csv.reader(file))[1:]}
        new = [_keep(row, kept.get(key)) for key, row in sorted(self.rows.items(), key=lambda each: each[0][2])]
        old = kept.values()
        self.differences = [f"- {' | '.join(row)}" for row in old if row not in new]
        self.differences += [f"+ {' | '.join(row)}" for row in new if row not in old]
        if self.differences:
            session.exitstatus = pytest.ExitCode.TESTS_FAILED
        with self.path.open("w", encoding="utf-8", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows([COLUMNS, *new])

    def pytest_terminal_summary(self, terminalreporter):
        """Say how many rows there are, and which differ."""
        for line in (f"{len(self.rows)} rows in {self.path}, {len(self.differences)} differences", *self.differences):
            terminalreporter.line(line)


def _keep(row, old):
    """Return the row of the file where the figure is that one but for a tenth of the tolerance, else the new row."""
    if old is None or row[2] != old[2] or row[4] != old[4]:
        return row
    return old if abs(float(row[3]) - float(old[3])) <= 0.1 * float(row[4]) else row
