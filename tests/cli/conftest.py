"""The command line as a script calls it."""

import sys

import pytest

from seatsim.cli.app import main


@pytest.fixture
def seatsim_command(monkeypatch, capsys):
    """Call the whole program and return its exit status, standard output and standard error."""

    def call(*arguments):
        monkeypatch.setattr(sys, "argv", ["seatsim", *map(str, arguments)])
        with pytest.raises(SystemExit) as stopped:
            main()
        return stopped.value.code, *capsys.readouterr()

    return call


@pytest.fixture
def undrawn(monkeypatch):
    """Leave out the pictures, which take most of the time."""
    monkeypatch.setattr("seatsim.plots.runs.draw.plot_result", lambda result: {})
