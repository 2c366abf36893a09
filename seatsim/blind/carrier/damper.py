"""Forces added to what a load cell measured, and a play between the recorded motion and the damper's."""

from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np
from numpy.random import Generator

from seatsim.blind.carrier import recorded
from seatsim.blind.carrier.readings import command_gain, commanded
from seatsim.blind.carrier.recorded import Carrier, Change, Table, number, section
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


class _Bench(NamedTuple):
    """A bench with a load cell: spread and mean of its force in N, and the spread of its motion in m."""

    carrier: Carrier
    size: float
    middle: float
    travel: float

    def change(
        self,
        effect: str,
        form: str,
        largest: float,
        added: Callable[[Table, float], Array | float],
        parameters: Callable[[float], Mapping[str, float]] = lambda amount: {},
    ) -> Change:
        """Return an effect that adds a force, N, to what was measured in a run."""

        def read(table: Table, amount: float) -> Table:
            return {"damper_force": table["damper_force"] + added(table, amount)}

        return recorded.change_runs(self.carrier, (f"damper.{effect}", form, ""), largest, read, parameters)

    def speed(self, table: Table) -> Array:
        """Return the speed of a run, m/s."""
        return table["velocity"] if "velocity" in table else recorded.slope(table["displacement"], self.carrier.step)


def draw_damper_changes(carrier: Carrier, rng: Generator) -> list[Change]:
    """Return the changes of the damper that a bench with a load cell allows."""
    if carrier.rig != "damper_bench" or "damper_force" not in carrier.channels:
        return []
    force = carrier.pooled("damper_force")
    bench = _Bench(carrier, float(np.std(force)), float(np.mean(force)), float(np.std(carrier.pooled("displacement"))))
    found = [_seal_friction(bench, rng), *_gas_springs(bench, rng), *_asymmetries(bench, rng), _free_play(bench, rng)]
    return found + _saturation(bench) + _fade(bench)


def _seal_friction(bench: _Bench, rng: Generator) -> Change:
    """Return Coulomb friction `F sgn v`, with the small travel over which a real seal begins to slide."""
    size, travel = bench.size, float(np.exp(rng.uniform(*np.log(_TRAVELS))))

    def added(table: Table, amount: float) -> Array:
        return amount * size * recorded.slide(table["displacement"], travel)

    return bench.change("seal_friction", "F sgn v", _LARGEST, added, lambda amount: {"force": amount * size})


def _gas_springs(bench: _Bench, rng: Generator) -> list[Change]:
    """Return preload and stiffness of a gas volume, both of about the same force; then a preload alone."""
    share, sign = float(rng.uniform(0.4, 1.0)), recorded.draw_sign(rng)
    alone = recorded.draw_sign(rng) * bench.size

    def both(amount: float) -> dict[str, float]:
        return {"preload": sign * share * amount * bench.size, "stiffness": amount * bench.size / bench.travel}

    def added(table: Table, amount: float) -> Array:
        x, of_gas = table["displacement"], both(amount)
        return np.asarray(of_gas["preload"] + of_gas["stiffness"] * (x - x[0]))

    return [
        bench.change("gas_spring", "preload and stiffness", _LARGEST, added, both),
        bench.change("gas_spring", "preload", _LARGEST, lambda _, a: a * alone, lambda a: {"preload": a * alone}),
    ]


def _asymmetries(bench: _Bench, rng: Generator) -> list[Change]:
    """Return push and pull scaled apart, and extension and compression, one turning into the other over a speed.

    The first is continuous, since its scale changes where the force is zero.
    """
    by_force, by_speed = recorded.draw_sign(rng), recorded.draw_sign(rng)
    speeds = np.concatenate([bench.speed(table) for table in bench.carrier.tables.values()])
    width = float(rng.uniform(0.1, 0.4)) * float(np.std(speeds))

    def of_force(table: Table, amount: float) -> Array:
        return by_force * amount * np.abs(table["damper_force"] - bench.middle)

    def of_speed(table: Table, amount: float) -> Array:
        v = bench.speed(table) / width
        return by_speed * amount * (v / np.sqrt(1.0 + v**2)) * (table["damper_force"] - bench.middle)

    return [
        bench.change("asymmetry", "by the sign of the force", 0.8, of_force),
        bench.change("asymmetry", "by the sign of the speed", 0.8, of_speed),
    ]


