"""The bounded-real certificate and the lower bounds."""

from dataclasses import replace

import numpy as np
import pytest

from controllers import synthesise
from controllers.synthesis.certify import certify, largest_lmi_eigenvalue
from controllers.synthesis.norm import hinf_norm
from controllers.synthesis.plant import MATRICES, GeneralisedPlant


def stable(plant, gain, margin=0.3):
    shift = (plant.close(gain).abscissa + margin) * np.eye(plant.order)
    return replace(plant, A=plant.A - shift)


def undriven(order):
    """A stable plant whose M is diagonal, with -2 for the states and -1 for w and z; and no gain."""
    n, none = np.eye(order), np.zeros((1, 1))
    return GeneralisedPlant(-n, 0 * n[:, :1], n[:, :1], 0 * n[:1], n[:1], none, none, none), none


@pytest.mark.parametrize("seed", range(8))
def test_proves_the_norm_and_nothing_below(random_plant, seed, conform):
    gain = np.random.default_rng(seed).standard_normal((2, 2))
    plant = stable(random_plant(seed), gain)
    loop = plant.close(gain)
    gamma = hinf_norm(loop).value
    proof = certify(plant, gain, gamma)
    claim = f"random plant {seed}: proven gamma over the norm, less 1"
    conform(claim, "bounded-real certificate", proof.gamma / gamma - 1, tolerance=1e-5)
    P = proof.matrix
    (A, B, C, D), g = loop, proof.gamma
    M = np.block([[A.T @ P + P @ A, P @ B, C.T], [B.T @ P, -g * np.eye(2), D.T], [C, D, -g * np.eye(3)]])
    assert np.linalg.eigvalsh(P)[0] > 0 > np.linalg.eigvalsh(M)[-1]
    assert certify(plant, gain, gamma * 0.93) is None
    assert largest_lmi_eigenvalue(plant, gain, proof.factor, gamma * 0.99) > 0
    assert largest_lmi_eigenvalue(plant, gain, 0 * proof.factor, gamma) == np.inf


@pytest.mark.parametrize("below", [0.0, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2])
@pytest.mark.parametrize(("seed", "order", "margin"), [(0, 2, 0.3), (1, 3, 0.3), (2, 2, 1e-6), (3, 2, 1e-9)])
def test_every_certificate_is_confirmed_in_fractions_however_little_is_missing(
    random_plant, exact_certificates, seed, order, margin, below
):
    gain = np.random.default_rng(seed).standard_normal((2, 2))
    plant = stable(random_plant(seed, n=order), gain, margin)
    norm = hinf_norm(plant.close(gain)).value
    proof = certify(plant, gain, norm * (1 - below))
    assert proof.gamma > norm and proof.largest_eigenvalue < 0 < proof.delta
    stated = {"factor": proof.factor.tolist(), "gamma": proof.gamma, "delta": proof.delta}
    loop = {"plant": {name: getattr(plant, name).tolist() for name in MATRICES}, "certificate": stated}
    assert exact_certificates.is_proven(gain.tolist(), loop)
    stated["gamma"] = norm * (1 - 1e-9)
    assert largest_lmi_eigenvalue(plant, gain, proof.factor, stated["gamma"]) >= 0
    assert not exact_certificates.is_proven(gain.tolist(), loop)


def test_a_factor_whose_inverse_is_lost_proves_nothing():
    # M < 0 whatever the factor, as nothing drives this plant; only P > 0 is in question.
    quiet, none = undriven(14)
    hilbert = 1.0 / (1.0 + np.add.outer(np.arange(14.0), np.arange(14.0)))
    assert largest_lmi_eigenvalue(quiet, none, np.eye(14), 1.0) < 0
    assert largest_lmi_eigenvalue(quiet, none, hilbert, 1.0) == np.inf
    assert largest_lmi_eigenvalue(quiet, none, np.full((14, 14), np.nan), 1.0) == np.inf


def test_certificate_survives_gains_that_cancel():
    # Two large gains nearly cancel in A + B2 K C2; in doubles the closed loop's slow pole would be lost.
    B2, C2 = np.array([[1.0, -1.0]]), np.ones((1, 1))
    plant = GeneralisedPlant([[-1.0]], [[1.0]], B2, [[1.0]], C2, [[0.0]], np.zeros((1, 2)), [[0.0]])
    proof = certify(plant, np.array([[1e16], [1e16]]), 1.0)
    assert proof.delta <= 1e-6


def test_bound_is_reached_where_the_whole_state_is_measured(conform):
    # x' = -x + w + u, z = (x, u), y = x: state feedback k gives 1/sqrt(2) at best, with k = -1.
    one, column = np.eye(1), np.zeros((2, 1))
    plant = GeneralisedPlant(-one, one, one, [[1], [0]], one, column, [[0], [1]], 0 * one)
    lines = []
    design = synthesise(plant, progress=lines.append)
    assert lines[0] == "searching" and lines[-1] == "the bound of any controller"
    for name, found, expected, tolerance in (
        ("gamma", design.gamma, np.sqrt(0.5), 1e-6),
        ("gain", design.gain[0, 0], -1.0, 1e-3),
        ("lower bound", design.lower_bound, np.sqrt(0.5), 1e-5),
    ):
        conform(f"x' = -x + w + u, z = (x, u), y = x: {name}", "closed form", found, expected, tolerance=tolerance)


@pytest.mark.parametrize("order", [1, 4])
def test_the_eigenvalue_is_raised_by_more_than_its_rounding(order):
    # The eigenvalues of a diagonal M are without any rounding.
    raised = largest_lmi_eigenvalue(*undriven(order), np.eye(order), 1.0) + 1.0
    rounding = (order + 2) * np.finfo(float).eps * 2.0
    assert 2.0 * rounding <= raised <= 20.0 * rounding
