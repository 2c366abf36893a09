"""The ledger: what enters a row, and what counts as a difference."""

import pytest

CONFTEST = """
from pathlib import Path
from tests.ledger import Ledger, conform
def pytest_configure(config):
    config.pluginmanager.register(Ledger(Path("kept.csv")))
"""
TEST = """
from seatsim.metrics.weighting import frequency_response
def test_factor(conform):
    conform("Wk at 8 Hz", "ISO 2631-1", abs(frequency_response(8.0)) + {moved}, {expected}, tolerance=0.004)
"""
WITHOUT_PRODUCT = """
def test_factor(conform):
    conform("Wk at 8 Hz", "ISO 2631-1", 1.036, 1.036, tolerance=0.004)
"""


@pytest.fixture
def write(pytester):
    """Write the ledger of a test, and return its outcome and its lines."""
    pytester.makeconftest(CONFTEST)
    (pytester.path / "kept.csv").touch()

    def write(text=TEST, moved=0.0, expected=1.036):
        pytester.makepyfile(test_own=text.format(moved=moved, expected=expected))
        outcome = pytester.runpytest_inprocess("-p", "no:cacheprovider", "-n", "0")
        return outcome, (pytester.path / "kept.csv").read_text().splitlines()

    return write


def test_a_row_that_moved_changed_or_went_fails_and_is_written(write, pytester):
    write()
    # What rounding moves is no difference.
    outcome, rows = write(moved=0.0003)
    first = "Wk at 8 Hz,ISO 2631-1,1.036,1.0364,0.004,test_own.py::test_factor"
    assert outcome.ret == 0 and rows == ["claim,reference,expected,figure,tolerance,test", first]
    for change in ({"moved": 0.0006}, {"expected": 1.037}):
        outcome, changed = write(**change)
        assert outcome.ret == 1 and len(changed) == 2
        outcome.stdout.fnmatch_lines([f"- {rows[1].replace(',', ' | ')}", f"+ {changed[1].replace(',', ' | ')}"])
        rows = changed
    assert write(expected=1.037)[0].ret == 0
    other = TEST.format(moved=0.0, expected=0.988).replace("8.0", "10.0").replace("8 Hz", "10 Hz")
    pytester.makepyfile(test_other=other)
    outcome, both = write(expected=1.037)
    assert outcome.ret == 1 and len(both) == 3
    pytester.path.joinpath("test_other.py").unlink()
    outcome, left = write(expected=1.037)
    assert outcome.ret == 1 and left == rows


def test_a_figure_beyond_its_tolerance_or_without_the_product_fails_and_leaves_the_ledger(write):
    _, before = write()
    for text, moved, said in ((TEST, 0.005, "*is not 1.036 within*"), (WITHOUT_PRODUCT, 0.0, "*no function of seats*")):
        outcome, rows = write(text, moved)
        outcome.assert_outcomes(failed=1)
        outcome.stdout.fnmatch_lines([said])
        assert rows == before
