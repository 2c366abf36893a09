"""Dampers of elements in series, in the displacements x1, x2 of the nodes between the elements, as papers have them.

Where an ideal element has a force without a rate (a slider, an inertance), the models state how they make one: what
exceeds a limit relaxes within `SETTLING`, an inertance sits behind a dashpot of mass over `INERTANCE`.
"""

import numpy as np
from scipy.optimize import brentq

from . import equation
from .curves import law

SETTLING, INERTANCE = 1e-3, 2e-3


def past(q, limit):
    """What of a force lies beyond a limit, of its sign."""
    return np.sign(q) * np.maximum(np.abs(q) - limit, 0.0)


def held(p, m):
    return np.minimum(m.i, p.law_end)


@equation("modified_bingham", rest=[0.0], f0=30.0)
def modified_bingham(p, m, x1):
    """Wang and Liao 2011, eq 13 (published): F = c0 x1' + fc sgn(x1') + f0 = k1 (x - x1) + f0."""
    q = (p.k_a + p.k_b * held(p, m)) * m.elastic * (m.x - x1)
    return q + p.f0, past(q, law(p.fc, held(p, m)) * m.plastic) / (law(p.c0, held(p, m)) * m.viscous)


@equation("gamota_filisko", rest=[0.0, 0.0], f0=30.0, k1=4e5)
def gamota_filisko(p, m, x1, x2):
    """Gamota and Filisko 1991 (recalled): a Bingham element x1, a Kelvin element to x2, a spring to x."""
    q = (p.k2_a + p.k2_b * held(p, m)) * m.elastic * (m.x - x2)
    flow = past(q, law(p.fc, held(p, m)) * m.plastic) / (law(p.c0, held(p, m)) * m.viscous)
    return q + p.f0, flow, flow + (q - p.k1 * m.elastic * (x2 - x1)) / (p.c1 * m.viscous)


@equation("lumped_biviscous", rest=[0.0, 0.0], f0=30.0, m=3.0)
def lumped_biviscous(p, m, x1, u):
    """Sims et al. 2000 (recalled): m x1'' = k (x - x1) - Fb(x1'), the mass raised by SETTLING dFb/du."""
    pre, post = (law(c, held(p, m)) * m.viscous for c in (p.c_pre, p.c_post))
    fy = law(p.fy, held(p, m)) * m.plastic
    flows = np.abs(u) >= fy / (pre - post)
    flow, slope = np.where(flows, post * u + fy * np.sign(u), pre * u), np.where(flows, post, pre)
    q = (p.k_a + p.k_b * held(p, m)) * m.elastic * (m.x - x1)
    return q + p.f0, u, (q - flow) / (p.m * m.viscous + SETTLING * slope)


@equation("bingmax", rest=[0.0], f0=30.0)
def bingmax(p, m, x1):
    """Makris et al. 1996 (recalled): a spring to x1 and a dashpot behind it, beside friction."""
    spring = (p.k_a + p.k_b * held(p, m)) * m.elastic * (m.x - x1)
    friction = law(p.fy, held(p, m)) * m.plastic * np.sign(m.v)
    return spring + friction + p.f0, spring / (law(p.c, held(p, m)) * m.viscous)


@equation("maxwell_nonlinear_slider", rest=[0.0, 0.0], f0=30.0, m0=40.0)
def maxwell_nonlinear_slider(p, m, x1, u):
    """Chae et al. 2010, 2013 (recalled): a Maxwell element up to a + b |v|^n + m0 |v|' (braking) of a slider."""
    speed = np.abs(m.v)
    tangent = p.v_t**p.n + p.n * p.v_t ** (p.n - 1) * (speed - p.v_t)
    power = law(p.b, held(p, m)) * np.where(speed < p.v_t, tangent, speed**p.n)
    acceleration = (m.v - u) / INERTANCE
    braking = np.minimum(p.m0 * acceleration * np.clip(m.v / p.v_t, -1, 1), 0.0)
    limit = (power + braking) * m.viscous + law(p.a, held(p, m)) * m.plastic
    limit = np.maximum(limit, 0.0)
    k = (p.k_a + p.k_b * held(p, m)) * m.elastic
    spring = k * (m.x - x1)
    over = past(spring, limit)
    creep = spring / ((p.c_a + p.c_b * held(p, m)) * m.viscous)
    return spring - over + p.f0, creep + over / (k * SETTLING), acceleration


@equation("viscoelastic_plastic", rest=[0.0, 0.0], f0=30.0, m=15.0)
def viscoelastic_plastic(p, m, e, u):
    """Kamath and Wereley 1997 (read): shape functions of the speed share the velocity between solid and flow."""
    width = 4 * p.eps
    flow = 0.5 * (1 + np.tanh((np.abs(m.v) - p.v_y) / width))
    sign = 0.5 * (np.tanh((m.v - p.v_y) / width) + np.tanh((m.v + p.v_y) / width))
    spring = (p.k_a + p.k_b * held(p, m)) * m.elastic * e
    acceleration = (flow * m.v - u) / INERTANCE
    viscous = law(p.c, held(p, m)) * m.v + p.m * acceleration
    force = (1 - flow) * spring + flow * viscous * m.viscous + sign * law(p.fc, held(p, m)) * m.plastic + p.f0
    return force, (1 - flow) * m.v - spring / (law(p.c1, held(p, m)) * m.viscous), acceleration


