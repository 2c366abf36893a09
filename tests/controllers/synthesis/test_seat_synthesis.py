"""The seat problem: known optima, certificate, structure, what the gain can and cannot change."""

import numpy as np
import pytest

from controllers.synthesis import SEAT_TIME_BUDGET, synthesise
from controllers.synthesis.certify import largest_lmi_eigenvalue
from controllers.synthesis.norm import grid_norm, hinf_norm
from controllers.synthesis.plant import GeneralisedPlant
from seatsim.rig.plant import Plant, state_space

OPTIMA = {10.0: (1.0681900, [-1937.2, 2013.9]), 30.0: (1.1359585, [967.0, 2339.1]), 50.0: (1.1848133, [3268.6, 2613.3])}
# From the Riccati equations in 60 digits, with control and noise weights of 1e-7; e1 = 10 from the LMI.
FULL_ORDER = {10.0: 1.0000889, 30.0: 1.0007985, 50.0: 1.0022106}
STATED = {10.0: (3.838, 1.110), 30.0: (4.423, 1.194), 50.0: (5.408, 1.477)}


@pytest.mark.parametrize("e1", OPTIMA)
def test_reaches_the_optimum_and_proves_it(seat, designed, e1, conform):
    design = designed(e1)
    loop = seat(e1).close(design.gain)
    gamma, gain = OPTIMA[e1]
    claim = f"static output feedback of the seat, e1 {e1:g}"
    conform(f"{claim}: gamma", "optimum, derived apart", design.gamma, gamma, tolerance=1e-6 * gamma)
    for k, unit in enumerate(("N/m", "N s/m")):
        each, tolerance = f"{claim}: gain {k + 1}, {unit}", 2e-4 * abs(gain[k])
        conform(each, "optimum, derived apart", design.gain[0, k], gain[k], tolerance=tolerance)
    for norm, way in ((grid_norm, "grid of frequencies"), (hinf_norm, "Hamiltonian bisection")):
        deviation = norm(loop).value / design.gamma - 1
        conform(f"{claim}: relative deviation of the loop's norm from gamma", way, deviation, tolerance=1e-6)
    assert design.worst.poles.real.max() < 0
    proof = design.certificate
    conform(f"{claim}: proven gamma over gamma, less 1", "bounded-real certificate", proof.delta, tolerance=1e-6)
    assert proof.gamma == pytest.approx(design.gamma * (1 + proof.delta), rel=1e-12)
    assert proof.largest_eigenvalue < 0
    assert largest_lmi_eigenvalue(seat(e1), design.gain, proof.factor, proof.gamma) == proof.largest_eigenvalue
    assert design.worst.norms_agree
    bound, way = FULL_ORDER[e1], "Riccati equations in 60 digits"
    conform(f"{claim}: lower bound", way, design.lower_bound, bound, tolerance=1e-5 * bound)


@pytest.mark.parametrize("e1", OPTIMA)
def test_norms_of_stated_gains(seat, e1, conform):
    for gain, stated in zip(([0.0, 0.0], [2.0, 2147.6]), STATED[e1], strict=True):
        norm = hinf_norm(seat(e1).close([gain])).value
        conform(f"norm of the seat with the gain {gain}, e1 {e1:g}", "derived apart", norm, stated, tolerance=5e-4)


def test_the_same_seed_gives_the_same_design(seat, designed):
    first, second = designed(10.0), synthesise(seat(10.0), time_budget=SEAT_TIME_BUDGET)
    np.testing.assert_array_equal(first.gain, second.gain)
    assert first.gamma == second.gamma


def test_damper_alone_keeps_the_stiffness_gain_at_zero(seat):
    design = synthesise(seat(30.0, structure=[[False, True]]))
    assert design.gain[0, 0] == 0
    # One gain left: the minimum along it, by scanning.
    scan = [hinf_norm(seat(30.0).close([[0.0, k2]])).value for k2 in np.arange(1000.0, 3000.0, 5.0)]
    assert design.gamma == pytest.approx(min(scan), rel=1e-5)
    assert design.gamma <= min(scan)


def test_respects_the_largest_gain(seat):
    design = synthesise(seat(50.0), max_gain=1500.0)
    assert np.abs(design.gain).max() <= 1500.0
    assert design.gain[0, 1] == pytest.approx(1500.0, rel=1e-6)
    assert design.gamma > OPTIMA[50.0][0] * 1.01


def test_matrices_plant_and_state_space_agree(seat, designed):
    control = pytest.importorskip("control")
    p = seat(30.0)
    D = np.block([[p.D11, p.D12], [p.D21, np.zeros((2, 1))]])
    system = control.ss(p.A, np.hstack([p.B1, p.B2]), np.vstack([p.C1, p.C2]), D)
    of_matrices = synthesise(p.A, p.B1, p.B2, p.C1, p.C2, p.D11, p.D12, p.D21, time_budget=SEAT_TIME_BUDGET)
    of_system = synthesise(system, split=(1, 2), time_budget=SEAT_TIME_BUDGET)
    assert len({design.gain.tobytes() for design in (designed(30.0), of_matrices, of_system)}) == 1


def test_one_gain_for_drivers_of_50_to_120_kg(seat, conform):
    plants = [seat(50.0, m=m) for m in np.linspace(50.0, 120.0, 15)]
    design = synthesise(plants, time_budget=SEAT_TIME_BUDGET)
    claim = "one gain for drivers of 50 to 120 kg: gamma"
    conform(claim, "optimum, derived apart", design.gamma, 1.24271, tolerance=1.3e-5)
    np.testing.assert_allclose(design.gain, [[4887.9, 3213.3]], rtol=1e-3)
    norms = [hinf_norm(plant.close(design.gain)).value for plant in plants]
    np.testing.assert_allclose([loop.gamma for loop in design.loops], norms, rtol=1e-9)
    assert design.worst is design.loops[-1]
    assert all(loop.certificate.delta <= 1e-4 for loop in design.loops)
    assert 1.0 < design.lower_bound <= design.gamma


def test_published_gain_is_near_the_optimum_at_the_weight_that_fits_it(seat, designed):
    published = hinf_norm(seat(22.6).close([[2.0, 2147.6]])).value
    assert 1.0 < published / designed(22.6).gamma < 1.001


def test_the_printed_design_problem_has_no_solution():
    # Eq 15 with z0'' and zs'' as outside disturbances: the infimum is that of any controller, at infinite gain.
    s = state_space(Plant(20.0, 80.0, 4600.0, 200.0, 60000.0, 1500.0), "yu2019")
    C1, none = s.C1 * [[10.0], [1.0]], np.zeros((2, 2))
    plant = GeneralisedPlant(s.A, s.B1, s.B2, C1, s.C2, none, none[:, :1], none)
    small, large = (synthesise(plant, max_gain=limit) for limit in (1e3, 1e4))
    assert np.abs(small.gain).max() > 0.99e3 and np.abs(large.gain).max() > 0.99e4
    assert small.gamma > large.gamma > large.lower_bound == pytest.approx(1.82311, abs=1e-5)
