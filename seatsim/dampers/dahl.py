"""Dahl dampers: modified, with laws linear in the current, and viscous."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from seatsim.dampers.base import damper
from seatsim.dampers.bouc_wen_variants import NORMALISED
from seatsim.dampers.pieces import UTFSM, CurrentLaw, between, cubic
from seatsim.rig.state import State
from seatsim.rig.temperature import TemperatureScaling
from seatsim.schema.fields import param


@damper(
    "modified_dahl",
    source=f"Zhou and Qu 2002; form recalled; {UTFSM}",
    initial=(0.0,),
    state=NORMALISED,
    current_order=1,
    max_speed=0.13,
    max_current=1.0,
    temperatures=(20.0, 20.0),
    confidence="recalled",
)
class ModifiedDahl(NamedTuple):
    """Modified Dahl damper: spring, dashpot and Dahl friction with laws linear in the current.

        F  = k0 x + (c00 + c01 I) v + (Fd0 + Fd1 I) w + f0
        w' = sigma (v - |v| w),   |w| <= 1

    The form is recalled, not read in the paper, which writes the offset as -f0; it is dissipative.

    Defaults: derived by us from measurement, steady cycles of 2-25 mm and 0.5-5 Hz at 0-1 A, offset
    removed; rms error 24 N at 0 A to 155 N at 1 A, 11 % of the peak force. Valid to 0.13 m/s and 1 A.
    Temperature scales c00, c01 (viscous), k0 (elastic), Fd0 and Fd1 (yield).
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


@damper(
    "viscous_dahl",
    source="Ikhouane and Dyke 2007, Smart Mater. Struct. 16:605; form as in public code of UTFPR (Brazil, repository"
    f" labcontrol-data/mr-damper, MIT); {UTFSM}",
    initial=(0.0,),
    state=NORMALISED,
    max_speed=0.13,
    max_current=1.0,
    temperatures=(20.0, 20.0),
    confidence="published",
)
class ViscousDahl(NamedTuple):
    """Viscous Dahl damper: a dashpot beside Dahl friction.

        F  = kx(I) v + kw(I) w + f0
        w' = rho(I) (v - |v| w),   |w| <= 1

    Dissipative. The form is that of public code, not read in the paper; laws in the current are ours:
    kx and kw cubic, rho linear between zero current and `law_end`.

    Defaults: derived by us from measurement, steady cycles of 2-25 mm and 0.5-5 Hz at 0-1 A, offset
    removed; rms error 22 N at 0 A to 119 N at 1 A, 9 % of the peak force. Valid to 0.13 m/s and 1 A.
    Temperature scales kx (viscous) and kw (yield).
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