@equation("li_viscoelastic_plastic", rest=[0.0, 0.0, 0.0], f0=30.0, R=15.0)
def li_viscoelastic_plastic(p, m, y, x2, u):
    """Li et al. 2000 (read): k1 beside k2 and c2 in series, on a slider y that yields at fc; flow past yield."""
    k1 = p.k_a + p.k_b * held(p, m)
    e1, e2 = m.x - y, m.x - y - x2
    f, fc = (k1 * e1 + p.k2 * e2) * m.elastic, law(p.fc, held(p, m)) * m.plastic
    share = np.minimum(np.abs(f) / fc, 1.0) ** 2
    acceleration = (share * m.v - u) / INERTANCE
    flow = share * (law(p.cv, held(p, m)) * m.v + p.R * acceleration) * m.viscous
    force = f - past(f, fc) + flow + p.fs * m.plastic * np.sign(m.v) + p.f0
    slide = past(f, fc) / ((k1 + p.k2) * m.elastic * SETTLING)
    return force, slide, p.k2 * m.elastic * e2 / (p.c2 * m.viscous), acceleration


@equation("stiffness_viscosity_elasto_slide", rest=[0.0], f0=30.0, k0=6000.0)
def stiffness_viscosity_elasto_slide(p, m, y):
    """Group of Wereley (recalled): F = k0 x + c0 v + Fe, Fe' = ke v below the force N_s at which y slides."""
    ke = (p.ke_a + p.ke_b * held(p, m)) * m.elastic
    over = past(ke * (m.x - y), law(p.n_s, held(p, m)) * m.plastic)
    smooth = p.k0 * m.elastic * m.x + law(p.c0, held(p, m)) * m.viscous * m.v
    return smooth + ke * (m.x - y) - over + p.f0, over / (ke * SETTLING)


@equation("hydro_mechanical", rest=[0.0, 0.0], f0=30.0, L=3e6, k_g=6000.0, fs=20.0)
def hydro_mechanical(p, m, volume, Q):
    """Hong et al. 2005 (read): C p' = A v - Q, L Q' = p - R Q - P_y sgn(Q); the volume that flowed is a state."""
    given = p.A * m.x - volume
    pressure = given / p.C * m.elastic
    R, yielding = law(p.R, held(p, m)) * m.viscous, law(p.P_y, held(p, m)) * m.plastic
    inertance = p.L * m.viscous + SETTLING * (R + yielding / p.Q_r / np.cosh(Q / p.Q_r) ** 2)
    force = p.A * pressure + p.k_g * m.elastic * m.x + p.fs * m.plastic * np.sign(m.v) + p.f0
    return force, Q, (pressure - R * Q - yielding * np.tanh(Q / p.Q_r)) / inertance


@equation("equivalent_oh_onoda", rest=[0.0], f0=30.0, ka=6000.0)
def equivalent_oh_onoda(p, m, y):
    """Oh and Onoda 2002 (read): a spring before friction and dashpot, beside accumulator and seal."""
    q = p.ks * m.elastic * (m.x - y)
    flow = past(q, law(p.fy, held(p, m)) * m.plastic) / (law(p.c, held(p, m)) * m.viscous)
    return q + p.ka * m.elastic * m.x + p.fs * m.plastic * np.sign(m.v) + p.f0, flow


@equation("ellis", rest=[0.0, 0.0], f0=30.0, k0=6000.0, half=4e-4)
def ellis(p, m, y, w):
    """Ellis fluid in series with a free play (derived): q / c_p + V (|q| / K)^(1/p) sgn q + (q - k_s d) / c_y = v."""
    if np.ndim(y):
        points = zip(*np.broadcast_arrays(m.x, m.v, m.i, m.branch, y, w), strict=True)
        at = (m._replace(x=a, v=b, i=c, branch=d) for a, b, c, d, _, _ in points)
        return (np.array([ellis(p, one, *z)[0] for one, z in zip(at, zip(y, w, strict=True), strict=True)]),)
    soft = 0.1 * p.half
    out = max(abs(y) - p.half, -soft)
    stop = p.k_s * m.elastic * np.sign(y) * (out if out > soft else (out + soft) ** 2 / (4 * soft))
    K, exponent = law(p.K, held(p, m)) * m.plastic, p.p_a + p.p_b * held(p, m)

    def play(q):
        return (q - stop) / (p.c_y * m.viscous)

    def excess(q):
        return q / (p.c_p * m.viscous) + 0.1 * np.sign(q) * (abs(q) / K) ** (1 / exponent) + play(q) - m.v

    bound = (abs(m.v) + abs(stop) / (p.c_y * m.viscous)) * p.c_y * m.viscous + 1.0
    q = brentq(excess, -bound, bound, xtol=1e-9, rtol=1e-13)
    viscous = law(p.c0, held(p, m)) * m.viscous * m.v
    force = q + viscous + p.f_s * m.plastic * w + p.k0 * m.elastic * m.x + p.f0
    return force, play(q), (m.v - abs(m.v) * w) / p.x_s
