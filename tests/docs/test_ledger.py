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
def written(pytester):
    """Write the ledger of a test once, and return what to write it again with."""
    pytester.makeconftest(CONFTEST)

    def write(moved=0.0, expected=1.036):
        pytester.makepyfile(TEST.format(moved=moved, expected=expected))
        outcome = pytester.runpytest_inprocess("-p", "no:cacheprovider", "-n", "0")
        return outcome, (pytester.path / "kept.csv").read_text().splitlines()

    (pytester.path / "kept.csv").touch()
    write()
    return write


def test_a_figure_that_rounding_moves_is_no_difference(written):
    outcome, rows = written(moved=0.0003)
    assert outcome.ret == 0
    assert rows == [
        "claim,reference,expected,figure,tolerance,test",
        "Wk at 8 Hz,ISO 2631-1,1.036,1.0364,0.004,test_a_figure_that_rounding_moves_is_no_difference.py::test_factor",
    ]


@pytest.mark.parametrize("change", [{"moved": 0.0006}, {"expected": 1.037}])
def test_a_row_that_moved_or_changed_fails_and_is_written(written, change):
    _, before = written()
    outcome, rows = written(**change)
    assert outcome.ret == 1 and len(rows) == 2
    outcome.stdout.fnmatch_lines([f"- {before[1].replace(',', ' | ')}", f"+ {rows[1].replace(',', ' | ')}"])
    assert written(**change)[0].ret == 0


def test_a_row_that_went_fails(written, pytester):
    pytester.makepyfile(test_other=TEST.format(moved=0.0, expected=1.036).replace("8", "10").replace("1.036", "0.988"))
    assert written()[0].ret == 1
    pytester.path.joinpath("test_other.py").unlink()
    outcome, rows = written()
    assert outcome.ret == 1 and len(rows) == 2


def test_a_figure_beyond_its_tolerance_fails_and_leaves_the_ledger(written):
    _, before = written()
    outcome, rows = written(moved=0.005)
    outcome.assert_outcomes(failed=1)
    assert rows == before


def test_a_figure_without_the_product_is_refused(written, pytester):
    pytester.makepyfile(WITHOUT_PRODUCT)
    pytester.runpytest_inprocess("-n", "0").stdout.fnmatch_lines(["*no function of seatsim was called*"])
