"""Models against figures of their papers, or against values derived from these independently."""

import math
from functools import partial
from itertools import product

import numpy as np
import pytest
from numpy.polynomial.polynomial import polyval
from scipy.optimize import brentq

from seatsim.dampers.bouc_wen import ModifiedBoucWen, SimpleBoucWen
from seatsim.dampers.s_curves import KwokTanh, WengArctangent
from seatsim.dampers.sigmoid_gaussian import HongSigmoidGaussian
from seatsim.dampers.yu import Yu2019
from seatsim.rig.temperature import TemperatureScaling
from seatsim.schema.registry import name_of, specification_of
from seatsim.simulation.damper_bench import bench_force, sine_test

from .published.curves import HONG

COLD = TemperatureScaling()
SQRT_2_PI = math.sqrt(2 * math.pi)
POSITIVE, NEGATIVE = (1.0, 0.0), (-1.0, 0.0)


def paper_test(damper, amplitude=0.008, frequency=0.7, current=1.2, temperature=20.0):
    """A test of Yu et al. 2019, who used 4, 6, 8 mm at 0.5, 0.6, 0.7 Hz."""
    return sine_test(damper, amplitude, frequency, current, temperature, cycles=8, samples=400)


@pytest.mark.parametrize(("speed", "peak"), [(0.012 * math.pi, 1207.0), (0.051, 1328.0)])
def test_modified_bouc_wen_peak_forces_of_the_rd_1005_3(speed, peak, conform):
    found = sine_test(ModifiedBoucWen(f0=40.0), speed / (3 * math.pi), 1.5, 1.0, 20.0).peak_force
    claim = f"modified_bouc_wen, peak force at 1.5 Hz, {1e3 * speed:.1f} mm/s, 1 A, N"
    conform(claim, "derived from Braz-Cesar and Barros 2012, solved apart", found, peak, tolerance=1.0)


@pytest.mark.parametrize(("damper", "z_max"), [(ModifiedBoucWen(), 1.784e-3), (SimpleBoucWen(), 4.408e-3)])
def test_bouc_wen_states_saturate(damper, z_max, conform):
    name = name_of("damper", type(damper))
    # No inner spring and no series flow: the state alone decides.
    alone = damper._replace(k0=0.0, **{"c1": (1e12, 0, 0, 0)} if name == "modified_bouc_wen" else {})

    def rate(z):
        return alone.rates(0.0, 0.1, 1.0, COLD, (0.0, z)[-len(specification_of(type(damper)).initial) :])[-1]

    claim = f"{name}, greatest hysteretic displacement, m"
    source = "Braz-Cesar and Barros 2012: (A / (beta + gamma))^(1/n)"
    conform(claim, source, brentq(rate, 0.0, 0.01), z_max, tolerance=1e-3 * z_max)


@pytest.mark.parametrize("current", [0.0, 0.25, 0.5, 0.75, 1.0])
def test_the_modified_bouc_wen_laws_are_the_published_ones(current, conform):
    alpha, c0, c1 = (
        1e3 * polyval(current, law)
        for law in ((38.24, 412.52, 905.14, -826.67), (0.59, 11.02, 10.51, -11.73), (4.73, 64.57, 57.03, -54.40))
    )
    force, share = ModifiedBoucWen().force, c1 / (c0 + c1)
    for name, found, published in (
        ("viscous force over speed, N s/m", force(0.0, 1.0, current, COLD, (0.0, 0.0)), share * c0),
        ("force over hysteretic displacement, N/m", force(0.0, 0.0, current, COLD, (0.0, 1.0)), share * alpha),
    ):
        claim = f"modified_bouc_wen, {name}, at {current:g} A"
        conform(claim, "Braz-Cesar and Barros 2012, eqs 4.5-4.7", found, published, tolerance=1e-9 * published)


def test_the_modified_bouc_wen_laws_are_held_beyond_one_ampere():
    at = [sine_test(ModifiedBoucWen(), 0.004, 1.5, i, 20.0).peak_force for i in (1.0, 1.5)]
    assert at[0] == at[1]


