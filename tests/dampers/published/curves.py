"""Dampers whose force is a curve of the velocity: Bingham, bi-viscous, and S-curves that the branch shifts."""

import numpy as np
from numpy.polynomial.polynomial import polyval
from scipy.interpolate import PchipInterpolator
from scipy.special import expit

from . import equation


def law(coefficients, i, end=np.inf):
    """A polynomial in the current, lowest power first, held beyond `end`."""
    return polyval(np.minimum(i, end), coefficients)


def sgn_of(v, width):
    return np.tanh(v / width)


@equation("bingham", f0=30.0, v_ref=0.01)
def bingham(p, m):
    """Stanway et al. 1987 (published): F = c v + fc sgn(v) + f0, the sign regularised."""
    fc = (p.fc_a + p.fc_b * m.i) * sgn_of(m.v, p.v_ref)
    return ((p.c_a + p.c_b * m.i) * m.viscous * m.v + fc * m.plastic + p.f0,)


@equation("original_bingham", f0=30.0)
def original_bingham(p, m):
    """Braz-Cesar and Barros 2012, eqs 9-11 (published): the sign itself."""
    return (law(p.c0, m.i) * m.viscous * m.v + law(p.fc, m.i) * m.plastic * np.sign(m.v) + p.f0,)


@equation("updated_bingham", f0=30.0, fc=(60.0, 90.0, 130.0, -110.0))
def updated_bingham(p, m):
    """Occhiuzzi et al. 2003 (read): F = C(I, |v|) v + fc sgn(v) + f0, shear thinning C = c0 (1 + |v|/vs)^(p-1)."""
    thin = np.exp((p.p - 1.0) * np.log1p(np.abs(m.v) / p.v_s))
    fc = law(p.fc, m.i, p.law_end) * np.sign(m.v)
    return (law(p.c0, m.i, p.law_end) * thin * m.viscous * m.v + fc * m.plastic + p.f0,)


@equation("powell", f0=30.0, k=6000.0)
def powell(p, m):
    """Powell 1994 (recalled): F = k x + c v + [fc + (fs - fc) exp(-a |v|)] tanh(e v)."""
    fc = law(p.fc, m.i, p.law_end)
    friction = fc + (p.r * fc - fc) * np.exp(-p.a * np.abs(m.v))
    viscous = law(p.c, m.i, p.law_end) * m.v
    return (p.k * m.elastic * m.x + viscous * m.viscous + friction * m.plastic * np.tanh(p.e * m.v) + p.f0,)


@equation("biviscous", f0=30.0)
def biviscous(p, m):
    """Wereley et al. 1998 (recalled): three straight lines that meet at +-vy = fy / (c_pre - c_post)."""
    pre, post = (law(c, m.i, p.law_end) * m.viscous for c in (p.c_pre, p.c_post))
    fy = law(p.fy, m.i, p.law_end) * m.plastic
    vy = fy / (pre - post)
    return (np.select([m.v >= vy, m.v <= -vy], [post * m.v + fy, post * m.v - fy], pre * m.v) + p.f0,)


@equation("hysteretic_biviscous", f0=30.0)
def hysteretic_biviscous(p, m):
    """Wereley et al. 1998 (recalled), v' > 0: c_pre (v - v0) from -v1 to v2; mirrored for v' < 0."""
    pre, post = (law(c, m.i, p.law_end) * m.viscous for c in (p.c_pre, p.c_post))
    fy = law(p.fy, m.i, p.law_end) * m.plastic
    v0 = -m.branch * (p.v0_a + p.v0_b * np.minimum(m.i, p.law_end))
    v1, v2 = (fy - pre * v0) / (pre - post), (fy + pre * v0) / (pre - post)
    return (np.select([m.v <= -v1, m.v >= v2], [post * m.v - fy, post * m.v + fy], pre * (m.v - v0)) + p.f0,)


def arctangent(m, c, fy, k, v0, f0):
    """F = c v + (2/pi) fy arctan{k [v - v0 sgn(v')]} + f0, with -sgn(v') the branch."""
    return (c * m.viscous * m.v + fy * m.plastic * np.arctan(k * (m.v + v0 * m.branch)) / (np.pi / 2) + f0,)


@equation("hysteretic_arctangent", f0=30.0)
def hysteretic_arctangent(p, m):
    """Table 2.1 of Braz-Cesar and Barros 2012 names it (recalled): Weng's form with a steepness of the current."""
    i = np.minimum(m.i, p.law_end)
    k = np.interp(i, [0.0, p.law_end], [p.k_0, p.k_1])
    return arctangent(m, law(p.c_post, i), law(p.fy, i), k, p.v0_a + p.v0_b * i, p.f0)


@equation("weng_arctangent", f0=30.0)
def weng_arctangent(p, m):
    """Weng et al., eq 12 of Braz-Cesar and Barros 2012 (published)."""
    c, fc, v_h = (law(q, m.i, p.law_end) for q in (p.c0, p.fc, p.v_h))
    return arctangent(m, c, fc, p.k_h, v_h, p.f0)


@equation("kwok_tanh", f0_a=30.0, f0_b=20.0)
def kwok_tanh(p, m):
    """Kwok et al. 2006 (recalled): F = c v + k x + alpha tanh{beta v + delta sgn(x)} + f0."""
    i = np.minimum(m.i, p.law_end)
    curve = np.tanh(p.beta * m.v + (p.delta_a + p.delta_b * i) * m.branch)
    smooth = (p.c_a + p.c_b * i) * m.viscous * m.v + (p.k_a + p.k_b * i) * m.elastic * m.x
    return (smooth + law(p.alpha, i) * m.plastic * curve + p.f0_a + p.f0_b * i,)


