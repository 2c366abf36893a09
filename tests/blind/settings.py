from __future__ import annotations

import numpy as np

from seatsim.blind.make.case import CHANNELS, Setting, context_of, draw_setting, drive, read
from seatsim.blind.make.sizing import Bench
from seatsim.blind.truth.truth import Changes, Context


def small_setting(bingham: bool = False, warm: bool = True, scatter: float = 0.0) -> tuple[Setting, Context, Bench]:
    setting = draw_setting(np.random.default_rng(5), bingham, CHANNELS, warm, scatter)
    plain = [drive(setting, Changes(), k) for k in range(3)]
    context = context_of(setting, [read(setting, Changes(), k, plain[k]) for k in range(3)])
    return setting, context, Bench(setting, [motion.command for motion in plain])
