"""H-infinity static output feedback of suspension displacement and velocity."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

import numpy as np
from pydantic import Field

from seatsim.control import Measurement, law
from seatsim.errors import InputError
from seatsim.fields import param
from seatsim.plant import Plant, state_space

if TYPE_CHECKING:
    from controllers.synthesis import Design, GeneralisedPlant

State = tuple[float, ...]
SOURCE = "Yu et al. 2019, eqs 15-19, on the exact plant and with u = +K y for the damper force"


Gain = Annotated[float, param("N/m or N s/m", "one entry of the gain", low=-1e9, high=1e9)]


class Weights(NamedTuple):
    """Weights of the performance output `z = (travel x, acceleration zc'')` (Yu et al. 2019, eq 17)."""

    travel: Annotated[float, param("1/s^2", "weight e1 of the suspension displacement", low=0, high=1e6)] = 22.6
    acceleration: Annotated[float, param("-", "weight e2 of the driver's acceleration", low=0, high=1e6)] = 1.0


class OutputFeedback(NamedTuple):
    """Compiled form of the law: `Fd = k1 x + k2 v`."""

    k1: float
    k2: float

    def wanted_force(self, y: Measurement, state: State) -> float:
        """Return the wanted damper force in N."""
        return self.k1 * y.displacement + self.k2 * y.velocity


@law("static_output_feedback", source=SOURCE)
class StaticOutputFeedback(NamedTuple):
    """Wanted force `Fd = gain . (x, v)`; the gain is stated, read from a saved design, or synthesised from weights.

    Exactly one of `gain` ([N/m, N s/m]), `design` (a file that `seatsim synthesise` wrote) and `weights` is given.
    """

    gain: Annotated[tuple[Gain, Gain] | None, Field(description="gain on (x, v) in N/m and N s/m")] = None
    design: Annotated[str | None, Field(description="path of a saved design")] = None
    weights: Annotated[Weights | None, Field(description="weights of a synthesis at the start of the run")] = None

    def prepared(self, plant: Plant) -> OutputFeedback:
        """Return the compiled form for a plant, after synthesis where weights are given."""
        if [self.gain, self.design, self.weights].count(None) != 2:
            raise InputError("give exactly one of 'gain', 'design' and 'weights'")
        if self.gain is not None:
            return OutputFeedback(float(self.gain[0]), float(self.gain[1]))
        from controllers.synthesis import Design

        gain = (Design.load(Path(self.design)) if self.design else self.synthesis(plant)).gain
        return OutputFeedback(float(gain[0, 0]), float(gain[0, 1]))

    def synthesis(self, plant: Plant) -> Design:
        """Return the H-infinity design for a plant with this law's weights (the default ones where none are given)."""
        from controllers.synthesis import synthesise

        return synthesise(generalised(plant, self.weights or Weights()))


def generalised(plant: Plant, weights: Weights) -> GeneralisedPlant:
    """Return the exact seat plant for synthesis: disturbance z0'', control Fd, output (x, v), z as in `Weights`."""
    from controllers.synthesis import GeneralisedPlant

    s = state_space(plant)
    c1 = s.C1 * [[weights.travel], [weights.acceleration]]
    nothing = np.zeros((2, 1))
    return GeneralisedPlant(s.A, s.B1, s.B2, c1, s.C2, nothing, nothing, nothing)
