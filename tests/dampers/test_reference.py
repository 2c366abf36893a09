"""Models against figures of their papers, or against values derived from these independently."""

import math

import numpy as np
import pytest

from seatsim.dampers.bouc_wen import ModifiedBoucWen
from seatsim.dampers.pieces import branch, branch_rate
from seatsim.dampers.s_curves import KwokTanh, WengArctangent
from seatsim.dampers.sigmoid_gaussian import CURRENTS, TABLES, HongSigmoidGaussian, table_row
from seatsim.dampers.yu import Yu2017, Yu2019
from seatsim.rig.temperature import TemperatureScaling
from seatsim.schema.registry import specification_of
from seatsim.simulation.damper_bench import bench_force, sine_test

COLD = TemperatureScaling()
POSITIVE, NEGATIVE = (1.0, 0.0), (-1.0, 0.0)


def paper_test(damper, amplitude=0.008, frequency=0.7, current=1.2, temperature=20.0):
    """A test of Yu et al. 2019, who used 4, 6, 8 mm at 0.5, 0.6, 0.7 Hz."""
    return sine_test(damper, amplitude, frequency, current, temperature, cycles=8, samples=400)


def test_modified_bouc_wen_peak_forces_of_the_rd_1005_3():
    damper = ModifiedBoucWen(f0=40.0)
    assert sine_test(damper, 0.004, 1.5, 1.0, 20.0).peak_force == pytest.approx(1207.0, abs=1.0)
    amplitude = 0.051 / (2 * math.pi * 1.5)
    assert sine_test(damper, amplitude, 1.5, 1.0, 20.0).peak_force == pytest.approx(1328.0, abs=1.0)


def test_the_modified_bouc_wen_laws_are_held_beyond_one_ampere():
    at = [sine_test(ModifiedBoucWen(), 0.004, 1.5, i, 20.0).peak_force for i in (1.0, 1.5)]
    assert at[0] == at[1]


@pytest.mark.parametrize("test", [1, 2])
def test_hong_tables_are_met_at_the_test_currents(test):
    for row, current in zip(TABLES[test - 1], CURRENTS, strict=True):
        assert table_row(test, current) == pytest.approx(tuple(row), rel=1e-12)


@pytest.mark.parametrize(("current", "low", "high"), [(1.0, -1060, 510), (2.0, -1310, 730)])
def test_kwok_ranges_at_one_hertz_and_four_millimetres(current, low, high):
    test = sine_test(KwokTanh(f0_a=-257.0, f0_b=-18.0), 0.004, 1.0, current, 20.0)
    assert test.force[np.argmax(test.velocity)] == pytest.approx(high, rel=0.02)
    assert test.force[np.argmin(test.velocity)] == pytest.approx(low, rel=0.02)


def test_kwok_and_hong_agree_on_the_same_damper():
    kwok, hong = (sine_test(d, 0.004, 1.0, 1.0, 20.0) for d in (KwokTanh(), HongSigmoidGaussian()))
    assert hong.dissipated_energy == pytest.approx(kwok.dissipated_energy, rel=0.2)


def test_weng_crosses_zero_at_the_width_of_its_hysteresis():
    damper = WengArctangent(c0=(0.0,) * 4)
    width = 4.18e-3 + 5.43e-3 * 0.5
    assert damper.force(0.0, -width, 0.5, COLD, POSITIVE) == pytest.approx(0.0, abs=1e-9)
    assert damper.force(0.0, width, 0.5, COLD, NEGATIVE) == pytest.approx(0.0, abs=1e-9)


def test_the_envelope_of_yu2017_finds_the_peak_speed():
    # c1 = cI1 = 0 and a backbone of 1: the force is S(vm) alone.
    damper = Yu2017(c1=0.0, c2=1000.0, c3=-20.0, c_i1=0.0, d1=0.0, b1=-1e4, b2=-1e4)
    peak = 0.01 * 2 * math.pi
    test = sine_test(damper, 0.01, 1.0, 0.0, 20.0, cycles=10)
    expected = 1000.0 / (1.0 + math.exp(-20.0 * peak))
    assert np.max(test.force) == pytest.approx(expected, rel=0.03)


def test_the_branch_stands_for_the_sign_of_a_centred_displacement():
    assert branch((0.005,)) == pytest.approx(1.0, abs=1e-6)
    assert branch((-0.005,)) == pytest.approx(-1.0, abs=1e-6)
    omega, w, step, agrees = 2 * math.pi * 1.5, 0.0, 1e-3, []
    for k in range(6000):
        w += step * branch_rate(0.005 * omega * math.cos(omega * (k + 0.5) * step), (w,))[0]
        agrees.append(branch((w,)) * math.sin(omega * (k + 1) * step) > 0.0)
    assert np.mean(agrees[3000:]) > 0.95


