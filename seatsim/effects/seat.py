"""Effects of the seat: linkage, end stops and springs, cushion, driver, and what no channel of the floor records."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

import numpy as np

from seatsim.effects.base import FRICTIONS, Form, buffer, dahl_rate, effect
from seatsim.kernel.rig import SeatMotion
from seatsim.rig.plant import Plant
from seatsim.rig.state import State
from seatsim.schema.arrays import Array
from seatsim.schema.fields import param


@effect("suspension.friction", source="Coulomb's law; with presliding Dahl 1968", initial=(0.0,), forms=FRICTIONS)
class Friction(NamedTuple):
    """Rate-independent friction in the linkage, not seen by the damper's load cell.

    `f = force z / (1 + lubrication |v|)` with `z' = v (1 - z sgn v) / presliding`. Without presliding f is set-valued:
    `force sgn(v)`, and at v = 0 whatever holds the suspension, up to `force`.
    """

    force: Annotated[float, param("N", "friction of the linkage", low=0, high=2e3)]
    presliding: Annotated[float, param("m", "travel over which friction builds up; 0: none", low=0, high=0.02)] = 0.0
    lubrication: Annotated[float, param("s/m", "fall of friction with speed (Stribeck)", low=0, high=200)] = 0.0

    def linkage_friction(self, z: State) -> float:
        """Return the set-valued friction in N."""
        return self.force if self.presliding <= 0.0 else 0.0

    def suspension_force(self, plant: Plant, x: float, v: float, z: State) -> float:
        """Return the friction in N that builds up over a travel."""
        return self.force * z[0] / (1.0 + self.lubrication * abs(v)) if self.presliding > 0.0 else 0.0

    def rates(self, plant: Plant, motion: SeatMotion, z: State) -> State:
        """Return z'."""
        return (dahl_rate(self.presliding, motion.v, z[0]),)


@effect(
    "suspension.progressive_spring",
    source="odd terms of a hardening spring's series; a helper spring that comes to bear",
    forms=(
        {"rise": 300.0},
        {"rise": 4000.0},
        {"rise": 300.0, "skew": 1.0},
        {"rise": 4000.0, "skew": 1.0},
        {"helper": 0.5, "reach": 0.01},
        {"helper": 4.0, "reach": 0.01},
    ),
)
class ProgressiveSpring(NamedTuple):
    """Stiffness that grows with travel: `f = kf x (1 + skew x + rise x^2)`, and a helper spring beside it.

    The helper adds `kf helper (sqrt(x^2 + reach^2) - reach) sgn x`: nothing at small travel, `helper` times the
    stiffness beyond the travel `reach`.
    """

    rise: Annotated[float, param("1/m^2", "rise of the spring force per squared travel", low=0, high=1e5)] = 0.0
    skew: Annotated[float, param("1/m", "relative rise per travel, in extension only", low=-100, high=100)] = 0.0
    helper: Annotated[float, param("-", "stiffness of a helper spring over the spring's", low=0, high=100)] = 0.0
    reach: Annotated[float, param("m", "travel over which it comes to bear", low=0, high=0.5)] = 0.0

    def suspension_force(self, plant: Plant, x: float, v: float, z: State) -> float:
        """Return the spring force beyond `kf x` in N."""
        helper = math.copysign(self.helper * (math.sqrt(x * x + self.reach * self.reach) - self.reach), x)
        return plant.suspension_stiffness * (x * x * (self.skew + self.rise * x) + helper)


