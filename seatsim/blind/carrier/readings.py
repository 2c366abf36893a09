"""Changes of what was logged: forces added to a load cell, a play before the damper, faults of the coil and of sensors.

Those of the coil and of sensors are a command that was given earlier than logged, a supply that did not reach it, a
slow current; scale, offset, drift and low-pass of a sensor, and a controller's log that is shifted in time.
"""

from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np
from numpy.random import Generator

from seatsim.blind.carrier import recorded
from seatsim.blind.carrier.recorded import Altered, Carrier, Change, Table, change_runs, number, section
from seatsim.schema.arrays import Array

_COMMANDS = ("current_command", "command_voltage")
_LONGEST_DELAY = 0.04
"""s"""
_NEAR_TOP = 0.93
"""Share of the largest command from which on it counts as the limit."""
_SENSORS = (
    *("floor_acceleration", "frame_acceleration", "driver_acceleration", "suspension_displacement"),
    *("displacement", "damper_force", "coil_current"),
)
_SCALES = {"damper_force": 100.0, "coil_current": 0.1, "suspension_displacement": 0.01, "displacement": 0.01}
"""Unit of a stated offset by channel; 1 m/s^2 for an acceleration."""
_INPUTS = ("floor_acceleration", "displacement")
_LOGGED = ("current_command", "command_voltage", "coil_current")
_LARGEST_GAIN, _LONGEST_LAG, _LONGEST_SKEW = 0.4, 0.08, 0.04
_LARGEST_OFFSET = 2.0
"""Standard deviations of the channel."""


def draw_delays(carrier: Carrier, rng: Generator) -> list[Change]:
    """Return a coil that follows its command late: the command is logged earlier than it was given."""
    command = commanded(carrier)
    if command is None or not _varies(carrier, command):
        return []

    def early(table: Table, amount: float) -> Table:
        return {command: recorded.shifted_rows(table[command], -round(amount / carrier.step))}

    def state(amount: float) -> dict[str, float]:
        return {"time": round(amount / carrier.step) * carrier.step}

    return [change_runs(carrier, ("coil.delay", "command advanced", ""), _LONGEST_DELAY, early, state)]


def draw_limits(carrier: Carrier, rng: Generator) -> list[Change]:
    """Return a supply at its limit: pulses or runs at the largest command are logged as more than that.

    What flowed is what was measured, so the limit is the largest true command. Only some of them are raised, by
    different amounts, so that no scale of the command does the same. Without a recorded current a limit can hardly be
    told from a saturation of the yield force.
    """
    command = commanded(carrier)
    if command is None or "coil_current" not in carrier.channels:
        return []
    gain = _command_gain(carrier, command)
    top = max(float(np.quantile(table[command], 0.99)) for table in carrier.tables.values())
    room = number(section(carrier.nominal, "actuator").get("max_current", 1.0)) / max(gain * top, 1e-9) - 1.0
    if top <= 0.0 or room < 0.2:
        return []
    raised = {run: _raises(table[command], top, rng) for run, table in carrier.tables.items()}

    def alter(amount: float) -> Altered:
        tables = {
            run: {**table, command: table[command] * (1.0 + amount * raised[run])}
            for run, table in carrier.tables.items()
        }
        return Altered(carrier._replace(tables=tables), {"limit": gain * top})

    return [Change("coil.current_limit", "command raised above what flowed", "", room, alter)]


def _raises(command: Array, top: float, rng: Generator) -> Array:
    """Return by which share each row is raised, 0 to 1, drawn for every pulse at the top; shape (N,)."""
    high = command >= _NEAR_TOP * top
    starts = np.flatnonzero(np.diff(high.astype(int), prepend=0) == 1)
    pulse = np.cumsum(np.isin(np.arange(len(command)), starts))
    share = np.where(rng.random(len(starts) + 1) < 0.6, rng.uniform(0.3, 1.0, len(starts) + 1), 0.0)
    return np.where(high, share[pulse], 0.0)


