"""What parameters off by up to the tolerance could explain of an effect.

By the contract a gap that the tolerance explains is no gap. So an effect counts here only where it stays material after
the best bounded refit of every nominal parameter, linear in the parameters: `min |g - J theta|`, `|theta| <= 1`.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import lsq_linear

from seatsim.blind.make.case import EXACT, ZERO_SCALE, Setting
from seatsim.blind.make.sizing import Bench, rms
from seatsim.blind.truth.rig import RATE
from seatsim.blind.truth.slots import Array
from seatsim.blind.truth.truth import Changes

TOLERANCE = 0.02
SECONDS = 12.0
"""Of each run that are looked at."""


class Absorption:
    """Sensitivities of the compared channels to each parameter of a setting, one tolerance up."""

    def __init__(self, setting: Setting, commands: list[Array]) -> None:
        self.bench = Bench(setting, [command[: round(SECONDS * RATE)] for command in commands])
        self.columns: list[dict[str, Array]] = []
        for name, value in setting.nominal.items():
            off = TOLERANCE * (value or ZERO_SCALE.get(name, 0.0))
            if name not in EXACT and off:
                column, _ = self.bench.change(Changes({name: setting.true[name] + off}), Changes())
                self.columns.append(column)

    def share_left(self, effect: Changes, others: Changes) -> float:
        """Return which share of an effect's materiality no refit inside the tolerance takes away."""
        change, scales = self.bench.change(effect, others)
        names = [name for name in change if all(name in column for column in self.columns)]
        if not names:
            return 1.0
        g = np.concatenate([change[name] / scales[name] for name in names])
        before = max(rms(change[name] / scales[name]) for name in names)
        if not np.all(np.isfinite(g)) or before < 0.2:
            return 1.0
        J = np.column_stack([np.concatenate([c[name] / scales[name] for name in names]) for c in self.columns])
        triangle = np.asarray(np.linalg.qr(np.column_stack([J, g]), mode="r"))
        theta = lsq_linear(triangle[:, :-1], triangle[:, -1], (-1.0, 1.0)).x
        left = np.split(g - J @ theta, len(names))
        return max(rms(part) for part in left) / before
