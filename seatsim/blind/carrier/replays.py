"""How far a change moves what a gap compares, beyond what parameters inside their tolerance could take away."""

import dataclasses
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from seatsim.blind.carrier.recorded import Carrier, Content, number, section
from seatsim.blind.make.folder import encode_yaml
from seatsim.blind.make.materiality import bounded_least_squares
from seatsim.recordings.recording import HEADER, Recording, load_recording
from seatsim.recordings.replay import replay_table, select_compared, stands_out
from seatsim.scenario.loading import single
from seatsim.schema.arrays import Array
from seatsim.schema.guarded import temporary_folder

_UNKNOWN_TOLERANCE = 0.05
"""Stands for a `parameter_tolerance` that is no single number."""
_ZERO_SCALES = {"f0": 100.0, "fc_a": 100.0, "alpha_a": 100.0}
"""Scales of parameters known to be zero (contract, section 3), N."""
_EXACT = ("n", "x0", "v_ref")
"""Parameters of a damper that are exponents, lengths or regularisations: known."""
_OWN_SHARE = 0.5
"""Of a change's own square by which it must at least raise that of the residuals."""
_Residuals = dict[str, Array]
"""Measured minus simulated by compared channel, over all runs, shape (N,) each."""


class Ruler:
    """Measures changes of one carrier; the sensitivities to its parameters are computed once."""

    def __init__(self, carrier: Carrier) -> None:
        self.carrier = carrier
        self.recording = _load(carrier)
        self.before = self.residuals(carrier)
        self.spread = {name: float(np.std(carrier.pooled(name))) for name in self.before}
        self.columns = self._sensitivities()

    def _sensitivities(self) -> list[Array]:
        """Return how the residuals change where each parameter is up by its tolerance, in std, end to end."""
        found = []
        for nominal in _varied_nominals(self.carrier):
            moved = self.residuals(dataclasses.replace(self.carrier, nominal=nominal))
            column = self._stack({name: moved[name] - self.before[name] for name in self.before})
            if np.all(np.isfinite(column)):
                found.append(column)
        return found

    def _stack(self, change: Mapping[str, Array]) -> Array:
        return np.concatenate([change[name] / self.spread[name] for name in self.before])

    def size(self, changed: Carrier) -> float:
        """Return the largest change of a compared channel in its std, after the best refit inside the tolerance.

        `max_c rms(g - J theta)_c`, `|theta| <= 1`, where g is what the change does to measured minus simulated. A
        change below a channel's noise counts as none there.
        """
        g = self._change(changed)
        if not np.all(np.isfinite(g)):
            return float("inf")
        parts = dict(zip(self.before, np.split(g - self._absorbed(g), len(self.before)), strict=True))
        rms = {name: float(np.sqrt(np.mean(values**2))) for name, values in parts.items()}
        return max((r for name, r in rms.items() if r > self.carrier.noise(name) / self.spread[name]), default=0.0)

    def stands_out(self, changed: Carrier) -> bool:
        """Tell whether a change adds to the gap about what it does by itself, so that taking it away would help.

        Where the background holds the opposite of the effect the two cancel, and nobody can know which is true:
        `|r1|^2 - |r0|^2 >= _OWN_SHARE |g|^2` of the residuals before and after, each refitted inside the tolerance.
        """
        g, r0 = self._change(changed), self._stack(self.before)
        before, after, own = (values - self._absorbed(values) for values in (r0, r0 + g, g))
        return bool(after @ after - before @ before >= _OWN_SHARE * (own @ own))

    def _change(self, changed: Carrier) -> Array:
        """Return what a change does to measured minus simulated, in std, end to end; NaN where channels are lost."""
        after = self.residuals(changed)
        if set(after) != set(self.before):
            return np.full(sum(map(len, self.before.values())), np.nan)
        return self._stack({name: after[name] - self.before[name] for name in self.before})

    def _absorbed(self, g: Array) -> Array:
        if not self.columns:
            return np.zeros_like(g)
        J = np.column_stack(self.columns)
        return np.asarray(J @ bounded_least_squares(J, g))

    def residuals(self, carrier: Carrier) -> _Residuals:
        """Return measured minus simulated of the channels that stand above their noise."""
        scenario, rate = single(carrier.nominal), self.recording.header.sample_rate
        parts: dict[str, list[Array]] = {}
        for table in carrier.tables.values():
            measured = select_compared(table, carrier.rig, rate)
            for name, values in replay_table(scenario, self.recording, table).items():
                parts.setdefault(name, []).append(measured[name] - values)
        pooled = {name: np.concatenate(values) for name, values in parts.items()}
        return {n: values for n, values in pooled.items() if stands_out(carrier.pooled(n), carrier.noise(n))}


def _load(carrier: Carrier) -> Recording:
    """Return the header of a carrier, whose displacement is interpolated in the replay of a bench.

    Smoothing it would take much longer, and a size needs none.
    """
    with temporary_folder() as folder:
        header = {**carrier.header, "nominal": "nominal.yaml"}
        (Path(folder) / HEADER).write_bytes(encode_yaml(header))
        (Path(folder) / "nominal.yaml").write_bytes(encode_yaml(carrier.nominal))
        recording = load_recording(folder)
    smooth = {
        name: entry._replace(noise_rms=0.0) for name, entry in recording.channels.items() if name == "displacement"
    }
    return dataclasses.replace(recording, channels=recording.channels | smooth)


def _tolerance(carrier: Carrier) -> float:
    """Return the fraction to which parameters are taken to be known."""
    stated = carrier.header.get("parameter_tolerance", 0.02)
    return number(stated) if isinstance(stated, int | float) else _UNKNOWN_TOLERANCE


def _varied_nominals(carrier: Carrier) -> list[Content]:
    """Return the nominal with each of its parameters, one after another, up by the tolerance."""
    share, nominal = _tolerance(carrier), carrier.nominal
    damper, plant, coil = section(nominal, "damper"), section(nominal, "plant"), section(nominal, "actuator")
    values = section(damper, "parameters")
    varied: list[Content] = []
    for key, value in values.items():
        step = share * (number(value) or _ZERO_SCALES.get(key, 0.0))
        if key not in _EXACT and step and np.isfinite(step):
            varied.append({**nominal, "damper": {**damper, "parameters": {**values, key: number(value) + step}}})
    for name, part in (("plant", plant), ("actuator", coil)):
        for key, value in part.items():
            if key != "max_current" and share * (number(value) or 0.0) > 0.0:
                varied.append({**nominal, name: {**part, key: number(value) * (1.0 + share)}})
    return varied
