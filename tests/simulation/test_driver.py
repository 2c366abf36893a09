"""Seated bodies: their apparent mass and transmissibility, and the simulated seat against its frequency response."""

import numpy as np
import pytest

from seatsim import load, run
from seatsim.rig.drivers import BODIES, body_matrices
from seatsim.schema.errors import InputError
from seatsim.simulation.simulate import simulate

from ..text import beside

FREQUENCY = np.arange(0.5, 20.0, 0.05)
SEAT = beside(__file__, "seat_for_bodies.yaml")


def respond(body, frequency):
    """Acceleration of every mass of a body over that of a rigid seat, by frequency in Hz."""
    masses, stiffness, damping = body_matrices(body)
    s = 2j * np.pi * np.asarray(frequency)[..., None, None]
    drive = (damping * s + stiffness).sum(axis=-1)
    return np.linalg.solve(np.diag(masses) * s**2 + damping * s + stiffness, drive[..., None])[..., 0]


def apparent_mass(body, frequency):
    return body.contact + respond(body, frequency) @ np.array(body.masses)


def head_transmissibility(body, frequency):
    return respond(body, frequency)[..., body.head]


@pytest.fixture
def seat(tmp_path):
    path = tmp_path / "seat.yaml"
    path.write_text(SEAT)
    return path


@pytest.mark.parametrize("name", BODIES)
def test_a_body_weighs_its_mass_and_follows_a_slow_seat(name):
    body = BODIES[name]
    assert abs(apparent_mass(body, 0.01)) == pytest.approx(body.mass, rel=1e-4)
    assert abs(head_transmissibility(body, 0.01)) == pytest.approx(1.0, rel=1e-4)
    assert abs(apparent_mass(body, 1e4)) == pytest.approx(body.contact, rel=2e-2)


@pytest.mark.parametrize(
    ("name", "peak", "over_static", "head_peak", "head"),
    [
        ("iso5982", 3.8, 1.37, 4.8, 1.35),
        ("wan_schimmels", 3.6, 1.40, 4.2, 1.83),
        ("boileau_rakheja", 4.6, 1.64, 4.7, 1.78),
    ],
)
def test_bodies_resonate_where_people_do(name, peak, over_static, head_peak, head):
    # The figures are those of the recalled tables; measured people have their peaks between 3.5 and 6 Hz.
    body = BODIES[name]
    mass, transmitted = np.abs(apparent_mass(body, FREQUENCY)), np.abs(head_transmissibility(body, FREQUENCY))
    assert FREQUENCY[mass.argmax()] == pytest.approx(peak, abs=0.15)
    assert mass.max() - body.contact == pytest.approx(over_static * (body.mass - body.contact), rel=0.02)
    assert FREQUENCY[transmitted.argmax()] == pytest.approx(head_peak, abs=0.15)
    assert transmitted.max() == pytest.approx(head, rel=0.02)


def coupled_gain(plant, body, frequency):
    """|zc''/z0''| of the linear seat with a body on it, from its dynamic stiffness."""
    s = 2j * np.pi * frequency
    kf, cf, kc, cc = plant[2:6]
    on_seat = s**2 * apparent_mass(body, frequency) * plant.driver_mass / body.mass
    cushion, suspension = kc + cc * s, kf + cf * s
    frame = np.array([[plant.frame_mass * s**2 + suspension + cushion, -cushion], [-cushion, cushion + on_seat]])
    return abs(np.linalg.solve(frame, np.array([suspension, 0.0]))[1])


@pytest.mark.parametrize("name", BODIES)
@pytest.mark.parametrize("frequency", [1.5, 4.0, 9.0])
def test_a_simulated_seat_has_the_response_of_seat_and_body(seat, name, frequency):
    settings = {"driver.model": name, "excitation.frequency": frequency, "excitation.amplitude": 0.02 / frequency**2}
    [scenario] = load(seat, settings)
    history = simulate(scenario)
    settled = slice(round(8 / history.step), None)
    gain = history["driver_acceleration"][settled].std() / history["floor_acceleration"][settled].std()
    assert gain == pytest.approx(coupled_gain(scenario.plant, BODIES[name], frequency), rel=2e-3)


def test_energies_that_miss_the_body_are_left_out(seat):
    assert "energy_residual" not in run(seat, {"driver.model": "iso5982"}).runs[0].metrics
    assert "energy_residual" in run(seat).runs[0].metrics


def test_a_body_is_named_and_stands_alone(seat):
    with pytest.raises(InputError, match=r"driver\.model: .*iso5892.*did you mean 'iso5982'"):
        load(seat, {"driver.model": "iso5892"})
    effect = [{"effect": "driver.biodynamics", "parameters": {"share": 0.3}}]
    with pytest.raises(InputError, match="leave one of them out"):
        run(seat, {"driver.model": "iso5982", "effects": effect})


def test_a_single_mass_is_what_a_scenario_without_driver_has(seat):
    assert run(seat, {"driver.model": "single_mass"}).table.equals(run(seat).table)
