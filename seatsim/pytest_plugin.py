"""The plugin by which `pytest FOLDER` tests what scenario files state under `checks:`, one test a check and run.

It is found through the entry point `pytest11`. Nothing of seatsim but this module is imported unless a YAML file with
checks is collected.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from seatsim.scenario.checks import Check
    from seatsim.scenario.scenario import Scenario
    from seatsim.simulation.result import Run

_STATES_CHECKS = re.compile(rb"^checks\s*:", re.MULTILINE)


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    """Return the tests of a YAML file that has the key `checks` at its top, else nothing."""
    if file_path.suffix in (".yaml", ".yml") and _STATES_CHECKS.search(file_path.read_bytes()):
        return _ScenarioFile.from_parent(parent, path=file_path)
    return None


class _ScenarioFile(pytest.File):
    """A scenario file; a run is simulated once for all of its checks, which stand one behind the other."""

    latest: tuple[Scenario, Run] | None = None

    def collect(self) -> Iterable[pytest.Item]:
        from seatsim.scenario.loading import load
        from seatsim.schema.errors import SeatsimError
        from seatsim.simulation.checks import applicable_checks

        try:
            scenarios = load(self.path)
        except SeatsimError as error:
            raise self.CollectError(str(error)) from error
        for scenario in scenarios:
            for check in applicable_checks(scenario):
                run = ", ".join(map(str, scenario.label.values()))
                name = f"{check.name}[{run}]" if run else check.name
                yield _CheckItem.from_parent(self, name=name, scenario=scenario, check=check)

    def run_of(self, scenario: Scenario) -> Run:
        from seatsim.simulation.runs import run_one

        if self.latest is None or self.latest[0] is not scenario:
            self.latest = scenario, run_one(scenario)
        return self.latest[1]


class _CheckItem(pytest.Item):
    """One check of one run."""

    def __init__(self, *, scenario: Scenario, check: Check, **fixed: object) -> None:
        super().__init__(**fixed)  # type: ignore[arg-type]  # what pytest itself hands on
        self.scenario, self.check = scenario, check

    def runtest(self) -> None:
        from seatsim.schema.errors import SeatsimError
        from seatsim.simulation.checks import decide_check

        assert isinstance(self.parent, _ScenarioFile)
        try:
            figure = decide_check(self.parent.run_of(self.scenario), self.check)
            problem = "" if figure.is_within else f"{self.scenario.title}: {figure}"
        except SeatsimError as error:
            problem = str(error)
        if problem:
            pytest.fail(problem, pytrace=False)

    def reportinfo(self) -> tuple[Path, None, str]:
        return self.path, None, self.name
