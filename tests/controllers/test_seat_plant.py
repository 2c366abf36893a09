"""The seat's generalised plant with weights, lag and variations, and the law that uses it."""

from dataclasses import replace

import numpy as np
import pytest

import seatsim
from controllers.laws.static_output_feedback import StaticOutputFeedback
from controllers.seat_plant import ActuatorLag, Weights, build_actuator, build_generalised_plant
from controllers.synthesis.norm import frequency_response, hinf_norm
from controllers.synthesis.plant import LinearSystem
from seatsim.metrics import weighting
from seatsim.rig.coil import Coil
from seatsim.rig.control import prepare_law
from seatsim.rig.plant import Plant
from seatsim.rig.sensors import Sensors
from seatsim.scenario.scenario import Control
from seatsim.schema.errors import InputError
from seatsim.simulation.checks import describe_sampled_loop

SEAT = Plant(20.0, 80.0, 4600.0, 200.0, 60000.0, 1500.0)
OMEGA = np.geomspace(0.5, 300.0, 40)


def gains(system, omega=OMEGA):
    return frequency_response(LinearSystem(*system), omega)


def test_actuator_lags_as_coil_and_delay(conform):
    lag = ActuatorLag(rate=130.0, delay=0.004)
    omega = np.geomspace(1.0, 1.0 / lag.delay, 20)
    exact = np.exp(-1j * omega * lag.delay) * lag.rate / (1j * omega + lag.rate)
    deviation = np.max(np.abs(gains(build_actuator(lag), omega)[:, 0, 0] - exact))
    claim = "actuator with a Pade delay, greatest deviation of the gain up to 1 / delay"
    conform(claim, "exp(-s T) rate / (s + rate)", deviation, tolerance=2e-3)
    assert len(build_actuator(ActuatorLag(delay=0.0)).A) == 1


def test_every_path_with_lag_and_weighting():
    bare = build_generalised_plant(SEAT, Weights(travel=10.0, acceleration=2.0))
    lag = ActuatorLag(rate=100.0, delay=0.002)
    full = build_generalised_plant(SEAT, Weights(10.0, 2.0, "Wk"), lag, force_factor=0.7)

    def paths(plant):
        B, C = np.hstack([plant.B1, plant.B2]), np.vstack([plant.C1, plant.C2])
        return gains(LinearSystem(plant.A, B, C, np.zeros((4, 2))))

    H = weighting.frequency_response(OMEGA / (2 * np.pi), "Wk")
    rows, columns = np.ones((len(OMEGA), 4, 1), complex), np.ones((len(OMEGA), 1, 2), complex)
    rows[:, 1, 0], columns[:, 0, 1] = H, 0.7 * gains(build_actuator(lag))[:, 0, 0]
    np.testing.assert_allclose(paths(full), rows * paths(bare) * columns, rtol=1e-8, atol=1e-14)


def test_every_measure_is_what_the_seat_moves_by(conform):
    measures = ("driver_velocity", "velocity", "frame_acceleration", "driver_acceleration", "frame_velocity")
    lag = ActuatorLag()
    plant = build_generalised_plant(SEAT, Weights(), lag, measures=measures)
    found = gains(LinearSystem(plant.A, plant.B1, np.vstack([plant.C1, plant.C2]), np.zeros((7, 1))))[:, :, 0]
    x, driver = found[:, 0] / Weights().travel, found[:, 1]
    s = 1j * OMEGA
    leak, frame = 1.0 / (s + 2 * np.pi * Sensors().corner), s * s * x + 1.0
    expected = (leak * driver, s * x, frame, driver, leak * frame)
    for k, name in enumerate(measures):
        deviation = np.max(np.abs(found[:, 2 + k] / expected[k] - 1))
        claim = f"generalised plant, greatest relative deviation of the response of {name}"
        conform(claim, "kinematics of the seat", deviation, tolerance=1e-9)


@pytest.mark.slow
def test_more_measures_never_design_worse_and_the_file_names_them(tmp_path):
    few = StaticOutputFeedback(weights=Weights(22.6, comfort="Wk"), lag=ActuatorLag())
    many = few._replace(measures=("displacement", "velocity", "frame_acceleration"))
    design = many.synthesis(SEAT)
    assert design.gamma < 0.97 * few.synthesis(SEAT).gamma and design.certificate
    design.save(tmp_path / "design.yaml")
    read = many._replace(weights=None, design=str(tmp_path / "design.yaml"))
    assert prepare_law(read, SEAT, Coil(), 0.005).frame_acceleration == design.gain[0, 2]
    with pytest.raises(InputError, match=r"designed for measures: \[displacement, velocity, frame_acceleration\]"):
        prepare_law(read._replace(measures=few.measures), SEAT, Coil(), 0.005)


@pytest.mark.parametrize(
    ("law", "words"),
    [
        (StaticOutputFeedback(gain=(1.0, 2.0, 3.0)), r"gain of shape \(1, 3\); displacement, velocity take one"),
        (StaticOutputFeedback(gain=(1.0, 2.0), measures=("velocity", "velocity")), "names one signal twice"),
        (StaticOutputFeedback(weights=Weights(), measures=("frame_acceleration",)), "state the coil's lag under lag"),
        (StaticOutputFeedback(), "exactly one"),
        (StaticOutputFeedback(weights=Weights("limit")), "found by simulation of a scenario"),
    ],
)
def test_a_law_that_contradicts_itself_says_so(law, words):
    with pytest.raises(InputError, match=words):
        prepare_law(law, SEAT, Coil(), 0.005)


def test_law_designs_for_the_worst_of_drivers_and_factors():
    ranges = {"masses": (50.0, 120.0), "force_factors": (0.67, 1.0)}
    law = StaticOutputFeedback(weights=Weights(50.0), displacement_gain=False, **ranges)
    design = law.synthesis(SEAT)
    assert len(design.loops) == 4
    scan = [
        max(hinf_norm(p.close([[0, k2]])).value for p in law.plants(SEAT)) for k2 in np.arange(1000.0, 5000.0, 50.0)
    ]
    assert min(scan) * (1 - 1e-3) <= design.gamma <= min(scan)
    assert all(loop.gamma <= design.gamma and loop.poles.real.max() < 0 for loop in design.loops)


@pytest.mark.parametrize(("gain", "delay", "said"), [(2000.0, 0.0, "stable at 5 ms"), (2e5, 0.01, "UNSTABLE")])
def test_a_design_is_judged_by_its_margins_and_its_sampled_loop(gain, delay, said):
    law, stated = StaticOutputFeedback(weights=Weights()), np.array([[0.0, gain]])
    assert "gain any" in law.margins(SEAT, Coil(), stated)
    control = Control(law.with_gain(stated), 0.005, None)
    scenario = replace(seatsim.load("quickstart")[0], control=control, coil=Coil(delay=delay), effects=())
    assert describe_sampled_loop(scenario).startswith(said)