@effect(
    "suspension.end_stop",
    source="unilateral spring with Hunt-Crossley damping, k d (1 + c d')",
    off={"low": -1.0, "high": 1.0, "power": 1.0},
    forms=(
        Form(
            {"low": -0.012, "high": 0.012, "stiffness": 10000.0, "damping": 0.5, "power": 1.0},
            within={"stiffness": (5000.0, 1e6)},
        ),
    ),
)
class EndStop(NamedTuple):
    """Buffers at the ends of the travel.

    `f = stiffness d (d / 10 mm)^(power - 1) (1 + damping d')`, never pulling, where d is the depth beyond `low` or
    `high`; power 1 is a linear buffer. A diagnosis takes one that is softer than a seat's spring for a helper spring.
    """

    low: Annotated[float, param("m", "travel at which the lower buffer is touched", low=-1, high=0)]
    high: Annotated[float, param("m", "travel at which the upper buffer is touched", low=0, high=1)]
    stiffness: Annotated[float, param("N/m", "stiffness of a buffer", low=0, high=1e7)] = 60000.0
    damping: Annotated[float, param("s/m", "Hunt-Crossley damping", low=0, high=100)] = 0.5
    power: Annotated[float, param("-", "exponent of the buffer's law", low=1, high=3)] = 1.0

    def plant(self, plant: Plant) -> Plant:
        """Return the seat with its travel between the buffers, beyond which its end stops are met."""
        return plant._replace(travel=(self.low, self.high)) if self.stiffness > 0.0 else plant

    def suspension_force(self, plant: Plant, x: float, v: float, z: State) -> float:
        """Return the force of the buffers in N, positive against extension."""
        if self.stiffness <= 0.0:
            return 0.0
        if x > self.high:
            return buffer(self.stiffness, self.damping, self.power, x - self.high, v)
        if x < self.low:
            return -buffer(self.stiffness, self.damping, self.power, self.low - x, -v)
        return 0.0


@effect(
    "cushion.hardening",
    source="series of a foam's compression curve about the seated position",
    forms=(
        {"rise": 40.0},
        Form({"rise": 40.0, "bend": 2e3}, sizes=2),
        Form({"rise": 40.0, "loss": 40.0}, sizes=2),
        Form({"rise": 20.0, "bend": 500.0}, {"unload": 1.0}, sizes=2),
    ),
)
class Hardening(NamedTuple):
    """Foam that stiffens under compression: with d = -xc > 0 the force grows by `kc d (rise d + bend d^2)`.

    Its damping grows too, by `cc loss d`. Under extension it gives way by `kc xc s / (1 + s)`, s = unload rise xc.
    """

    rise: Annotated[float, param("1/m", "relative rise of stiffness with compression", low=0, high=2e3)]
    bend: Annotated[float, param("1/m^2", "relative rise with its square", low=0, high=1e6)] = 0.0
    loss: Annotated[float, param("1/m", "relative rise of damping with compression", low=0, high=2e3)] = 0.0
    unload: Annotated[float, param("-", "fall under extension over rise under compression", low=0, high=10)] = 0.0

    def cushion_force(self, force: float, plant: Plant, xc: float, vc: float, z: State) -> float:
        """Return the cushion's force in N, positive in tension."""
        if xc >= 0.0:
            softer = self.unload * self.rise * xc
            return force - plant.cushion_stiffness * xc * softer / (1.0 + softer)
        stiffer = plant.cushion_stiffness * xc * xc * (self.rise - self.bend * xc)
        return force - stiffer - plant.cushion_damping * self.loss * xc * vc


@effect(
    "cushion.separation",
    source="unilateral contact",
    off={"limit": 1e9},
    forms=({"limit": 250.0}, {"limit": 100.0, "held": 0.5}, {"limit": 150.0, "width": 100.0}),
)
class Separation(NamedTuple):
    """A driver who partly lifts off: of tension beyond `limit` only the share `held` is transmitted.

    Foam that comes off little by little rounds the corner: with e = F - limit,
    `F - (1 - held) (e + width)^2 / (4 width)` for |e| <= width.
    """

    limit: Annotated[float, param("N", "largest tension about the seated position", low=0, high=1e9)]
    held: Annotated[float, param("-", "share of tension beyond the limit", low=0, high=1)] = 0.0
    width: Annotated[float, param("N", "half-width of the round corner", low=0, high=1e4)] = 0.0

    def cushion_force(self, force: float, plant: Plant, xc: float, vc: float, z: State) -> float:
        """Return the cushion's force in N, positive in tension."""
        beyond = force - self.limit
        if abs(beyond) < self.width:
            return force - (1.0 - self.held) * (beyond + self.width) ** 2 / (4.0 * self.width)
        return force if force <= self.limit else self.limit + self.held * (force - self.limit)


