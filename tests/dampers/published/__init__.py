"""Published equations of every damper, written from their sources in plain numpy, without anything of seatsim.

A function is one damper. It takes the values `p` of its parameters, the operating point `m` and its states, and
returns the force in N, followed by the rates of its states. The states are those of the paper, such as the displacement
behind a spring, which need not be those of the model under test.

`m` has displacement `x`, velocity `v`, current `i`, the factors `viscous`, `elastic` and `plastic` by which
temperature scales these parts of the force (Yu et al. 2019, eqs 9-11), and `branch`, which stands for sgn(x) and
-sgn(v') wherever a paper has these: tanh(w / 0.5 mm) of the displacement w about its recent mean, w' = v - w / 1 s.

Each function says what is known of its equation: *published*, seen in print or public code; *recalled*, the form known
from the literature without the original at hand; *read*, a physical reading of an equation that could not be had;
*derived*, composed by the authors of the model.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

EQUATIONS: dict[str, Equation] = {}


class Equation(NamedTuple):
    """An equation with its states at rest and parameters that show each of its terms."""

    compute: Callable[..., tuple]
    rest: tuple[float, ...]
    parameters: dict[str, object]


def equation(name, rest=(), **parameters):
    """Enter a function; `parameters` differ from the model's defaults where these would hide a term."""

    def enter(compute):
        EQUATIONS[name] = Equation(compute, tuple(rest), parameters)
        return compute

    return enter
