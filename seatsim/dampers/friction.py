"""Friction that builds up over a travel: the dampers after Dahl, and the bristles of LuGre."""

from typing import Annotated, NamedTuple

from seatsim.dampers import State, TemperatureScaling, param
from seatsim.dampers.bouc_wen_variants import NORMALISED
from seatsim.dampers.pieces import CurrentLaw, between, cubic, utfsm_damper


@utfsm_damper("modified_dahl", initial=(0.0,), state=NORMALISED, current_order=1, confidence="recalled")
class ModifiedDahl(NamedTuple):
    """Modified Dahl damper: spring, dashpot and Dahl friction with laws linear in the current.

        F  = k0 x + (c00 + c01 I) v + (Fd0 + Fd1 I) w + f0
        w' = sigma (v - |v| w),   |w| <= 1

    The form is recalled, not read in the paper, which writes the offset as -f0; it is dissipative.

    Defaults: derived by us from measurement, steady cycles of 2-25 mm and 0.5-5 Hz at 0-1 A, offset
    removed; rms error 24 N at 0 A to 155 N at 1 A, 11 % of the peak force. Valid to 0.13 m/s and 1 A.
    Temperature scales c00, c01 (viscous), k0 (elastic), Fd0 and Fd1 (yield).

    Source: Zhou and Qu 2002; form recalled
    """

    k0: Annotated[float, param("N/m", "stiffness, of the gas accumulator", low=0)] = 350.0
    c00: Annotated[float, param("N s/m", "viscous damping at zero current", low=0)] = 1074.0
    c01: Annotated[float, param("N s/(m A)", "rise of the viscous damping with current", low=0)] = 5170.0
    fd0: Annotated[float, param("N", "friction Fd0 at zero current", low=0)] = 102.0
    fd1: Annotated[float, param("N/A", "rise Fd1 of the friction with current", low=0)] = 876.0
    sigma: Annotated[float, param("1/m", "slope of w from zero", low=150, high=1e6)] = 15300.0
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N."""
        smooth = self.k0 * scaling.stiffness * x + (self.c00 + self.c01 * i) * scaling.viscous * v
        return smooth + (self.fd0 + self.fd1 * i) * scaling.yield_force * z[0] + self.f0

    def rates(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> State:
        """Return (w',)."""
        return (self.sigma * (v - abs(v) * z[0]),)


@utfsm_damper("viscous_dahl", initial=(0.0,), state=NORMALISED)
class ViscousDahl(NamedTuple):
    """Viscous Dahl damper: a dashpot beside Dahl friction.

        F  = kx(I) v + kw(I) w + f0
        w' = rho(I) (v - |v| w),   |w| <= 1

    Dissipative. The form is that of public code, not read in the paper; laws in the current are ours:
    kx and kw cubic, rho linear between zero current and `law_end`.

    Defaults: derived by us from measurement, steady cycles of 2-25 mm and 0.5-5 Hz at 0-1 A, offset
    removed; rms error 22 N at 0 A to 119 N at 1 A, 9 % of the peak force. Valid to 0.13 m/s and 1 A.
    Temperature scales kx (viscous) and kw (yield).

    Source: Ikhouane and Dyke 2007, Smart Mater. Struct. 16:605; form as in public code of UTFPR (Brazil,
    repository labcontrol-data/mr-damper, MIT)
    """

    kx: Annotated[CurrentLaw, param("N s/m", "viscous damping kx(I)")] = (1062.0, 3490.0, 5170.0, -3600.0)
    kw: Annotated[CurrentLaw, param("N", "friction kw(I)")] = (105.0, 548.0, 1170.0, -855.0)
    rho0: Annotated[float, param("1/m", "slope of w from zero, at zero current", low=300, high=1e6)] = 29500.0
    rho1: Annotated[float, param("1/m", "the same at law_end", low=70, high=7e5)] = 6930.0
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0
    law_end: Annotated[float, param("A", "current beyond which the laws are held", above=0)] = 1.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N."""
        held = min(i, self.law_end)
        return cubic(self.kx, held) * scaling.viscous * v + cubic(self.kw, held) * scaling.yield_force * z[0] + self.f0

    def rates(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> State:
        """Return (w',)."""
        return (between(self.rho0, self.rho1, i, self.law_end) * (v - abs(v) * z[0]),)


_DEFLECTION = "w, deflection of the bristles over its bound, from -1 to 1"


@utfsm_damper("lugre_jimenez", initial=(0.0,), state=_DEFLECTION, confidence="recalled")
class LuGreJimenez(NamedTuple):
    """LuGre damper whose bristle force grows with the current and saturates, after Jimenez and Alvarez-Icaza.

        F  = V / {a0 (1 + a1 V)} w + sigma1 (v - |v| w) + sigma2 v + f0,   V = I + i0
        w' = sigma0 a0 (1 + a1 V) (v - |v| w),   |w| <= 1

    At constant current this is `F = sigma0 z V + sigma1 z' + sigma2 v`, `z' = v - sigma0 a0 |v| z (1 + a1 V)`,
    which is recalled, not read in the paper, and not surely. Ours: w is z over its bound at the present
    current, so that the force follows a changing current without overshoot and every term is dissipative;
    the current `i0` that stands for what friction there is at zero current.

    Defaults: derived by us from measurement, steady cycles of 2-25 mm and 0.5-5 Hz at 0-1 A, offset
    removed; rms error 25 N at 0 A to 192 N at 1 A, 12 % of the peak force. Valid to 0.13 m/s and 1 A.
    Temperature scales sigma1 and sigma2 (viscous) and the bristle force (yield).

    Source: Jimenez and Alvarez-Icaza 2005, Struct. Control Health Monit. 12:91; form recalled, unsurely
    """

    sigma0: Annotated[float, param("N/(m A)", "stiffness of the bristles per current", low=1e5, high=1e9)] = 1.2e7
    a0: Annotated[float, param("A/N", "current over yield force, small currents", low=1e-5, high=0.1)] = 8.33e-4
    a1: Annotated[float, param("1/A", "saturation of the yield force with current", low=2e-4, high=2)] = 0.02
    sigma1: Annotated[float, param("N s/m", "damping of the bristles", low=0)] = 6120.0
    sigma2: Annotated[float, param("N s/m", "viscous damping", low=0)] = 1420.0
    i0: Annotated[float, param("A", "current that stands for the friction at zero current", low=0)] = 0.068
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N."""
        level = i + self.i0
        bristles = level / (self.a0 * (1.0 + self.a1 * level)) * scaling.yield_force * z[0]
        return bristles + (self.sigma1 * (v - abs(v) * z[0]) + self.sigma2 * v) * scaling.viscous + self.f0

    def rates(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> State:
        """Return (w',)."""
        return (self.sigma0 * self.a0 * (1.0 + self.a1 * (i + self.i0)) * (v - abs(v) * z[0]),)


@utfsm_damper("lugre_sakai", initial=(0.0,), state=_DEFLECTION, current_order=1, confidence="recalled")
class LuGreSakai(NamedTuple):
    """LuGre damper after Sakai et al., linear in the current.

        F  = (fa + fb I) w + sigma1 (v - |v| w) + (sigma2 + sigmab I) v + f0
        w' = a0 (v - |v| w),   |w| <= 1

    This is `F = sigmaa z + sigma0 z V + sigma1 z' + sigma2 v + sigmab v V`, `z' = v - a0 |v| z` with w = a0 z,
    fa = sigmaa / a0, fb = sigma0 / a0, in the current instead of the voltage; recalled, not read in the paper.
    Every term is dissipative.

    Defaults: derived by us from measurement, steady cycles of 2-25 mm and 0.5-5 Hz at 0-1 A, offset
    removed; rms error 21 N at 0 A to 131 N at 1 A, 10 % of the peak force. Valid to 0.13 m/s and 1 A.
    Temperature scales sigma1, sigma2, sigmab (viscous), fa and fb (yield).

    Source: Sakai, Ohmori and Sano 2003; Terasawa et al. 2004 (IEEE CDC); form recalled
    """

    fa: Annotated[float, param("N", "bristle force at zero current", low=0)] = 106.0
    fb: Annotated[float, param("N/A", "rise of the bristle force with current", low=0)] = 888.0
    sigma1: Annotated[float, param("N s/m", "damping of the bristles", low=0)] = 6190.0
    sigma2: Annotated[float, param("N s/m", "viscous damping at zero current", low=0)] = 1000.0
    sigmab: Annotated[float, param("N s/(m A)", "rise of the viscous damping with current", low=0)] = 5100.0
    a0: Annotated[float, param("1/m", "inverse of the bound of the deflection", low=100, high=1e6)] = 9780.0
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N."""
        bristles = (self.fa + self.fb * i) * scaling.yield_force * z[0]
        slip = self.sigma1 * (v - abs(v) * z[0])
        return bristles + (slip + (self.sigma2 + self.sigmab * i) * v) * scaling.viscous + self.f0

    def rates(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> State:
        """Return (w',)."""
        return (self.a0 * (v - abs(v) * z[0]),)
