"""Dampers with a hysteretic state: Bouc-Wen, Dahl, LuGre and the order parameter of a phase.

States that papers leave in units of their own are taken here as a displacement z = `SCALE` w, where the model under
test has w between -1 and 1.
"""

import numpy as np

from . import equation
from .curves import law

SCALE = 2.5e-3


def bouc_wen_rate(a, beta, gamma, n, r, z):
    """Wen 1976, Spencer et al. 1997 (published): z' = A r - beta r |z|^n - gamma |r| z |z|^(n-1)."""
    return a * r - beta * r * np.abs(z) ** n - gamma * np.abs(r) * z * np.abs(z) ** (n - 1)


@equation("bouc_wen", rest=[0.0], k0=4000.0, x0=0.004, f0=30.0, beta=700.0, gamma=1200.0, n=1.6)
def bouc_wen(p, m, z):
    """Spencer et al. 1997 (published): F = c0 v + k0 (x - x0) + alpha z + f0."""
    hysteretic = (p.alpha_a + p.alpha_b * m.i) * m.plastic * z
    force = (p.c_a + p.c_b * m.i) * m.viscous * m.v + p.k0 * m.elastic * (m.x - p.x0) + hysteretic + p.f0
    return force, bouc_wen_rate(p.A, p.beta, p.gamma, p.n, m.v, z)


@equation("simple_bouc_wen", rest=[0.0], f0=30.0)
def simple_bouc_wen(p, m, z):
    """Braz-Cesar and Barros 2012, eqs 2.2-2.3 (published)."""
    force = law(p.c0, m.i) * m.viscous * m.v + p.k0 * m.elastic * m.x + law(p.alpha, m.i) * m.plastic * z + p.f0
    return force, bouc_wen_rate(p.A, p.beta, p.gamma, p.n, m.v, z)


@equation("modified_bouc_wen", rest=[0.0, 0.0], f0=30.0, k0=60000.0, k1=4000.0, x0=0.004, law_end=0.8)
def modified_bouc_wen(p, m, y, z):
    """Spencer et al. 1997, eqs 2.4-2.6 of Braz-Cesar and Barros 2012 (published), F by its other identity."""
    c0, c1, alpha = (law(q, m.i, p.law_end) for q in (p.c0, p.c1, p.alpha))
    inner = alpha * m.plastic * z + p.k0 * m.elastic * (m.x - y)
    flow = (inner + c0 * m.viscous * m.v) / ((c0 + c1) * m.viscous)
    force = inner + c0 * m.viscous * (m.v - flow) + p.k1 * m.elastic * (m.x - p.x0) + p.f0
    return force, flow, bouc_wen_rate(p.A, p.beta, p.gamma, p.n, m.v - flow, z)


def saturating(p, q, i):
    """Dominguez et al. 2004 (recalled): a line up to the current Ic, an exponential rise beyond it."""
    q0, q1, q2, q3 = (getattr(p, f"{q}_{k}") for k in range(4))
    return np.where(i > p.i_c, q1 - q2 * np.expm1(-q3 * (i - p.i_c)), q0 + (q1 - q0) * i / p.i_c)


def normalised(rho, sigma, n, r, z):
    """Ikhouane and Dyke 2007 (published in public code), w = z / SCALE."""
    w = z / SCALE
    return SCALE * rho * (r - sigma * np.abs(r) * np.abs(w) ** (n - 1) * w + (sigma - 1) * r * np.abs(w) ** n)


def dominguez(p, m, z):
    """F = c v + k x + alpha w and the rate of z, of both models."""
    c, alpha = saturating(p, "c", m.i), saturating(p, "alpha", m.i)
    force = c * m.viscous * m.v + p.k * m.elastic * m.x + alpha * m.plastic * z / SCALE
    return force, normalised(p.stiffness / alpha, p.sigma, p.n, m.v, z)


@equation("current_dependent_bouc_wen", rest=[0.0], f0=30.0, k=5000.0)
def current_dependent_bouc_wen(p, m, z):
    """Dominguez et al. 2004 (recalled), the hysteresis normalised with one stiffness S at all currents."""
    force, rate = dominguez(p, m, z)
    return force + p.f0, rate


SLOW = [0.0, 0.5e-4, 0.5 * (2e-2 * np.pi) ** 2, 0.0]
"""Mean and mean squares of a motion of 1 cm at 1 Hz, and no hysteresis."""


@equation("frequency_dependent_bouc_wen", rest=SLOW, f0=30.0, k=5000.0, d2=-0.3, d4=0.4)
def frequency_dependent_bouc_wen(p, m, d, s, r, z):
    """Dominguez et al. 2006 (read): powers of frequency W and amplitude X, from mean squares over one second."""
    force, rate = dominguez(p, m, z)
    # A motion whose mean square is small against 1e-10 m^2 has no frequency: it counts as 1 Hz.
    W = np.sqrt((r + 1e-10 * (2 * np.pi) ** 2) / (s + 1e-10)) / (2 * np.pi)
    X = np.sqrt(2 * s) / 0.01
    factor = np.clip(W, 0.1, 15.0) ** p.d2 * np.clip(X, 0.1, 2.5) ** p.d4
    return factor * force + p.f0, m.v - d, d**2 - s, m.v**2 - r, rate


