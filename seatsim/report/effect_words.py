"""What an effect means to the owner of a rig: what is the matter, and what to look at."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from seatsim.diagnosis.result import Cause, Estimate
from seatsim.report.formatting import describe_effect, format_quantity, format_sentence


class _EffectWords(NamedTuple):
    """A clause on what is the matter, `{}` being the size of the parameter named, and what to do about it."""

    clause: str
    action: str
    parameter: str = ""


WORDS = {
    "damper.thermal_fade": _EffectWords("the damper grows weaker as it warms up",
        "Measure the damper cold and warm, and let the controller know its temperature."),
    "damper.gas_spring": _EffectWords("the damper pushes with the pressure of its gas ({} at rest)",
        "Measure the gas pressure of the accumulator and the static force of the damper.", "preload"),
    "damper.asymmetry": _EffectWords("the damper is stronger in one direction than in the other",
        "Measure rebound and compression separately on a bench."),
    "damper.preyield_hysteresis": _EffectWords("the damper's force has a loop at low speed that its model lacks",
        "Take a damper model with hysteresis, such as bouc_wen, and identify it."),
    "damper.magnetic_saturation": _EffectWords("more current adds ever less force, since the damper's iron saturates",
        "Measure the force over current up to the largest current."),
    "damper.remanence": _EffectWords("the damper remembers past current ({} stays behind)",
        "Demagnetise it with a short reversed current, or let the controller know its past.", "width"),
    "damper.free_play": _EffectWords("there is play of {} at the damper's mount, or air in the damper",
        "Tighten the mount and bleed the damper.", "gap"),
    "damper.seal_friction": _EffectWords("the damper's seal rubs with {}",
        "Measure the damper's force at no current and very low speed.", "force"),
    "coil.lag": _EffectWords("the coil is slower than assumed, by {}",
        "Measure the coil's current after a step of the command; check the supply's voltage.", "time"),
    "coil.asymmetric_lag": _EffectWords("the coil's current falls more slowly than it rises, by {}",
        "Check the free-wheeling diode of the driver; a driver that reverses the voltage is faster.", "time"),
    "coil.delay": _EffectWords("the current follows its command {} late",
        "Check the cycle time of the controller and the bus between it and the coil's driver.", "time"),
    "coil.current_limit": _EffectWords("the supply cannot reach more than {}",
        "Check the supply's current limit and the resistance of coil and cable.", "limit"),
    "suspension.friction": _EffectWords("the linkage of the suspension rubs with {}",
        "Check bearings and guides of the linkage, without the damper in place.", "force"),
    "suspension.end_stop": _EffectWords("the suspension touches its buffers",
        "Look for marks on the buffers; lower the excitation or add travel."),
    "suspension.progressive_spring": _EffectWords("the suspension's spring grows stiffer with travel",
        "Measure the spring's force over the whole travel."),
    "cushion.hardening": _EffectWords("the cushion grows stiffer as it is compressed",
        "Measure the cushion's force over compression with the occupant's weight on it."),
    "cushion.separation": _EffectWords("the driver partly lifts off the cushion",
        "Look at the film of the test; fasten the belt or lower the excitation."),
    "driver.mass": _EffectWords("the occupant's mass differs by {} from what the scenario states",
        "Weigh the occupant, or the dummy, on the seat.", "change"),
    "driver.biodynamics": _EffectWords("the occupant's body has a resonance of its own near {}",
        "Take a driver of several masses in the scenario, see driver.model.", "frequency"),
    "floor.unmeasured_input": _EffectWords("the frame is also shaken along a path that no sensor records ({} RMS)",
        "Look for cables, belts or feet that touch the seat; record a further acceleration.", "rms"),
    "sensor.gain": _EffectWords("the channel {channel} reads with a wrong scale", "Calibrate that sensor."),
    "sensor.bias": _EffectWords("the channel {channel} reads with an offset or a drift",
        "Zero that sensor before the test, and let it warm up."),
    "sensor.lag": _EffectWords("the channel {channel} reads through a low-pass of {}",
        "Look for a filter in that sensor's amplifier or in the logger.", "time"),
    "sensor.clock_skew": _EffectWords("the controller's log is {} {side}",
        "Check the trigger and the clock of the data logger.", "shift"),
}  # fmt: skip


def say_cause(cause: Cause) -> str:
    """Return what is the matter in a clause; of an effect of the reader's own, its documentation."""
    words = WORDS.get(cause.effect)
    if words is None:
        return f"{cause.effect} is at work ({describe_effect(cause.effect) or 'an effect of your own'})"
    return words.clause.format(_say_size(cause.parameters, words.parameter), **_say_rest(cause.parameters))


def say_action(effect: str) -> str:
    """Return what to do about an effect."""
    words = WORDS.get(effect)
    return words.action if words else format_sentence(f"look at what {effect} describes on the rig")


def _say_size(parameters: Mapping[str, Estimate | str], name: str) -> str:
    found = parameters.get(name)
    if not isinstance(found, Estimate):
        return "some amount"
    if found.unit == "s":
        return f"{format_quantity(abs(1e3 * found.value), '-')} ms"
    return format_quantity(abs(found.value), found.unit)


def _say_rest(parameters: Mapping[str, Estimate | str]) -> dict[str, str]:
    channel, shift = parameters.get("channel"), parameters.get("shift")
    ahead = isinstance(shift, Estimate) and shift.value < 0
    name = channel.replace("_", " ") if isinstance(channel, str) else "of one sensor"
    return {"channel": name, "side": "early" if ahead else "late"}
