"""What several tests of imports use."""

import pandas as pd
import pytest

LET_LIBRARIES_WARN = pytest.mark.filterwarnings(
    "ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning"
)
"""For tests with files that other libraries write."""


def read_run(folder, run="run-a"):
    """Return the table of an imported run."""
    return pd.read_csv(folder / f"{run}.csv.gz")


def write_csv(path, table, **others):
    """Write a table as CSV and return its path."""
    pd.DataFrame({**table, **others}).to_csv(path, index=False)
    return path


def kinds(doubts, channel=None):
    """Return what kinds of doubts there are, of one channel or of all."""
    return {each.kind for each in doubts if channel in (None, each.channel)}
