"""The command line as a script calls it."""

import sys
from contextlib import chdir

import pytest

from seatsim.cli.app import main


@pytest.fixture
def seatsim_command(capsys):
    """Call the whole program and return its exit status, standard output and standard error."""

    def call(*arguments):
        before, sys.argv = sys.argv, ["seatsim", *map(str, arguments)]
        try:
            with pytest.raises(SystemExit) as stopped:
                main()
        finally:
            sys.argv = before
        return stopped.value.code, *capsys.readouterr()

    return call


@pytest.fixture
def here(tmp_path):
    """Work in an empty folder."""
    with chdir(tmp_path):
        yield tmp_path


@pytest.fixture
def undrawn(monkeypatch):
    """Leave out the pictures, which take most of the time."""
    monkeypatch.setattr("seatsim.plots.runs.draw.plot_result", lambda result: {})