def _free_play(bench: _Bench, rng: Generator) -> Change:
    """Return a play in series: the same force, a recorded motion that runs ahead of the damper's by half a gap.

    The gap is crossed where the force is a small share of its spread, since behind it every mount yields.
    """
    soft = float(rng.uniform(*_CROSSED)) * bench.size

    def played(table: Table, amount: float) -> Table:
        across = np.clip(table["damper_force"] / soft, -1.0, 1.0)
        ahead = 0.5 * (amount * bench.travel) * (1.5 * across - 0.5 * across**3)
        moved = {"displacement": table["displacement"] + ahead - ahead[0]}
        if "velocity" in table:
            moved["velocity"] = table["velocity"] + recorded.slope(ahead, bench.carrier.step)
        return moved

    named = ("damper.free_play", "motion shifted", "")
    return recorded.change_runs(bench.carrier, named, 1.0, played, lambda amount: {"gap": amount * bench.travel})


def _saturation(bench: _Bench) -> list[Change]:
    """Return a yield force that grows ever less with current: that part of the force is scaled by `1 / (1 + i / i_s)`.

    The part that depends on the current is told from the rest by the nominal's own shares of it.
    """
    carrier, command = bench.carrier, commanded(bench.carrier)
    yields = _yield_shares(section(section(carrier.nominal, "damper"), "parameters"))
    if command is None or yields is None or len(_levels(carrier.pooled(command))) < _LEAST_LEVELS:
        return []
    gain, rate = command_gain(carrier, command), number(section(carrier.nominal, "actuator").get("rate", 130.0))
    fixed, by_current, viscous, viscous_by_current = yields

    def lost(table: Table, bend: float) -> Array:
        i = np.clip(recorded.low_pass(gain * table[command], 1.0 / rate, carrier.step), 0.0, None)
        yielding = table["damper_force"] - bench.middle - (viscous + viscous_by_current * i) * bench.speed(table)
        return -yielding * (by_current * i / (fixed + by_current * i)) * (bend * i / (1.0 + bend * i))

    return [bench.change("magnetic_saturation", "yield part saturates", 3.0, lost, lambda bend: {"bend": bend})]


def _levels(command: Array) -> Array:
    """Return the values that a command stands at for long, in twentieths of its largest."""
    steps, counts = np.unique(np.round(20.0 * command / max(float(np.max(command)), 1e-9)), return_counts=True)
    return np.asarray(steps[counts > _STANDING * len(command)])


def _yield_shares(values: Mapping[str, object]) -> list[float] | None:
    """Return yield force at no current and per ampere, viscous coefficient likewise; None of another damper model."""
    for letter in ("alpha", "fc"):
        names = (f"{letter}_a", f"{letter}_b", "c_a", "c_b")
        if all(name in values for name in names):
            found = [number(values[name]) for name in names]
            return found if found[0] > 0.0 and found[1] > 0.0 else None
    return None


def _fade(bench: _Bench) -> list[Change]:
    """Return a force that falls with the recorded temperature, from its value at the reference.

    The temperature is taken without the noise of its sensor: as a mean over 2 s.
    """
    channel, carrier = "damper_temperature", bench.carrier
    if channel not in carrier.channels or float(np.ptp(carrier.pooled(channel))) < _LEAST_WARMING:
        return []

    def lost(table: Table, rate: float) -> Array:
        values = table[channel]
        width = min(len(values), max(1, round(2.0 / carrier.step)))
        padded = np.pad(values, width // 2, mode="edge")
        smooth = np.convolve(padded, np.ones(width) / width, mode="valid")[: len(values)]
        share = 1.0 / (1.0 + rate * np.clip(smooth - _REFERENCE, 0.0, None)) - 1.0
        return share * (table["damper_force"] - bench.middle)

    return [bench.change("thermal_fade", "force falls with temperature", 0.1, lost, lambda rate: {"viscous": rate})]
