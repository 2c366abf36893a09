"""Mechanisms taken out of a nominal that was identified with them: the recording stays as measured."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping

import numpy as np
from numpy.random import Generator

from seatsim.blind.carrier.change import Altered, Change
from seatsim.blind.carrier.injections.coil import commanded
from seatsim.blind.carrier.recorded import Carrier, Content, number, section

FASTEST = 3000.0
"""1/s; a coil that is faster follows at once."""
PRELOADS = ("f0",)
"""Parameters of dampers that are a gas preload by another name."""


def draw_removals(carrier: Carrier, rng: Generator) -> list[Change]:
    """Return the nominal without each effect that it states, and without the preload of its damper."""
    stated = carrier.nominal.get("effects") or []
    effects = [entry for entry in stated if isinstance(entry, Mapping)] if isinstance(stated, list) else []
    found = [_without_effect(carrier, effects, k) for k in range(len(effects))]
    return found + [_without_preload(carrier, key) for key in PRELOADS if _parameter(carrier, key)]


def _parameter(carrier: Carrier, key: str) -> float:
    return number(section(section(carrier.nominal, "damper"), "parameters").get(key, 0.0))


def _without_effect(carrier: Carrier, effects: list[Mapping[str, object]], k: int) -> Change:
    parameters = {name: number(value) for name, value in section(effects[k], "parameters").items()}
    named = {name: value for name, value in parameters.items() if np.isfinite(value)}
    channel = str(section(effects[k], "parameters").get("channel", ""))
    left: Content = {**carrier.nominal, "effects": [dict(e) for e in effects[:k] + effects[k + 1 :]]}
    altered = Altered(dataclasses.replace(carrier, nominal=left), named)
    return Change(str(effects[k]["effect"]), "removed from the nominal", channel, (1.0, 1.0), lambda _: altered)


def _without_preload(carrier: Carrier, key: str) -> Change:
    damper = section(carrier.nominal, "damper")
    left = {**damper, "parameters": {**section(damper, "parameters"), key: 0.0}}
    altered = Altered(
        dataclasses.replace(carrier, nominal={**carrier.nominal, "damper": left}),
        {"preload": _parameter(carrier, key)},
    )
    return Change("damper.gas_spring", "preload removed from the nominal", "", (1.0, 1.0), lambda _: altered)


def draw_faster_coils(carrier: Carrier, rng: Generator) -> list[Change]:
    """Return a nominal that believes in a faster coil than was identified, so that the rig's lags behind it.

    The recorded command cannot be sharpened in its stead: a switched one would leave the range of the supply.
    """
    command = commanded(carrier)
    coil = section(carrier.nominal, "actuator")
    rate = number(coil.get("rate", 130.0))
    if command is None or not any(np.ptp(table[command]) > 0.0 for table in carrier.tables.values()):
        return []
    longest = 1.0 / rate - 1.0 / FASTEST

    def alter(amount: float) -> Altered:
        faster = {**carrier.nominal, "actuator": {**coil, "rate": float(f"{1.0 / (1.0 / rate - amount):.6g}")}}
        return Altered(dataclasses.replace(carrier, nominal=faster), {"time": amount})

    return [Change("coil.lag", "coil of the nominal made faster", "", (0.0, longest), alter)] if longest > 0.0 else []