def commanded(carrier: Carrier) -> str | None:
    """Return the channel that commands the coil, None where none is recorded."""
    return next((name for name in _COMMANDS if name in carrier.channels), None)


def _command_gain(carrier: Carrier, command: str) -> float:
    """Return the current of a command, A/V of a voltage."""
    return number(section(carrier.header, "actuator").get("gain", 1.0)) if command == "command_voltage" else 1.0


def draw_sensor_changes(carrier: Carrier, rng: Generator) -> list[Change]:
    """Return a gain, an offset, a drift and a lag of every sensor.

    The motion of a bench has no offset, since it is counted from its first row, and the floor's accelerometer none
    that the replay would see as anything but a drift.
    """
    found: list[Change] = []
    for channel in _SENSORS:
        if channel in carrier.channels and not ("velocity" in carrier.channels and channel == "displacement"):
            found += _misread(carrier, channel, rng)
    return found


def _misread(carrier: Carrier, channel: str, rng: Generator) -> list[Change]:
    """Return the changes of a sensor; its drift is zero at first, and the amount in the mean of the runs' lengths."""
    step, scale, pooled = carrier.step, _SCALES.get(channel, 1.0), carrier.pooled(channel)

    def change(
        effect: str, form: str, largest: float, read: Callable[[Array, float], Array], parameters: recorded.Parameters
    ) -> Change:
        named = (f"sensor.{effect}", form, channel)
        return change_runs(carrier, named, largest, lambda table, a: {channel: read(table[channel], a)}, parameters)

    sign = recorded.draw_sign(rng, -0.5)
    found = [
        change("gain", "gain", _LARGEST_GAIN, lambda u, a: u + sign * a * u, lambda a: {"error": sign * a}),
        change("lag", "lag", _LONGEST_LAG, lambda u, a: recorded.low_pass(u, a, step), lambda a: {"time": a}),
    ]
    if channel in _INPUTS:
        return found
    offset, last = (recorded.draw_sign(rng) * float(np.std(pooled)) for _ in range(2))
    rate = last / (len(pooled) / len(carrier.tables) * step)

    def drifting(u: Array, amount: float) -> Array:
        return u + rate * amount * step * np.arange(len(u))

    def rates(amount: float) -> dict[str, float]:
        return {"share": 0.0, "drift": rate * amount / scale}

    return [
        *found,
        change("bias", "bias", _LARGEST_OFFSET, lambda u, a: u + offset * a, lambda a: {"share": offset * a / scale}),
        change("bias", "drift", 2.0 * _LARGEST_OFFSET, drifting, rates),
    ]


def draw_skewed_logs(carrier: Carrier, rng: Generator) -> list[Change]:
    """Return a log that is late: every logged channel says at t what was at t - shift.

    A log that runs ahead could as well be a delay of the coil where no current was recorded.
    """
    logged = [name for name in _LOGGED if name in carrier.channels]
    if not any(_varies(carrier, name) for name in logged):
        return []
    sign = recorded.draw_sign(rng) if "coil_current" in logged and len(logged) > 1 else 1.0

    def rows(amount: float) -> int:
        return round(sign * amount / carrier.step)

    def late(table: Table, amount: float) -> Table:
        moved = {name: recorded.shifted_rows(table[name], rows(amount)) for name in logged}
        if "coil_current" in logged:
            moved["coil_current"] = recorded.shifted(table["coil_current"], rows(amount) * carrier.step, carrier.step)
        return moved

    named = ("sensor.clock_skew", "late log" if sign > 0 else "early log", "")
    return [change_runs(carrier, named, _LONGEST_SKEW, late, lambda a: {"shift": rows(a) * carrier.step})]


def _varies(carrier: Carrier, channel: str) -> bool:
    return any(float(np.ptp(table[channel])) > 0.0 for table in carrier.tables.values())


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
    gain, rate = _command_gain(carrier, command), number(section(carrier.nominal, "actuator").get("rate", 130.0))
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
