"""What each effect of suspension, cushion, driver and floor does to a seat that is shaken."""

from dataclasses import replace

import numpy as np
import pytest

from seatsim.scenario.scenario import Start
from seatsim.simulation.runs import measure_run
from seatsim.simulation.simulate import simulate
from seatsim.simulation.validity import list_reasons

from .rigs import distance, record, seat, shaken

DRIVER = 80.0
LOOSE = {
    "damper.parameters": {"c_a": 0.0, "c_b": 0.0, "fc_a": 0.0, "fc_b": 0.0, "f0": 0.0, "v_ref": 0.004},
    "plant.suspension_damping": 0.0,
}


@pytest.fixture(scope="module")
def loose(tmp_path_factory):
    """A seat whose suspension has a spring only, so that its work is the effect's."""
    return seat(tmp_path_factory.mktemp("loose"), LOOSE)


def test_a_body_of_its_own_has_no_energy_balance_and_is_not_marked_for_it(tmp_path):
    effect = record("driver.biodynamics", share=0.3, frequency=5.0, damping=0.2)
    scenario = replace(seat(tmp_path), effects=(effect,))
    history = simulate(scenario, carry_all_effects=True)
    assert np.all(np.isnan(history["energy_floor"]))
    assert not any("energy" in reason for reason in list_reasons(scenario, history, measure_run(scenario, history)))


def test_the_unmeasured_force_pushes_the_frame_and_no_channel_of_the_floor_shows_it(loose):
    effect = record("floor.unmeasured_input", rms=40.0)
    history, again = shaken(loose, effect), shaken(loose, effect)
    assert distance(history, again) == 0.0
    assert distance(history, shaken(replace(loose, seed=loose.seed + 1), effect)) > 1e-3
    assert np.array_equal(history["floor_acceleration"], shaken(loose)["floor_acceleration"])
    # out of the balance of forces on frame and driver
    inertia = DRIVER * history["driver_acceleration"] + loose.plant.frame_mass * history["frame_acceleration"]
    carried = loose.plant.suspension_stiffness * history["suspension_displacement"] + history["damper_force"]
    pushed = effect.frame_force(history["time"], loose.seed)
    assert inertia + carried == pytest.approx(pushed, abs=1e-6)


def test_friction_holds_a_seat_that_is_released_within_its_limit(loose, tmp_path):
    still = seat(tmp_path, LOOSE | {"excitation": {"kind": "rest", "duration": 1.0}})
    released = replace(still, start=Start(0.01, 0.0))
    # The spring pulls with 46 N.
    history = shaken(released, record("suspension.friction", force=60.0))
    assert np.max(np.abs(history["suspension_displacement"] - 0.01)) < 1e-12
    slid = shaken(released, record("suspension.friction", force=20.0))
    assert np.max(np.abs(slid["suspension_displacement"] - 0.01)) > 1e-3


@pytest.mark.parametrize(
    ("travel", "stiffness", "limit"),
    [((-0.05, 0.05), 6e4, 0.004), ((-0.002, 0.002), 6e4, 0.004), ((-0.002, 0.002), 0.0, 0.002), (None, 0.0, None)],
)
def test_hits_are_counted_at_the_buffers_of_the_rig_else_at_its_travel(bingham, travel, stiffness, limit):
    plant = bingham.plant._replace(**({} if travel is None else {"travel": travel}))
    stop = record("suspension.end_stop", low=-0.004, high=0.004, stiffness=stiffness)
    scenario = replace(bingham, plant=plant, effects=(stop,))
    history = simulate(scenario, carry_all_effects=True)
    metrics = measure_run(scenario, history)
    if limit is None:
        assert "end_stop_hits" not in metrics
    else:
        beyond = np.abs(history["suspension_displacement"]) > limit
        assert metrics["end_stop_hits"].value == np.count_nonzero(np.diff(beyond.astype(int), prepend=0) > 0) > 0
