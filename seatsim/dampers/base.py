"""Definition of a damper: a record of parameters with `force` and, where it has a state, `rates`.

    def force(self, x, v, i, scaling, z):   force in N, positive when it opposes extension
    def rates(self, x, v, i, scaling, z):   time derivative of the state z (a tuple of floats)
    def coulomb(self, i, scaling):          magnitude in N of a set-valued friction beside `force` (optional)

with x [m], v = x' [m/s], current i [A], and `scaling` the factors of the temperature by which the model multiplies its
viscous, elastic and yield terms (`seatsim.rig.temperature.TemperatureScaling`). Methods are compiled by numba: plain
arithmetic and `math` only; what they call from their module is decorated with `seatsim.compilation.jit.jit`.
"""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable
from typing import Literal, NamedTuple, Protocol, TypeVar

from seatsim.kernel.generic import DamperModel
from seatsim.rig.state import State
from seatsim.rig.temperature import TemperatureFactors
from seatsim.schema.errors import InputError
from seatsim.schema.registry import Record, Registry, is_own
from seatsim.schema.text import split_source

_T = TypeVar("_T", bound=type)

Confidence = Literal["published", "recalled", "reading", "derived"]
OWN = "own"
CONFIDENCE: dict[str, str] = {
    "published": "equation and source were seen in print or in public code",
    "recalled": "the form is known from the literature, not checked against the original",
    "reading": "a sound physical reading, because the original's equation could not be had",
    "derived": "composed here",
    OWN: "from a file or package of the user's own; nothing was checked here",
}
"""How closely a model's equation follows its source; the docstring states the origin of parameters and changes."""


class Damper(DamperModel, Record, Protocol):
    """A damper model as a record of parameters; see the module for the optional methods."""


class DamperSpecification(NamedTuple):
    """Specification of a damper model.

    initial: state at rest. current_order: degree (1 or 2) of `force` as a polynomial in the current at fixed
    motion and state, 0 where it is none; it decides whether the inverse has a closed form. centred: the
    model branches on sgn(x) or sgn(dv/dt), so that it is wrong where the motion is not centred about x = 0.
    The ranges of speed [m/s], current [A] and temperature [degC] are those of the data behind it, without limit where
    they are not stated. complete: the model is a form without a parameter set of its own; a scenario states all of its
    parameters. confidence: a word of `CONFIDENCE`. fixed: fields that an identification does not fit, beside `law_end`:
    they state the model's range, or no data tell them from the others.
    """

    source: str
    initial: State = ()
    state: str = ""
    current_order: int = 0
    centred: bool = False
    max_speed: float = math.inf
    max_current: float = math.inf
    temperatures: tuple[float, float] = (-273.15, math.inf)
    factors: TemperatureFactors = TemperatureFactors()
    complete: bool = False
    confidence: Confidence = "published"
    fixed: tuple[str, ...] = ()


DAMPERS: Registry[Damper, DamperSpecification] = Registry("damper")
"""All damper models by name."""


def find_confidence(cls: type) -> str:
    """Return the word of `CONFIDENCE` for a model; one that is not part of seatsim is never `published`."""
    return OWN if is_own(cls) else DAMPERS.specification_of(cls).confidence


def damper(
    name: str,
    source: str = "",
    initial: State = (),
    state: str = "",
    current_order: int = 0,
    centred: bool = False,
    max_speed: float = 1.0,
    max_current: float = 2.0,
    temperatures: tuple[float, float] = (20.0, 80.0),
    factors: TemperatureFactors | None = None,
    complete: bool = False,
    confidence: Confidence = "published",
    fixed: tuple[str, ...] = (),
    defaults: str = "",
) -> Callable[[_T], _T]:
    """Register a record class as the damper `model: name`; see `DamperSpecification` for the facts.

    `factors` are the temperature factors that a scenario may leave out, none where they are not given. Where `source`
    is not given it is the last paragraph of the class's docstring, `Source: ...`; `defaults` adds where its defaults
    come from.

    Raises:
        InputError: the class lacks a method that a damper has.
    """
    ranges = max_speed, max_current, temperatures
    stated = factors or TemperatureFactors()

    def check_and_enter(cls: _T) -> _T:
        for method in ("force", "rates") if initial else ("force",):
            if not callable(getattr(cls, method, None)):
                has = "a state at rest (initial=...) and " if method == "rates" else ""
                raise InputError(
                    f"damper '{name}': has {has}no method {method}(self, x, v, i, scaling, z); see seatsim new damper"
                )
        origin = "; ".join(filter(None, (source or split_source(inspect.getdoc(cls) or "")[1], defaults)))
        specification = DamperSpecification(
            origin, initial, state, current_order, centred, *ranges, stated, complete, confidence, fixed
        )
        return DAMPERS.register(name, specification)(cls)

    return check_and_enter