@effect("driver.mass", source="weighing", forms=({"change": 4.0}, {"change": -4.0}))
class Mass(NamedTuple):
    """An occupant heavier or lighter than the plant states."""

    change: Annotated[float, param("kg", "added mass", low=-150, high=150)]

    def plant(self, plant: Plant) -> Plant:
        """Return the plant with the other driver."""
        return plant._replace(driver_mass=max(1.0, plant.driver_mass + self.change))


@effect(
    "driver.biodynamics",
    source="one sprung mass within the body; resonance of 4-6 Hz as in ISO 5982",
    initial=(0.0, 0.0),
    off={"frequency": 5.0, "damping": 0.3},
    forms=(Form({"share": 0.2, "frequency": 5.0, "damping": 0.3}, within={"frequency": (3.0, 8.0)}),),
)
class Biodynamics(NamedTuple):
    """A body with an inner resonance: the `share` of the driver's mass hangs on a spring and dashpot within it.

    `xi'' = -(2 pi frequency)^2 xi - 2 damping (2 pi frequency) xi' - zc''`, xi relative to the pelvis; the pelvis
    carries the force of the inner mass and is lighter by it. In a recording the resonance is sought from 3 to 8 Hz.
    """

    share: Annotated[float, param("-", "share of the mass that is sprung", low=0, high=0.95)]
    frequency: Annotated[float, param("Hz", "natural frequency of the inner mass", above=0, high=30)] = 5.0
    damping: Annotated[float, param("-", "damping ratio of the inner mass", low=0, high=3)] = 0.3

    def inner_mass(self, plant: Plant, z: State) -> float:
        """Return the sprung mass in kg."""
        return self.share * plant.driver_mass

    def inner_force(self, plant: Plant, z: State) -> float:
        """Return the upward force of the inner mass on the pelvis in N."""
        omega = 2.0 * math.pi * self.frequency
        return self.share * plant.driver_mass * omega * (omega * z[0] + 2.0 * self.damping * z[1])

    def rates(self, plant: Plant, motion: SeatMotion, z: State) -> State:
        """Return the rates of inner displacement and velocity."""
        omega = 2.0 * math.pi * self.frequency
        restoring = omega * (omega * z[0] + 2.0 * self.damping * z[1])
        return (z[1], -restoring - motion.driver) if self.share > 0.0 else (0.0, 0.0)


@effect(
    "floor.unmeasured_input",
    source="a random force of flat spectrum in a band, and a tone",
    off={"low": 0.5, "high": 20.0, "frequency": 10.0},
)
class UnmeasuredInput(NamedTuple):
    """A force on the frame that no channel records: random between two frequencies, and a tone.

    A recording determines its spectrum only; the random part is drawn from the scenario's seed.
    """

    rms: Annotated[float, param("N", "RMS of the random force", low=0, high=1e5)]
    low: Annotated[float, param("Hz", "lowest frequency of the random force", above=0, high=1e3)] = 0.5
    high: Annotated[float, param("Hz", "highest frequency of the random force", above=0, high=1e3)] = 20.0
    tone: Annotated[float, param("N", "amplitude of the tone", low=0, high=1e5)] = 0.0
    frequency: Annotated[float, param("Hz", "frequency of the tone", above=0, high=1e3)] = 10.0
    phase: Annotated[float, param("rad", "phase of the tone at time zero", low=-10, high=10)] = 0.0

    def frame_force(self, time: Array, seed: int) -> Array:
        """Return the force on the frame in N at times of equal distance in s, shape (N,)."""
        steady = self.tone * np.sin(2.0 * math.pi * self.frequency * time + self.phase)
        if self.rms <= 0.0 or len(time) < 2:
            return steady
        spectrum = np.fft.rfft(np.random.default_rng(seed).standard_normal(len(time)))
        frequency = np.fft.rfftfreq(len(time), time[1] - time[0])
        noise = np.fft.irfft(np.where((frequency >= self.low) & (frequency <= self.high), spectrum, 0.0), len(time))
        spread = float(np.std(noise))
        return steady + (self.rms / spread * noise if spread > 0.0 else 0.0)
