"""The stated vehicle between road and cab floor."""

import control
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from seatsim.excitations import road
from seatsim.schema.errors import InputError


def test_response_agrees_with_the_state_space(conform):
    f = np.geomspace(0.05, 80, 60)
    outputs = np.squeeze(control.ss(*road.state_space())(2j * np.pi * f))
    s = 2j * np.pi * f
    for k, quantity in enumerate(("displacement", "velocity", "acceleration")):
        deviation = np.max(np.abs(outputs[k] / (s**k * road.floor_response(f)) - 1))
        claim = f"truck's cab floor, relative deviation of the response in {quantity}"
        conform(claim, "python-control, frequency response", deviation, tolerance=1e-8)


def test_stiff_links_make_one_mass_on_its_tyre(conform):
    rigid = road.Vehicle(suspension_stiffness=1e12, mount_stiffness=1e12)
    f = np.array([0.5, 1.0, 1.5])
    mass = road.TRUCK.axle_mass + road.TRUCK.body_mass + road.TRUCK.cab_mass
    expected = road.TRUCK.tyre_stiffness / (road.TRUCK.tyre_stiffness - mass * (2 * np.pi * f) ** 2)
    deviation = np.max(np.abs(road.floor_response(f, rigid) / expected - 1))
    reference = "one mass on its tyre, k / (k - m omega^2)"
    conform("truck with rigid links, relative deviation", reference, deviation, tolerance=1e-4)


def test_stated_modes():
    poles = control.ss(*road.state_space()).poles()
    poles = sorted(poles[poles.imag > 0], key=abs)
    assert np.abs(poles) / (2 * np.pi) == pytest.approx([1.15, 1.96, 8.83], abs=0.01)
    assert -np.real(poles) / np.abs(poles) == pytest.approx([0.29, 0.49, 0.53], abs=0.01)


@pytest.mark.parametrize(
    ("road_class", "speed", "low", "high"), [("B", 20.0, 0.3, 0.6), ("D", 10.0, 1.0, 2.0), ("D", 15.0, 1.0, 2.0)]
)
def test_floor_acceleration_is_that_of_a_truck_cab(road_class, speed, low, high):
    acceleration = road.Road(road_class, speed, 60.0).floor(0.001, 1).acceleration[1000:]
    rms = np.sqrt(np.mean(acceleration**2))
    assert low < rms < high
    f = np.linspace(road.LONGEST * speed, road.SHORTEST * speed, 20000)
    density = road.displacement_density(f / speed, road_class) / speed * (2 * np.pi * f) ** 4
    assert rms == pytest.approx(np.sqrt(np.trapezoid(density * np.abs(road.floor_response(f)) ** 2, f)), rel=0.05)


def test_bump_response_agrees_with_time_integration(conform):
    bump = road.Bumps("haversine", 0.06, 1.5, 6.0, 4.0)
    floor, under = bump.floor(0.001, 0), bump._replace(through="direct").floor(0.001, 0)
    A, B, C, _ = road.state_space()

    def rates(t, x):
        return A @ x + B[:, 0] * np.interp(t, under.time, under.displacement)

    solution = solve_ivp(rates, (0, 4), np.zeros(6), t_eval=floor.time, max_step=0.005, rtol=1e-7, atol=1e-10)
    for name, output in zip(("displacement", "velocity", "acceleration"), C @ solution.y, strict=True):
        deviation = np.abs(getattr(floor, name) - output).max() / np.abs(output).max()
        claim = f"truck's cab floor over a bump, deviation of the {name} over its peak"
        conform(claim, "scipy, solve_ivp at 1e-7", deviation, tolerance=1e-3)


def test_ring_down_covers_the_slowest_mode_and_refuses_a_vehicle_that_never_settles():
    slowest = np.linalg.eigvals(road.state_space()[0]).real.max()
    assert np.exp(slowest * road.ring_down(road.TRUCK)) == pytest.approx(1e-6)
    with pytest.raises(InputError, match="N/m"):
        road.ring_down(road.Vehicle(tyre_stiffness=1000.0))
