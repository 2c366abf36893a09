"""Forces added to what a load cell measured, and a play between the recorded motion and the damper's."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.random import Generator

from seatsim.blind.carrier.readings import commanded
from seatsim.blind.carrier.recorded import (
    Altered,
    Carrier,
    Change,
    Table,
    low_pass,
    number,
    section,
    slide,
    slope,
    with_tables,
)
from seatsim.schema.arrays import Array

_LARGEST = 1.5
"""Of a force, in standard deviations of the recorded one."""
_TRAVELS = (2e-5, 1.5e-4)
"""m; sliding travel of a seal, drawn log-uniform."""
_CROSSED = (0.08, 0.2)
"""Share of the spread of the force at which a gap is crossed; less would need a motion faster than any recorded."""
_LEAST_LEVELS, _STANDING = 3, 0.03
"""Levels of the current that tell a saturation from another yield force, and the share of the rows that makes one."""
_REFERENCE, _LEAST_WARMING = 20.0, 10.0
"""degC at which a damper has its stated forces; K by which it must warm, else a fade is a smaller force throughout."""
_Forces = Callable[[Table], Array]


def draw_damper_changes(carrier: Carrier, rng: Generator) -> list[Change]:
    """Return the changes of the damper that a bench with a load cell allows."""
    if carrier.rig != "damper_bench" or "damper_force" not in carrier.channels:
        return []
    found = [_seal_friction(carrier, rng), _gas_spring(carrier, rng), _preload(carrier, rng)]
    found += [_asymmetry_by_force(carrier, rng), _asymmetry_by_speed(carrier, rng), _free_play(carrier, rng)]
    return found + _saturation(carrier) + _fade(carrier)


def _spread(carrier: Carrier) -> float:
    return float(np.std(carrier.pooled("damper_force")))


def _added(carrier: Carrier, force: _Forces) -> Carrier:
    return with_tables(carrier, lambda table: {**table, "damper_force": table["damper_force"] + force(table)})


def _seal_friction(carrier: Carrier, rng: Generator) -> Change:
    """Return Coulomb friction `F sgn v`, with the small travel over which a real seal begins to slide."""
    size, travel = _spread(carrier), float(np.exp(rng.uniform(*np.log(_TRAVELS))))

    def alter(amount: float) -> Altered:
        added = _added(carrier, lambda table: amount * size * slide(table["displacement"], travel))
        return Altered(added, {"force": amount * size})

    return Change("damper.seal_friction", "F sgn v", "", (0.0, _LARGEST), alter)


def _gas_spring(carrier: Carrier, rng: Generator) -> Change:
    """Return preload and stiffness of a gas volume, both of about the same force."""
    size, travel = _spread(carrier), float(np.std(carrier.pooled("displacement")))
    share, sign = float(rng.uniform(0.4, 1.0)), -1.0 if rng.random() < 0.5 else 1.0

    def alter(amount: float) -> Altered:
        stiffness, preload = amount * size / travel, sign * share * amount * size
        added = _added(carrier, lambda table: preload + stiffness * (table["displacement"] - table["displacement"][0]))
        return Altered(added, {"preload": preload, "stiffness": stiffness})

    return Change("damper.gas_spring", "preload and stiffness", "", (0.0, _LARGEST), alter)


def _preload(carrier: Carrier, rng: Generator) -> Change:
    size = (-1.0 if rng.random() < 0.5 else 1.0) * _spread(carrier)

    def alter(amount: float) -> Altered:
        return Altered(_added(carrier, lambda table: np.asarray(amount * size)), {"preload": amount * size})

    return Change("damper.gas_spring", "preload", "", (0.0, _LARGEST), alter)


def _asymmetry_by_force(carrier: Carrier, rng: Generator) -> Change:
    """Return push and pull of the damper scaled apart; continuous, since the scale changes where the force is zero."""
    sign, middle = -1.0 if rng.random() < 0.5 else 1.0, float(np.mean(carrier.pooled("damper_force")))

    def alter(amount: float) -> Altered:
        return Altered(_added(carrier, lambda t: sign * amount * np.abs(t["damper_force"] - middle)), {})

    return Change("damper.asymmetry", "by the sign of the force", "", (0.0, 0.8), alter)


def _asymmetry_by_speed(carrier: Carrier, rng: Generator) -> Change:
    """Return extension and compression scaled apart, one turning into the other over a speed."""
    sign, middle = -1.0 if rng.random() < 0.5 else 1.0, float(np.mean(carrier.pooled("damper_force")))
    width = float(rng.uniform(0.1, 0.4)) * float(np.std(np.concatenate([_speed(carrier, t) for t in _tables(carrier)])))

    def side(table: Table) -> Array:
        v = _speed(carrier, table) / width
        return v / np.sqrt(1.0 + v**2)

    def alter(amount: float) -> Altered:
        return Altered(_added(carrier, lambda t: sign * amount * side(t) * (t["damper_force"] - middle)), {})

    return Change("damper.asymmetry", "by the sign of the speed", "", (0.0, 0.8), alter)


def _tables(carrier: Carrier) -> list[Table]:
    return list(carrier.tables.values())


def _speed(carrier: Carrier, table: Table) -> Array:
    return table["velocity"] if "velocity" in table else slope(table["displacement"], carrier.step)


def _free_play(carrier: Carrier, rng: Generator) -> Change:
    """Return a play in series: the same force, a recorded motion that runs ahead of the damper's by half a gap.

    The gap is crossed where the force is a small share of its spread, since behind it every mount yields.
    """
    soft = float(rng.uniform(*_CROSSED)) * _spread(carrier)
    travel = float(np.std(carrier.pooled("displacement")))

    def alter(amount: float) -> Altered:
        gap = amount * travel

        def played(table: Table) -> Table:
            across = np.clip(table["damper_force"] / soft, -1.0, 1.0)
            ahead = 0.5 * gap * (1.5 * across - 0.5 * across**3)
            moved = {**table, "displacement": table["displacement"] + ahead - ahead[0]}
            return moved | ({"velocity": table["velocity"] + slope(ahead, carrier.step)} if "velocity" in table else {})

        return Altered(with_tables(carrier, played), {"gap": gap})

    return Change("damper.free_play", "motion shifted", "", (0.0, 1.0), alter)


def _saturation(carrier: Carrier) -> list[Change]:
    """Return a yield force that grows ever less with current: that part of the force is scaled by `1 / (1 + i / i_s)`.

    The part that depends on the current is told from the rest by the nominal's own shares of it.
    """
    command, yields = commanded(carrier), _yield_shares(section(section(carrier.nominal, "damper"), "parameters"))
    if command is None or yields is None:
        return []
    gain = number(section(carrier.header, "actuator").get("gain", 1.0)) if command == "command_voltage" else 1.0
    rate = number(section(carrier.nominal, "actuator").get("rate", 130.0))
    fixed, by_current, viscous, viscous_by_current = yields
    middle = float(np.mean(carrier.pooled("damper_force")))
    if len(_levels(carrier.pooled(command))) < _LEAST_LEVELS:
        return []

    def lost(table: Table, bend: float) -> Array:
        i = np.clip(low_pass(gain * table[command], 1.0 / rate, carrier.step), 0.0, None)
        yielding = table["damper_force"] - middle - (viscous + viscous_by_current * i) * _speed(carrier, table)
        return -yielding * (by_current * i / (fixed + by_current * i)) * (bend * i / (1.0 + bend * i))

    def alter(amount: float) -> Altered:
        return Altered(_added(carrier, lambda table: lost(table, amount)), {"bend": amount})

    return [Change("damper.magnetic_saturation", "yield part saturates", "", (0.0, 3.0), alter)]


def _levels(command: Array) -> Array:
    """Return the values that a command stands at for long, in twentieths of its largest."""
    steps, counts = np.unique(np.round(20.0 * command / max(float(np.max(command)), 1e-9)), return_counts=True)
    return np.asarray(steps[counts > _STANDING * len(command)])


def _yield_shares(values: Mapping[str, object]) -> tuple[float, float, float, float] | None:
    """Return yield force at no current and per ampere, viscous coefficient likewise; None of another damper model."""
    for letter in ("alpha", "fc"):
        names = (f"{letter}_a", f"{letter}_b", "c_a", "c_b")
        if all(name in values for name in names):
            found = [number(values[name]) for name in names]
            return (found[0], found[1], found[2], found[3]) if found[0] > 0.0 and found[1] > 0.0 else None
    return None


def _fade(carrier: Carrier) -> list[Change]:
    """Return a force that falls with the recorded temperature, from its value at the reference."""
    if (
        "damper_temperature" not in carrier.channels
        or float(np.ptp(carrier.pooled("damper_temperature"))) < _LEAST_WARMING
    ):
        return []
    middle = float(np.mean(carrier.pooled("damper_force")))

    def share(table: Table, rate: float) -> Array:
        smooth = _low_pass_temperature(table["damper_temperature"], carrier.step)
        return 1.0 / (1.0 + rate * np.clip(smooth - _REFERENCE, 0.0, None)) - 1.0

    def alter(amount: float) -> Altered:
        return Altered(_added(carrier, lambda t: share(t, amount) * (t["damper_force"] - middle)), {"viscous": amount})

    return [Change("damper.thermal_fade", "force falls with temperature", "", (0.0, 0.1), alter)]


def _low_pass_temperature(values: Array, step: float) -> Array:
    """Return a temperature without the noise of its sensor: a mean over 2 s."""
    width = min(len(values), max(1, round(2.0 / step)))
    padded = np.pad(values, width // 2, mode="edge")
    return np.convolve(padded, np.ones(width) / width, mode="valid")[: len(values)]
