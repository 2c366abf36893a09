"""Scenarios side by side in lanes: the same metrics as run by run."""

from dataclasses import replace

import numpy as np
import pytest

from seatsim.kernel.lane_records import LANES
from seatsim.scenario.loading import load
from seatsim.schema.errors import RunError
from seatsim.simulation.ensemble import simulate_ensemble
from seatsim.simulation.runs import run_one

STIFF, ALONE, LOST = 3, 7, 11


@pytest.fixture(scope="module")
def scenarios(kept_seat_file):
    """More than one block: masses, floors, temperatures, delays and durations differ, and one lane is stiff."""
    nominal = load(kept_seat_file, {"excitation.duration": 1.0, "plant.travel": [-0.004, 0.004]})[0]
    rng = np.random.default_rng(2)

    def vary(k):
        plant = nominal.plant._replace(driver_mass=float(rng.uniform(50.0, 110.0)))
        coil = nominal.coil._replace(delay=0.001 * (k % 4))
        excitation = nominal.excitation._replace(duration=1.5 if k % 5 == 4 else 1.0)
        temperature = float(rng.uniform(0.0, 80.0))
        return replace(nominal, plant=plant, coil=coil, excitation=excitation, temperature=temperature, seed=k)

    def with_damper(scenario, **changed):
        return replace(scenario, damper=replace(scenario.damper, record=scenario.damper.record._replace(**changed)))

    varied = [vary(k) for k in range(LANES + 6)]
    varied[STIFF] = with_damper(varied[STIFF], c_a=1e5)
    varied[ALONE] = replace(varied[ALONE], coil=nominal.coil._replace(delay=0.0005))
    varied[LOST] = with_damper(varied[LOST], c_a=-3e3, c_b=0.0, alpha_a=0.0, alpha_b=0.0, k0=-1e7)
    return varied


@pytest.fixture(scope="module")
def rows(scenarios):
    return simulate_ensemble(scenarios)


def test_every_row_is_that_of_its_run(scenarios, rows):
    assert len(rows) == len(scenarios)
    for place, (scenario, row) in enumerate(zip(scenarios, rows, strict=True)):
        if place != LOST:
            alone = run_one(scenario).metrics
            assert list(row) == list(alone), scenario.seed
            for name, metric in alone.items():
                value = pytest.approx(metric.value, rel=1e-9, abs=1e-12)
                assert row[name] == metric._replace(value=value), (place, name)


def test_what_lanes_have_no_room_for_runs_alone(scenarios, rows):
    assert rows[ALONE] == run_one(scenarios[ALONE]).metrics


def test_a_lane_that_is_lost_says_so_and_the_others_go_on(scenarios, rows):
    with pytest.raises(RunError) as alone:
        run_one(scenarios[LOST])
    assert str(rows[LOST]) == str(alone.value)
    assert sum(isinstance(row, RunError) for row in rows) == 1


def test_no_scenarios_have_no_rows():
    assert simulate_ensemble([]) == []
