"""Baseline: all parameters of the nominal, and a delay, gain and offset of every channel, in one Gauss-Newton fit.

Named is what moved most: the parameter whose change moves the compared channels furthest, among those that stand for an
effect. This is what a user of a general identification tool does (such as `mujoco.sysid`, which fits delays, gains and
offsets of sensors beside the model's parameters).
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np
from carrier_nominals import quick
from cases import EncodedDiagnosis, Ranked, encode_verdict, rank_by_figure
from ruamel.yaml import YAML
from scipy.optimize import least_squares

from seatsim.blind.carrier.recorded import shifted
from seatsim.recordings.recording import Recording, load_recording
from seatsim.recordings.replay import replay_table, select_compared
from seatsim.scenario.loading import single
from seatsim.scenario.scenario import Scenario
from seatsim.schema.arrays import Array

NAMED = 0.05
"""Standard deviations of a channel that a parameter must move, below which nothing is named: the material limit."""
STEP, STEPS = 1e-3, 8
WIDEST = 0.5
"""Relative, of a parameter."""
LONGEST, LARGEST = 0.05, 2.0
"""s of a delay; standard deviations of an offset."""
COMMANDS = ("current_command", "command_voltage")
MOTIONS = ("floor_acceleration", "displacement")
MEANS = {"actuator.rate": "coil.lag", "plant.driver_mass": "driver.mass", "command": "coil.delay"}
MEANS |= {"gain": "sensor.gain", "offset": "sensor.bias", "delay": "sensor.lag"}
"""The effect that a parameter, or a kind of parameter of a channel, stands for."""


class Unknown(NamedTuple):
    """A number of the fit: a parameter by dotted key, or a kind and its channel.

    It is `nominal + (x - 1) limit` with x from 0 to 2, so that a step of x has the same meaning for all.
    """

    kind: str
    channel: str
    limit: float
    nominal: float = 0.0


def diagnose_by_joint_fit(case: Path) -> EncodedDiagnosis:
    """Return the verdict by a joint fit."""
    recording = quick(load_recording(case))
    ranked = rank_by_movement(recording)
    named = [effect for effect, moved in ranked[:1] if moved >= NAMED]
    return encode_verdict(recording, "known" if named else "none", named)


def rank_by_movement(recording: Recording) -> Ranked:
    """Return the effects by how far the parameters that stand for them have moved the channels."""
    unknowns = list_unknowns(recording)

    def residual(x: Array) -> Array:
        return misfit(recording, unknowns, x)

    ones = np.ones(len(unknowns))
    found = least_squares(residual, ones, bounds=(0.0 * ones, 2.0 * ones), diff_step=STEP * ones, max_nfev=STEPS)
    moved = np.sqrt(np.mean(np.asarray(found.jac) ** 2, axis=0)) * np.abs(found.x - 1.0)
    pairs = [(MEANS.get(unknown.kind, ""), float(size)) for unknown, size in zip(unknowns, moved, strict=True)]
    return rank_by_figure([pair for pair in pairs if pair[0]])


def list_unknowns(recording: Recording) -> list[Unknown]:
    """Return what is fitted to a recording."""
    nominal = YAML(typ="safe").load(recording.nominal_file)
    sections = {"plant": nominal.get("plant", {}), "damper.parameters": nominal["damper"]["parameters"]}
    sections["actuator"] = {"rate": nominal["actuator"].get("rate", 130.0)}
    found = []
    for section, values in sections.items():
        for key, value in values.items():
            if value and key not in ("n", "v_ref"):
                found.append(Unknown(f"{section}.{key}", "", WIDEST * abs(value), value))
    run = next(iter(recording.runs))
    for channel in select_compared(recording.table(run), recording.header.rig, recording.header.sample_rate):
        found += [Unknown("gain", channel, WIDEST), Unknown("offset", channel, LARGEST)]
        found.append(Unknown("delay", channel, LONGEST))
    found += [Unknown("gain", channel, WIDEST) for channel in MOTIONS if channel in recording.channels]
    return found + [Unknown("command", channel, LONGEST) for channel in COMMANDS if channel in recording.channels]


def misfit(recording: Recording, unknowns: list[Unknown], x: Array) -> Array:
    """Return simulated minus measured in standard deviations of each channel, over all runs, end to end."""
    values = [(u, u.nominal + (float(k) - 1.0) * u.limit) for u, k in zip(unknowns, x, strict=True)]
    settings = {u.kind: value for u, value in values if "." in u.kind}
    by_channel = {(u.kind, u.channel): value for u, value in values if "." not in u.kind}
    scenario = single(recording.nominal_file, settings)
    return np.concatenate([_misfit_of_run(recording, scenario, run, by_channel) for run in recording.runs])


def _misfit_of_run(
    recording: Recording, scenario: Scenario, run: str, by_channel: Mapping[tuple[str, str], float]
) -> Array:
    step = 1.0 / recording.header.sample_rate
    table = dict(recording.table(run))
    for (kind, channel), value in by_channel.items():
        if kind == "command":
            table[channel] = shifted(table[channel], value, step)
        elif kind == "gain" and channel in MOTIONS:
            table[channel] = table[channel] * (1.0 + value)
    measured = select_compared(recording.table(run), recording.header.rig, recording.header.sample_rate)
    parts = []
    for name, values in replay_table(scenario, recording, table).items():
        spread = float(np.std(measured[name]))
        late = shifted(values, by_channel[("delay", name)], step)
        said = late * (1.0 + by_channel[("gain", name)]) + spread * by_channel[("offset", name)]
        parts.append((said - measured[name]) / max(spread, 1e-12))
    return np.concatenate(parts)