# Hong et al., tables 1 and 2 (published): columns a [kN], b [kN], c [1/u], sigma [u], r [kN u] at six currents.
HONG = {
    1: """-.24 -.13 6.00 .60 .07 | .05 -.59 6.43 .35 .15 | .32 -1.13 5.60 .28 .32
        | .52 -1.52 5.11 .28 .45 | .60 -1.70 5.20 .28 .51 | .87 -2.22 4.83 .30 .65""",
    2: """-.22 -.12 4.75 .50 .04 | .03 -.59 5.56 .29 .15 | .32 -1.18 4.40 .36 .30
        | .53 -1.57 3.85 .35 .45 | .74 -1.86 5.64 .22 .45 | 1.00 -2.49 3.06 .38 .72""",
}


@equation("hong_sigmoid_gaussian", test=2, offset_share=0.4)
def hong_sigmoid_gaussian(p, m):
    """Hong et al., eqs 4, 6, 7 (published; the sign of eq 7 reversed): F = a + b / (1 + e^cv) - sgn(v') D."""
    table = [[float(word) for word in row.split()] for row in HONG[p.test].split("|")]
    rows = PchipInterpolator([0.0, 0.25, 0.5, 0.75, 1.0, 2.0], table)(np.clip(m.i, 0.0, 2.0))
    units = np.array([1, 1, 1e-3, 1e-3, 1]).reshape(-1, *[1] * np.ndim(m.i))
    a, b, c, sigma, r = np.moveaxis(1e3 * rows, -1, 0) * units
    u = m.v / p.v_unit
    sigmoid, density = a + b * expit(-c * u), np.exp(-(u**2) / (2 * sigma**2)) / np.sqrt(2 * np.pi * sigma**2)
    offset = a + b / 2
    return ((sigmoid - offset + m.branch * r * density) * m.plastic + p.offset_share * offset,)


@equation("sigmoid_gaussian", f0=30.0, c0=(300.0, 200.0, 100.0, 50.0))
def sigmoid_gaussian(p, m):
    """The form of Hong et al. (published) about its middle, with cubic laws and a dashpot."""
    s, r, c0 = (law(q, m.i, p.law_end) for q in (p.s, p.r, p.c0))
    sigmoid = -s + 2 * s * expit(m.v / p.v_c)
    gaussian = r * np.exp(-(m.v**2) / (2 * p.sigma**2))
    return ((sigmoid + m.branch * gaussian) * m.plastic + c0 * m.viscous * m.v + p.f0,)


def envelope_rate(v, e):
    """The peak speed of a cycle, followed: up within 10 ms, down within 2 s (ours, for both models that need it)."""
    speed = np.abs(v)
    return np.where(speed > e, (speed - e) / 0.01, (speed - e) / 2.0)


@equation("sigmoid", rest=[0.0], f0=30.0)
def sigmoid(p, m, e):
    """Ma, Wang, Rakheja and Su 2002-2007 (recalled), vm the followed peak speed e."""
    ft = p.ft0 * (1 + np.exp(p.a1 * e)) * (1 + p.k2 * expit(p.a2 * (m.i + p.i0)))
    vh = m.branch * p.k4 * e * (1 + p.k3 * expit(p.a3 * (m.i + p.i1)))
    q = np.exp(-p.a0 / (1 + p.k0 * e) * (m.v + vh))
    force = ft * (1 - q) / (1 + q) * (m.plastic + p.kv * m.viscous * np.abs(m.v)) + p.f0
    return force, envelope_rate(m.v, e)


@equation("yu2017", rest=[0.0], d2=0.01)
def yu2017(p, m, e):
    """Yu et al. 2017 as eq 5 of Yu et al. 2019 (published; |v| in the Gaussian)."""
    height = p.c1 + p.c2 * expit(-p.c3 * e) + p.c_i1 * np.exp(p.c_i2 * m.i)
    speed = np.abs(m.v)
    backbone = -np.expm1(p.b1 * speed) * expit(-p.b2 * speed) * np.sign(m.v)
    shape = backbone + p.d1 * np.exp(-((speed - p.d2) ** 2) / p.d3) * m.branch
    return height * m.plastic * shape, envelope_rate(m.v, e)


YU2019 = {"p": (0.01, 3586.0, 1.298e6), "p_den": (14600.0, 1.18e6, 900.0), "n": (0.01, 19.17, 7.0, 4140.0)}
YU2019 |= {"q": (0.612, 0.2, 14.4, 3.0, 2.0, 1.0, 30.0), "q_den": (0.1, 137.7, 0.5, 50.0, 1.0, 9137.0)}


@equation("yu2019", f0=30.0, asymmetry=0.6, **YU2019)
def yu2019(p, m):
    """Yu et al. 2019, eqs 1-4, 9-12 (published; coefficients of numerator and denominator apart, sgn(x) of eq 12)."""

    def rational(top, bottom, u):
        return polyval(u, top) / polyval(u, [1.0, *bottom])

    def shape(side, v, branch):
        u = np.clip(v, -p.held_from, p.held_from) / p.v_ref
        s = np.abs(u)
        f_ba = np.where(side > 0, rational(p.p, p.p_den, s**2), -rational(p.n, p.n_den, s))
        return f_ba + rational(p.q, p.q_den, u) * branch

    side = np.where(m.v >= 0, 1, -1)
    here, mirrored = shape(side, m.v, m.branch), shape(-side, -m.v, -m.branch)
    whole = (here - mirrored) / 2 + p.asymmetry * (here + mirrored) / 2
    linear = law(p.c, m.i) * m.viscous * m.v + law(p.k, m.i) * m.elastic * m.x
    return (linear + law(p.alpha, m.i) * m.plastic * whole + p.f0,)