@equation("shear_bouc_wen", rest=[0.0], f0=30.0, sigma=4.0)
def shear_bouc_wen(p, m, z):
    """Jansen and Dyke 2000, Ikhouane and Dyke 2007 (recalled): F = kx v + kw w."""
    rho = np.interp(m.i, [0.0, p.law_end], [p.rho0, p.rho1])
    force = law(p.kx, m.i, p.law_end) * m.viscous * m.v + law(p.kw, m.i, p.law_end) * m.plastic * z / SCALE
    return force + p.f0, normalised(rho, p.sigma, p.n, m.v, z)


@equation("large_scale_bouc_wen", rest=[0.0, 0.0], f0=30.0, k=5000.0, n=1.3, m=40.0)
def large_scale_bouc_wen(p, m, z, u):
    """Yang et al. 2004 (recalled): F = alpha z + k x + a1 exp{-(a2 |v|)^p} v + m a, m behind a dashpot m / 2 ms."""
    rho = np.interp(m.i, [0.0, p.law_end], [p.rho0, p.rho1])
    acceleration = (m.v - u) / 2e-3
    flow = law(p.a1, m.i, p.law_end) * np.exp(-((p.a2 * np.abs(m.v)) ** p.p)) * m.v + p.m * acceleration
    hysteretic = law(p.alpha, m.i, p.law_end) * m.plastic * z / SCALE
    force = flow * m.viscous + p.k * m.elastic * m.x + hysteretic + p.f0
    return force, normalised(rho, p.sigma, p.n, m.v, z), acceleration


@equation("nonsymmetrical_bouc_wen", rest=[0.0], f0=30.0, k=5000.0, mu=0.004, sigma=4.0)
def nonsymmetrical_bouc_wen(p, m, z):
    """Kwok et al. 2007 (recalled): z' = {A - |z|^n [gamma + beta sgn(z r)]} r, r = v - mu."""
    rho, r = np.interp(m.i, [0.0, p.law_end], [p.rho0, p.rho1]), m.v - p.mu
    A, gamma, beta = rho * SCALE, rho * (1 - p.sigma) * SCALE ** (1 - p.n), rho * p.sigma * SCALE ** (1 - p.n)
    force = law(p.c, m.i, p.law_end) * m.viscous * m.v + p.k * m.elastic * m.x + p.f0
    force = force + law(p.alpha, m.i, p.law_end) * m.plastic * z / SCALE
    return force, (A - np.abs(z) ** p.n * (gamma + beta * np.sign(z * r))) * r


@equation("modified_dahl", rest=[0.0], f0=30.0, k0=5000.0)
def modified_dahl(p, m, z):
    """Zhou and Qu 2002 (recalled): F = k0 x + c0 v + Fd Z, Z' = sigma v (1 - Z sgn v)."""
    hysteretic = (p.fd0 + p.fd1 * m.i) * m.plastic * z / SCALE
    force = p.k0 * m.elastic * m.x + (p.c00 + p.c01 * m.i) * m.viscous * m.v + hysteretic + p.f0
    return force, p.sigma * m.v * (SCALE - z * np.sign(m.v))


@equation("viscous_dahl", rest=[0.0], f0=30.0)
def viscous_dahl(p, m, z):
    """Ikhouane and Dyke 2007 (published in public code): F = kx v + kw w, w' = rho (v - |v| w)."""
    rho = np.interp(m.i, [0.0, p.law_end], [p.rho0, p.rho1])
    force = law(p.kx, m.i, p.law_end) * m.viscous * m.v + law(p.kw, m.i, p.law_end) * m.plastic * z / SCALE
    return force + p.f0, rho * (SCALE * m.v - np.abs(m.v) * z)


@equation("lugre_jimenez", rest=[0.0], f0=30.0, a1=0.8)
def lugre_jimenez(p, m, w):
    """Jimenez and Alvarez-Icaza 2005 (recalled): F = sigma0 z V + sigma1 z' + sigma2 v.

    z' = v - sigma0 a0 |v| z (1 + a1 V). At constant V this is so for z = w / bound; the model holds w while V changes,
    which is its own.
    """
    V = m.i + p.i0
    bound = 1 / (p.sigma0 * p.a0 * (1 + p.a1 * V))
    z = bound * w
    slip = m.v - p.sigma0 * p.a0 * np.abs(m.v) * z * (1 + p.a1 * V)
    force = p.sigma0 * z * V * m.plastic + (p.sigma1 * slip + p.sigma2 * m.v) * m.viscous + p.f0
    return force, slip / bound


@equation("lugre_sakai", rest=[0.0], f0=30.0)
def lugre_sakai(p, m, z):
    """Sakai et al. 2003 (recalled): F = sigma_a z + sigma_0 z V + sigma_1 z' + sigma_2 v + sigma_b v V."""
    sigma_a, sigma_0 = p.fa * p.a0, p.fb * p.a0
    slip = m.v - p.a0 * np.abs(m.v) * z
    viscous = p.sigma1 * slip + p.sigma2 * m.v + p.sigmab * m.v * m.i
    return (sigma_a + sigma_0 * m.i) * z * m.plastic + viscous * m.viscous + p.f0, slip


@equation("phase_transition", rest=[0.0], f0=30.0, c=(250.0, 300.0, 200.0, 50.0))
def phase_transition(p, m, q):
    """Wang and Kamath 2006 (read): q' = {v / (0.1 m/s) - a q - (1 - a) q^5} / tau, F = c v + fy q."""
    tau = np.interp(m.i, [0.0, p.law_end], [p.tau0, p.tau1])
    force = law(p.c, m.i, p.law_end) * m.viscous * m.v + law(p.fy, m.i, p.law_end) * m.plastic * q
    return force + p.f0, (10 * m.v - p.a * q - (1 - p.a) * q**5) / tau