class TestYu2019:
    """What Yu et al. 2019 state of their damper (figures 2 to 7)."""

    def test_a_third_of_force_and_energy_is_lost_from_20_to_80_degrees(self):
        cold, hot = (paper_test(Yu2019(), temperature=t) for t in (20.0, 80.0))
        assert 1.0 - hot.peak_force / cold.peak_force == pytest.approx(0.33, abs=0.005)
        assert 1.0 - hot.dissipated_energy / cold.dissipated_energy == pytest.approx(0.33, abs=0.005)

    def test_the_difference_from_the_symmetric_loop_grows_with_current(self):
        found = [np.max(np.abs(paper_test(Yu2019(), current=i).asymmetric_part)) for i in (0.0, 0.4, 0.8, 1.2)]
        assert np.all(np.diff(found) > 0.0)

    def test_the_difference_from_the_symmetric_loop_falls_with_temperature(self):
        found = [np.max(np.abs(paper_test(Yu2019(), temperature=t).asymmetric_part)) for t in (20.0, 40.0, 60.0, 80.0)]
        assert np.all(np.diff(found) < 0.0)

    def test_normalised_loops_are_almost_identical(self):
        tests = [paper_test(Yu2019(), current=i, temperature=t) for i in (0.0, 0.4, 0.8, 1.2) for t in (20.0, 80.0)]
        loops = np.array([test.force / test.peak_force for test in tests])
        assert np.max(np.sqrt(np.mean((loops - loops.mean(axis=0)) ** 2, axis=1))) < 0.02

    @pytest.mark.parametrize("current", [0.0, 0.4, 0.8, 1.2])
    def test_equivalent_damping(self, current):
        def damping(frequency=0.6, temperature=20.0, current=current):
            return paper_test(Yu2019(), 0.006, frequency, current, temperature).equivalent_damping

        assert damping(0.5) > damping(0.6) > damping(0.7)
        assert damping(temperature=20.0) > damping(temperature=50.0) > damping(temperature=80.0)
        assert current == 0.0 or damping() > damping(current=current - 0.4)

    def test_force_level_that_the_published_errors_imply(self):
        # RMSE 16.2 N at R2 = 0.9946 over all tests: a standard deviation of 220 N
        forces = [
            paper_test(Yu2019(), x, f, i, t).force
            for x in (0.004, 0.006, 0.008)
            for f in (0.5, 0.6, 0.7)
            for i in (0.0, 0.4, 0.8, 1.2)
            for t in (20.0, 40.0, 60.0, 80.0)
        ]
        assert np.std(forces) == pytest.approx(16.2 / math.sqrt(1.0 - 0.9946), rel=0.01)

    def test_rebound_is_stronger_than_compression(self):
        test = paper_test(Yu2019())
        assert 1.1 < np.max(test.force) / -np.min(test.force) < 1.25

    def test_without_its_asymmetric_part_the_loop_is_centrosymmetric_and_dissipates_the_same(self):
        whole, symmetric = paper_test(Yu2019()), paper_test(Yu2019(asymmetry=0.0))
        assert np.max(np.abs(symmetric.asymmetric_part)) < 1e-3
        assert symmetric.dissipated_energy == pytest.approx(whole.dissipated_energy, rel=1e-6)
        assert symmetric.force == pytest.approx(whole.force - whole.asymmetric_part, abs=0.05)

    def test_the_force_is_continuous_at_rest_and_where_the_rationals_end(self):
        damper, tiny = Yu2019(), 1e-9
        for v in (0.0, damper.held_from, -damper.held_from):
            sides = [damper.force(0.001, v + s, 1.2, COLD, POSITIVE) for s in (-tiny, tiny)]
            assert sides[0] == pytest.approx(sides[1], abs=1e-2)

    def test_the_branch_has_vanished_at_the_speed_of_a_seat(self):
        up, down = (Yu2019().force(0.0, 0.3, 1.2, COLD, z) for z in (POSITIVE, NEGATIVE))
        assert up == pytest.approx(down, rel=2e-3)

    def test_temperature_scales_viscous_elastic_and_yield_terms(self):
        specification = specification_of(Yu2019)
        assert specification.factors[:3] == (-0.00667,) * 3
        damper, scaling = Yu2019(alpha=(0.0, 0.0, 0.0)), TemperatureScaling(0.5, 0.25, 1.0)
        assert damper.force(0.0, 0.1, 0.0, scaling, POSITIVE) == pytest.approx(0.5 * 12.0)
        assert damper.force(0.1, 0.0, 0.0, scaling, POSITIVE) == pytest.approx(0.25 * 10.0)


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