@pytest.mark.parametrize("test", HONG)
def test_hong_curves_are_those_of_the_tables(test, conform):
    damper = HongSigmoidGaussian(test=test, v_unit=0.01)
    for current, row in zip((0.0, 0.25, 0.5, 0.75, 1.0, 2.0), HONG[test].split("|"), strict=True):
        _, b, c, sigma, r = map(float, row.split())
        up, down = (partial(damper.force, 0.0, i=current, scaling=COLD, z=branch) for branch in (POSITIVE, NEGATIVE))
        for name, found, expected in (
            ("force at 1 m/s, N: -b / 2", up(1.0), -500.0 * b),
            ("slope at rest, N over the unit of speed: -b c / 4", (up(1e-7) - up(-1e-7)) / 2e-5, -250.0 * b * c),
            ("half width at rest, N: r / (sqrt(2 pi) sigma)", (up(0.0) - down(0.0)) / 2, 1e3 * r / SQRT_2_PI / sigma),
        ):
            claim = f"hong_sigmoid_gaussian, test {test}, {current:g} A, {name}"
            conform(claim, f"Hong et al., table {test}", found, expected, tolerance=1e-6 * expected)


@pytest.mark.parametrize(("speed", "published"), [(1.0, 600.0), (-1.0, -1100.0)])
def test_hong_with_the_published_offset_saturates_at_a_and_at_a_plus_b(speed, published, conform):
    force = HongSigmoidGaussian(offset_share=1.0).force(0.0, speed, 1.0, COLD, POSITIVE)
    claim = f"hong_sigmoid_gaussian, published offset, force at 1 A and {speed:+g} m/s, N"
    conform(claim, "Hong et al., table of test 1: a, a + b", force, published, tolerance=1e-3)


@pytest.mark.parametrize(("current", "low", "high"), [(1.0, -1060, 510), (2.0, -1310, 730)])
def test_kwok_ranges_at_one_hertz_and_four_millimetres(current, low, high, conform):
    test = sine_test(KwokTanh(f0_a=-257.0, f0_b=-18.0), 0.004, 1.0, current, 20.0)
    for extreme, expected in ((np.argmax, high), (np.argmin, low)):
        force = test.force[extreme(test.velocity)]
        claim = (
            f"kwok_tanh, force at the {'greatest' if expected > 0 else 'least'} velocity, 4 mm, 1 Hz, {current:g} A, N"
        )
        conform(claim, "Kwok et al. 2006 (recalled)", force, expected, tolerance=0.02 * abs(expected))


class TestYu2019:
    """What Yu et al. 2019 state of their damper (figures 2 to 7)."""

    @pytest.mark.parametrize("figure", ["peak_force", "dissipated_energy"])
    def test_a_third_of_force_and_energy_is_lost_from_20_to_80_degrees(self, figure, conform):
        cold, hot = (getattr(paper_test(Yu2019(), temperature=t), figure) for t in (20.0, 80.0))
        claim = f"yu2019, share of the {figure.replace('_', ' ')} that is lost from 20 to 80 degC"
        conform(claim, "Yu et al. 2019", 1.0 - hot / cold, 0.33, tolerance=0.005)

    def test_force_level_that_the_published_errors_imply(self, conform):
        # RMSE 16.2 N at R2 = 0.9946 over all tests: a standard deviation of 220 N
        tests = product((0.004, 0.006, 0.008), (0.5, 0.6, 0.7), (0.0, 0.4, 0.8, 1.2), (20.0, 40.0, 60.0, 80.0))
        forces = [paper_test(Yu2019(), *each).force for each in tests]
        implied = 16.2 / math.sqrt(1.0 - 0.9946)
        claim, source = "yu2019, standard deviation of the force over all tests, N", "table 1 of Yu et al. 2019"
        conform(claim, f"{source}: RMSE / sqrt(1 - R2)", np.std(forces), implied, tolerance=0.01 * implied)


def test_motion_off_centre_is_better_predicted_by_the_recent_mean_than_by_the_sign(shared):
    """The swept sine of UTFSM moves between -4 mm and 0: the branch has to come from the recent mean."""
    pandas = pytest.importorskip("pandas")
    table = pandas.read_csv(shared / "data" / "utfsm_mr_chirp" / "chirp15Hz_1p0A.csv.gz")
    part = table[(table.time_s > 5.0) & (table.time_s < 30.0)]
    x, v, measured = (part[c].to_numpy() for c in ("displacement_m", "velocity_m_s", "force_N"))
    damper = WengArctangent()
    simulated = bench_force(damper, x[: len(x) // 2 * 2 - 1], v[: len(x) // 2 * 2 - 1], 1.0, 20.0, 0.002)
    always_negative = np.array([damper.force(a, b, 1.0, COLD, NEGATIVE) for a, b in zip(x, v, strict=True)])

    def error(force, reference):
        return float(np.std(force - reference))

    ours = error(simulated, measured[: len(x) // 2 * 2 - 1 : 2])
    assert ours < 0.9 * error(always_negative, measured)
