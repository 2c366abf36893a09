"""Floor acceleration of earth-moving machines: the spectral classes EM1 to EM9 of ISO 7096.

    G(f) = A * |HP(f)|^2 * |LP(f)|^2   in (m/s^2)^2/Hz, one-sided
    |HP|^2 = 1/(1 + (fh/f)^(2 nh)),  |LP|^2 = 1/(1 + (f/fl)^(2 nl))      (Butterworth, n poles)

inside 0.89 to 11.22 Hz (EM1-EM4, EM7) or 0.89 to 17.78 Hz (EM5, EM6, EM8, EM9), and nothing outside.

Source: ISO 7096:2000, the constants as the HVLab HRV toolbox of ISVR codes them; the standard's own text was
not read. EM5 has a first-order low-pass: only that gives its stated 1.94 m/s^2. For EM7 the stated 2.26 m/s^2
is used.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Annotated, Literal, NamedTuple

import numpy as np

from seatsim.excitations.base import Duration, Floor, choice, excitation
from seatsim.excitations.motion import check_step, integrated_twice, motion_of, random_phase, samples, soft_start
from seatsim.schema.arrays import Array
from seatsim.schema.fields import read_packaged

SpectralClass = Literal["EM1", "EM2", "EM3", "EM4", "EM5", "EM6", "EM7", "EM8", "EM9"]
LOWEST = 0.89
# Shorter runs are cut from ten seconds, which hold nine periods of the lowest tone.
_LEAST_PERIOD = 10.0


class _EarthMover(NamedTuple):
    """One spectral class: level A, corners (Hz) and poles, upper end (Hz), rms (m/s^2).

    `seat` and `transmissibility` are what ISO 7096 accepts: the greatest SEAT factor, and the greatest transmissibility
    at resonance in the damping test. `machines` are what the class stands for.
    """

    level: float
    high_pass: float
    high_poles: int
    low_pass: float
    low_poles: int
    highest: float
    rms: float
    seat: float
    transmissibility: float
    machines: str


CLASSES = read_packaged(Path(__file__).with_name("iso7096.yaml"), dict[SpectralClass, _EarthMover])


@excitation("iso7096", source="ISO 7096:2000, spectral classes EM1 to EM9 (constants as in the HVLab HRV toolbox)")
class Iso7096(NamedTuple):
    """Random floor acceleration of one spectral class of earth-moving machinery.

    A sum of tones of random phase whose amplitudes carry the class's spectrum exactly; velocity and
    displacement are its integrals, without drift because the band ends at 0.89 Hz. Faded in from rest over
    the first second.
    """

    spectral_class: Annotated[SpectralClass, choice("ISO 7096 spectral class, 'EM1' to 'EM9'")]
    duration: Duration

    def floor(self, step: float, seed: int) -> Floor:
        """Return the motion of the floor.

        Raises:
            InputError: `step` holds fewer than five samples of the band's highest frequency.
        """
        highest = CLASSES[self.spectral_class].highest
        check_step("iso7096", step, highest, per_period=5)
        count = samples(self.duration, step)
        size = max(count - 1, round(_LEAST_PERIOD / step))
        period = size * step
        density = partial(acceleration_density, spectral_class=self.spectral_class)
        acceleration = random_phase(density, LOWEST, highest, period, seed)
        return soft_start(step, motion_of(integrated_twice(acceleration, period), step, size, count))


def acceleration_density(frequency: Array, spectral_class: SpectralClass) -> Array:
    """Return G(f) of a class in (m/s^2)^2/Hz, shape of `frequency` in Hz; zero outside its band."""
    c = CLASSES[spectral_class]
    f = np.asarray(frequency, dtype=float)
    inside = (f >= LOWEST) & (f <= c.highest)
    g = c.level / (1 + (c.high_pass / np.where(inside, f, 1.0)) ** (2 * c.high_poles))
    return np.where(inside, g / (1 + (f / c.low_pass) ** (2 * c.low_poles)), 0.0)
