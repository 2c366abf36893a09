"""A law is designed for floors and travel of its scenario, and says what the limits of the damper cost it."""

from functools import partial

import numpy as np
import pytest

import seatsim
from seatsim.rig.control import prepare_law
from seatsim.scenario.loading import single
from seatsim.schema.errors import InputError, SynthesisError
from seatsim.simulation import simulate
from seatsim.simulation.checks import measure_clipping

PLAIN = {"variants": {}, "sweep": {}, "checks": {}, "excitation.duration": 10.0, "controller.masses": [60.0]}
LIMIT = PLAIN | {"excitation.duration": 40.0, "controller.weights": {"travel": "limit", "comfort": "Wk"}}


def settle(settings):
    scenario = single("quickstart", settings)
    return scenario, simulate.settle_travel(scenario, scenario.control)


def compiled(scenario, law):
    floors = partial(simulate.record_floors, scenario, scenario.control)
    return prepare_law(law, scenario.plant, scenario.coil, 0.005, floors)


FIND = simulate._find_weight.__wrapped__
"""Without what it keeps, which would be of other peaks."""


def settle_falling(monkeypatch, peak, settings=LIMIT):
    """Settle the weight where the peak falls as it rises, from a value in m at the least weight."""
    fall = lambda run: peak * run.control.law.weights.travel**-0.1  # noqa: E731
    monkeypatch.setattr(simulate, "measure_peak_travel", fall)
    monkeypatch.setattr(simulate, "_find_weight", FIND)
    return settle(settings)[1].weights.travel


def test_the_least_weight_that_keeps_the_peak_within_nine_tenths_of_the_travel_is_found_to_a_fifth(monkeypatch):
    assert settle_falling(monkeypatch, 0.04) == 1.0
    exact = (0.06 / 0.045) ** 10
    assert exact <= settle_falling(monkeypatch, 0.06) <= 1.2 * exact


def test_a_floor_too_rough_for_the_seat_and_a_seat_without_end_stops_are_said(monkeypatch):
    with pytest.raises(SynthesisError, match=r"no weight of the travel up to 300 .* within 4.5 mm"):
        settle_falling(monkeypatch, 0.04, LIMIT | {"plant.travel": [-0.005, 0.005]})
    with pytest.raises(InputError, match=r"state plant\.travel"):
        settle_falling(monkeypatch, 0.04, LIMIT | {"plant.travel": [-10.0, 10.0]})


@pytest.mark.slow
def test_the_seat_of_that_weight_keeps_within_nine_tenths_of_its_travel_and_of_a_smaller_does_not():
    scenario, law = settle(LIMIT)
    weight = law.weights.travel

    def peak(factor):
        settings = LIMIT | {"seed": scenario.seed + 1, "effects": []}
        settings |= {"controller.weights": {"travel": factor * weight, "comfort": "Wk"}}
        return simulate.measure_peak_travel(single("quickstart", settings))

    assert peak(1.0) <= 0.045 < peak(0.8)


def test_one_gain_for_several_floors_is_the_same_under_each_of_them():
    floors = [{"kind": "iso7096", "spectral_class": name, "duration": 30.0} for name in ("EM2", "EM6")]
    coloured = PLAIN | {"controller.weights": {"travel": 20.0, "floor": "excitation"}}

    def design(settings):
        return [compiled(*settle(settings | {"excitation.spectral_class": name})) for name in ("EM2", "EM6")]

    own, shared = design(coloured), design(coloured | {"controller.floors": floors})
    assert own[0] != own[1] and shared[0] == shared[1] and shared[0] not in own


def test_clipping_states_the_linear_promise_and_what_was_delivered():
    quick = PLAIN | {"effects": [], "actuator.rate": 5e3}
    scenario = single("quickstart", quick | {"controller": {"law": "static_output_feedback", "gain": [0.0, 300.0]}})
    clipping = measure_clipping(scenario, np.array([[0.0, 300.0]]))
    viscous = {f"damper.parameters.{key}": 0.0 for key in ("c_b", "alpha_a", "alpha_b")}
    passive = quick | viscous | {"damper.parameters.c_a": 300.0, "controller": {"law": "constant", "current": 0.0}}
    promised = seatsim.run("quickstart", passive).runs[0].metrics["driver_acceleration_weighted"].value
    assert clipping.promised == pytest.approx(promised, rel=0.003)
    run = seatsim.run(scenario).runs[0]
    assert clipping.delivered == run.metrics["driver_acceleration_weighted"].value
    assert 0.0 < clipping.force_error == run.metrics["force_tracking_error_relative"].value
