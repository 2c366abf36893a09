"""The true rig agrees with the nominal replay where nothing is wrong, and has converged."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import seatsim
from seatsim.blind.make.case import drive, read
from seatsim.blind.make.folder import recording_files, write_files
from seatsim.blind.truth.rig import STEP, simulate
from seatsim.blind.truth.slots import record
from seatsim.blind.truth.truth import Changes

from .settings import small_setting


@pytest.mark.usefixtures("short")
@pytest.mark.parametrize("bingham", [False, True])
def test_a_faultless_rig_replays_to_within_its_noise(bingham: bool, tmp_path: Path) -> None:
    setting, _, _ = small_setting(bingham)
    shown = [read(setting, Changes(), k, drive(setting, Changes(), k)) for k in range(4)]
    folder = tmp_path / "case"
    write_files(folder, recording_files(setting, shown, np.random.default_rng(0), [0, 1, 2, 3]))
    for run in ("run-a", "run-b", "run-c", "run-u"):
        gap = seatsim.gap(folder / "nominal.yaml", folder, [run])
        assert gap.overall <= 1.1 * gap.floor["overall"]


@pytest.mark.usefixtures("short")
def test_the_step_is_fine_enough_for_a_steep_damper() -> None:
    setting, _, bench = small_setting(True)
    values = record(setting.true)
    plan, law = setting.runs[2], np.zeros(6)
    coarse, fine = (
        simulate(values, plan.floor, np.zeros(1), law, bench.commands[2], plan.rows, step=step)
        for step in (STEP, STEP / 4)
    )
    for name in ("frame", "driver", "displacement", "force", "current"):
        a, b = getattr(coarse, name), getattr(fine, name)
        assert np.std(a - b) < 1e-3 * np.std(b)
