"""Shared fixtures."""

import gc
import importlib
import signal
import sys
from contextlib import chdir
from pathlib import Path

import pytest
from xdist.scheduler import LoadScopeScheduling

from seatsim.cli.app import main
from seatsim.schema import modules, registry

from .faulty_recordings import record_sound_rig
from .ledger import Ledger, conform
from .text import beside

__all__ = ["conform"]

pytest_plugins = ["pytester"]
ROOT = Path(__file__).resolve().parents[1]
SEAT = beside(__file__, "seat.yaml")


gc.set_threshold(100_000, 50, 100)
"""Importing and collecting make many objects that stay; looking for garbage among them took a quarter of the time."""


LONG = ("tests/diagnosis/test_", "tests/robustness/")
"""Modules that take minutes and share no rig."""


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """Leave the checks of the shipped scenarios, most of which design a law, to the slow tests; long modules first."""
    for item in items:
        if item.path.is_relative_to(ROOT / "scenarios"):
            item.add_marker(pytest.mark.slow)
    items.sort(key=lambda item: not item.nodeid.startswith(LONG))


class _ByFolder(LoadScopeScheduling):
    """Gives the tests of a folder to one worker, since they share rigs: each is compiled and simulated once."""

    def _split_scope(self, nodeid):
        file = nodeid.partition("::")[0]
        return file if file.startswith(LONG) else file.rpartition("/")[0]


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config, log):
    """Share out folders of tests, and long modules one by one, in their order: many tests need not take long."""
    config.option.loadscopereorder = False
    return _ByFolder(config, log)


def pytest_addoption(parser):
    """Add the option that writes the ledger of conformance."""
    parser.addoption("--ledger", action="store_true", help="write the ledger, of all rows that the tests enter")


def pytest_configure(config):
    """Have SIGINT mean what it does in a terminal: a shell lets what it starts in the background ignore it."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    if config.getoption("ledger", default=False):
        config.pluginmanager.register(Ledger(ROOT / "docs" / "conformance.csv"))


@pytest.fixture
def seat_file(tmp_path):
    """A short seat scenario on disk, which the test may edit."""
    path = tmp_path / "seat.yaml"
    path.write_text(SEAT)
    return path


@pytest.fixture(scope="session")
def kept_seat_file(tmp_path_factory):
    """The same for all tests together, which none edits."""
    path = tmp_path_factory.mktemp("kept") / "seat.yaml"
    path.write_text(SEAT)
    return path


@pytest.fixture(scope="session")
def sound(kept_seat_file, tmp_path_factory):
    """The folder of a recording without faults, which no test edits."""
    return record_sound_rig(kept_seat_file, tmp_path_factory.mktemp("sound") / "recorded")


@pytest.fixture(scope="module")
def benchmark():
    """Import a benchmark as the scripts beside it do."""
    folder = str(ROOT / "benchmarks")
    sys.path.insert(0, folder)
    yield importlib.import_module
    sys.path.remove(folder)


@pytest.fixture
def here(tmp_path):
    """Work in an empty folder."""
    with chdir(tmp_path):
        yield tmp_path


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
def shared():
    """The folder of measured data beside the repository; tests that need it skip where it is absent."""
    folder = ROOT.parent / "shared"
    if not folder.is_dir():
        pytest.skip("measured data are not beside the repository")
    return folder


@pytest.fixture
def forget_own_code(monkeypatch):
    """Forget at the end which files were used, their modules and what these registered."""
    registry.names("damper")
    monkeypatch.setattr(modules, "_used", {})
    monkeypatch.setattr(registry, "_classes", {kind: dict(known) for kind, known in registry._classes.items()})
    yield
    for name in modules._used:
        sys.modules.pop(name, None)
