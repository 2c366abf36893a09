"""Effects of the cushion: foam that hardens, a driver who lifts off."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from seatsim.effects.base import Form, effect
from seatsim.rig.plant import Plant
from seatsim.rig.state import State
from seatsim.schema.fields import param


@effect(
    "cushion.hardening",
    source="series of a foam's compression curve about the seated position",
    forms=(
        {"rise": 40.0}, Form({"rise": 40.0, "bend": 2e3}, sizes=2), Form({"rise": 40.0, "loss": 40.0}, sizes=2),
        Form({"rise": 20.0, "bend": 500.0}, {"unload": 1.0}, sizes=2),
    ),
)  # fmt: skip
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
