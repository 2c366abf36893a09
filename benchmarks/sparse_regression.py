"""The baseline `sindy`: sparse regression of what equations leave that are fed measured signals (pysindy's STLSQ).

Each term stands for one effect (EQUATIONS), all in units of what noise alone leaves in the equation. An effect is worth
what its terms take off an equation.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping

import numpy as np
from cases import Array, Ranked, rank_by_figure
from measured_motion import (
    CORNER,
    CURRENT,
    FORCE,
    FRAME,
    TRAVEL,
    replicate_nominal,
    simulate_fed,
    vary_plant,
)
from scipy.optimize import lsq_linear
from scipy.signal import bilinear, butter, lfilter, sosfiltfilt

from seatsim.diagnosis.problem import DiagnosisProblem

SPARSE = 0.1
"""Contribution, in noise units, below which STLSQ drops a term."""
EQUATIONS: dict[str, tuple[tuple[float, float], dict[str, str]]] = {
    "damper": ((0.0, 15.0), {
        "1": "damper.gas_spring", "x": "damper.gas_spring", "|v|": "damper.asymmetry", "i|s|": "damper.asymmetry",
        "s": "damper.seal_friction", "Tv": "damper.thermal_fade", "Tis": "damper.thermal_fade",
        "iis": "damper.magnetic_saturation", "past i s": "damper.remanence", "a(1-ss)": "damper.preyield_hysteresis",
        "F after reversals": "damper.free_play", "di/dt s": "sensor.clock_skew", "F": "sensor.gain",
        "dF/dt": "sensor.lag",
    }),
    "suspension": ((0.0, 15.0), {
        "1": "sensor.bias", "s": "suspension.friction", "xxx": "suspension.progressive_spring",
        "x|x|": "suspension.progressive_spring", "stop": "suspension.end_stop", "ad": "driver.mass",
        "as": "sensor.gain", "F": "sensor.gain", "das/dt": "sensor.lag", "dF/dt": "sensor.lag",
    }),
    "driver": ((1.5, 15.0), {
        "yyy": "cushion.hardening", "y|y|": "cushion.hardening", "tension": "cushion.separation", "ad": "driver.mass",
        "resonance": "driver.biodynamics", "dad/dt": "sensor.lag",
    }),
    "coil": ((0.0, 200.0), {
        "slower": "coil.lag", "slower down": "coil.asymmetric_lag", "later": "coil.delay", "top": "coil.current_limit",
        "1": "sensor.bias", "i": "sensor.gain",
    }),
    "sensor": ((1.0, 12.0), {"as": "sensor.gain", "a0": "sensor.gain", "das/dt": "sensor.lag", "da0/dt": "sensor.lag"}),
}  # fmt: skip
"""Block of each equation, the band in Hz in which it is compared, and the effects that its terms stand for.

Without a load cell the terms of the damper stand in the equation of the suspension, before terms of its own."""
DRIVER = "driver_acceleration"


def rank_by_regression(problem: DiagnosisProblem) -> tuple[Ranked, dict[str, float]]:
    """Return the effects by what their terms take off an equation, and what each equation keeps, in noise units."""
    deviations, noise = refit_parameters(problem)
    left = join_runs(problem, deviations)
    terms = [list_terms(problem, run) for run in problem.runs]
    worth, kept = [], {}
    for block, target in left.items():
        effects = list(terms[0][block])
        columns = np.concatenate([np.array(list(part[block].values())) for part in terms], axis=1).T
        columns /= np.maximum(np.sqrt(np.mean(columns**2, axis=0)), 1e-30)
        found = _select_columns(columns, target / noise[block])
        kept[block] = _rms_left(columns[:, found], target / noise[block])
        for effect in {effects[k][0] for k in found}:
            others = columns[:, [k for k in found if effects[k][0] != effect]]
            gain = _rms_left(others, target / noise[block]) ** 2 - kept[block] ** 2
            worth.append((effect, float(np.sqrt(max(gain, 0.0)))))
    return rank_by_figure(worth), kept


def _select_columns(columns: Array, target: Array) -> list[int]:
    """Return the columns that STLSQ keeps."""
    try:
        from pysindy import STLSQ
    except ImportError as error:
        raise SystemExit("the baseline 'sindy' needs pysindy: pip install pysindy") from error
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        shares = STLSQ(threshold=SPARSE, alpha=1e-2 * len(target)).fit(columns, target[:, None]).coef_[0]
    return [int(k) for k in np.flatnonzero(shares)]


def _rms_left(columns: Array, target: Array) -> float:
    """Return the RMS that a regression leaves."""
    return float(np.sqrt(np.mean((target - columns @ np.linalg.lstsq(columns, target, rcond=None)[0]) ** 2)))


def refit_parameters(problem: DiagnosisProblem) -> tuple[Array, dict[str, float]]:
    """Return the parameters inside their tolerance at which the equations leave least, and what noise alone leaves."""
    base = join_runs(problem, problem.nominal)
    quiet = join_runs(replicate_nominal(problem), problem.nominal)
    noise = {block: float(np.sqrt(np.mean(values**2))) for block, values in quiet.items()}
    moved = [join_runs(problem, one) for one in np.eye(len(problem.nominal))]
    jacobian = [np.concatenate([(m[block] - base[block]) / noise[block] for block in base]) for m in moved]
    target = np.concatenate([base[block] / noise[block] for block in base])
    return lsq_linear(np.array(jacobian).T, -target, (-1.0, 1.0)).x, noise


def join_runs(problem: DiagnosisProblem, deviations: Array) -> dict[str, Array]:
    """Return what the equations of all runs leave, on end."""
    parts = [evaluate_equations(problem, run, deviations) for run in problem.runs]
    return {block: np.concatenate([part[block] for part in parts]) for block in parts[0]}


def evaluate_equations(problem: DiagnosisProblem, run: str, deviations: Array) -> dict[str, Array]:
    """Return by block what its equation leaves, in its band: N, A (coil), m/s^2 (sensor)."""
    given, rate = _table_of(problem, run), problem.rate
    plant = vary_plant(problem, deviations)
    off = dict(zip(problem.channels, problem.measured[run] - simulate_fed(problem, run, deviations, ()), strict=True))
    left = {"suspension": plant.frame_mass * off[FRAME]}
    if DRIVER in off:
        y, w = _integrate_cushion(given, rate)
        left["suspension"] = left["suspension"] + plant.driver_mass * off[DRIVER]
        left["driver"] = plant.driver_mass * given[DRIVER] + plant.cushion_stiffness * y + plant.cushion_damping * w
    if FORCE in off:
        left["damper"] = off[FORCE]
    if CURRENT in off and "current_command" in given:
        left["coil"] = off[CURRENT]
    relative = _differentiate(_differentiate(given[TRAVEL], rate), rate)
    left["sensor"] = given[FRAME] - given["floor_acceleration"] - relative
    return {block: _filter_band(EQUATIONS[block][0], values, rate) for block, values in left.items()}


def list_terms(problem: DiagnosisProblem, run: str) -> dict[str, dict[tuple[str, str], Array]]:
    """Return by block the terms of its equation by effect and name, in its band."""
    given, rate = _table_of(problem, run), problem.rate
    columns = _form_columns(problem, given)
    merged = {} if FORCE in problem.channels else EQUATIONS["damper"][1]
    return {
        block: {
            (effect, name): _filter_band(band, columns[name], rate)
            for name, effect in (own | (merged if block == "suspension" else {})).items() if name in columns
        }
        for block, (band, own) in EQUATIONS.items()
    }  # fmt: skip


def _table_of(problem: DiagnosisProblem, run: str) -> dict[str, Array]:
    """Return all recorded channels of the rows compared."""
    samples = problem.measured[run].shape[1]
    given = {name: values[problem.skip :][:samples] for name, values in problem.recording.table(run).items()}
    return given | dict(zip(problem.channels, problem.measured[run], strict=True))


def _form_columns(problem: DiagnosisProblem, given: Mapping[str, Array]) -> dict[str, Array]:
    """Return the columns that EQUATIONS names, as far as the channels let, shape (N,) each.

    x, v, a are of the suspension, s the side tanh(v / 0.01 m/s) of its force; y the displacement of the cushion; a0,
    as, ad accelerations of floor, frame and driver; i the current, F the force of the load cell, T the warmth above
    20 degC.
    """
    rate = problem.rate
    one = np.ones(len(given[TRAVEL]))
    x = given[TRAVEL]
    v = _differentiate(x, rate)
    a, s = _differentiate(v, rate), np.tanh(v / 0.01)
    command = given.get("current_command", 0.0 * one)
    i = given.get(CURRENT, command)
    warm = given["damper_temperature"] - 20.0 if "damper_temperature" in given else one
    travel = np.cumsum(np.abs(v)) / rate
    turned = travel - np.maximum.accumulate(np.where(np.diff(np.sign(v), prepend=0.0) != 0.0, travel, 0.0))
    past = lfilter([1.0 / (0.5 * rate)], [1.0, 1.0 / (0.5 * rate) - 1.0], i)
    found = {
        "1": one, "x": x, "s": s, "|v|": np.abs(v), "i|s|": i * np.abs(s), "Tv": warm * v, "Tis": warm * i * s,
        "iis": i**2 * s, "past i s": (past - i) * s, "a(1-ss)": a * (1.0 - s**2),
        "di/dt s": _differentiate(i, rate) * s, "xxx": x**3, "x|x|": x * np.abs(x), "i": i,
        "stop": np.sign(x) * (np.abs(x) - 0.6 * np.max(np.abs(x))).clip(0.0),
    }  # fmt: skip
    for name, channel in (("a0", "floor_acceleration"), ("as", FRAME), ("ad", DRIVER), ("F", FORCE)):
        if channel in given:
            found |= {name: given[channel], f"d{name}/dt": _differentiate(given[channel], rate)}
    if "F" in found:
        found["F after reversals"] = found["F"] * np.exp(-turned / 1e-3)
    return found | _form_driver_columns(given, rate) | _form_coil_columns(problem, command, rate)


def _integrate_cushion(given: Mapping[str, Array], rate: float) -> tuple[Array, Array]:
    """Return displacement and velocity of the cushion, integrals above half the lowest frequency of its equation."""
    low, samples = 0.5 * EQUATIONS["driver"][0][0], len(given[DRIVER])
    frequency = np.fft.rfftfreq(samples, 1.0 / rate)
    spectrum = np.where(frequency > low, np.fft.rfft(given[DRIVER] - given[FRAME]), 0.0)
    speed = 2j * np.pi * frequency.clip(low)
    return np.fft.irfft(spectrum / speed**2, samples), np.fft.irfft(spectrum / speed, samples)


def _form_driver_columns(given: Mapping[str, Array], rate: float) -> dict[str, Array]:
    """Return the terms of cushion and driver."""
    if DRIVER not in given:
        return {}
    y, ad, own = _integrate_cushion(given, rate)[0], given[DRIVER], 2.0 * np.pi * 5.0
    resonance = lfilter(*bilinear([own**2], [1.0, 0.6 * own, own**2], rate), ad)
    tension = (-ad - 0.5 * np.max(-ad)).clip(0.0)
    return {"yyy": y**3, "y|y|": y * np.abs(y), "resonance": resonance, "tension": tension}


def _form_coil_columns(problem: DiagnosisProblem, command: Array, rate: float) -> dict[str, Array]:
    """Return how the current of the nominal coil would change were it slower by 3 ms or later by 4 ms, and its top."""
    coil = problem.scenario.coil
    kept = np.exp(-coil.rate / rate)
    plain = lfilter([0.0, 1.0 - kept], [1.0, -kept], command.clip(0.0, coil.max_current))
    decay = np.exp(-1.0 / (0.003 * rate))
    slower = lfilter([1.0 - decay], [1.0, -decay], plain) - plain
    late = round(0.004 * rate)
    later = np.concatenate([np.full(late, plain[0]), plain[: len(plain) - late]]) - plain
    return {
        "slower": slower,
        "slower down": slower.clip(0.0),
        "later": later,
        "top": (plain - 0.7 * plain.max()).clip(0.0),
    }


def _differentiate(values: Array, rate: float) -> Array:
    return np.gradient(sosfiltfilt(butter(3, CORNER, fs=rate, output="sos"), values), 1.0 / rate)


def _filter_band(band: tuple[float, float], values: Array, rate: float) -> Array:
    """Return a signal between two frequencies, without phase, and without its first and last second."""
    low, high = band[0], min(band[1], 0.45 * rate)
    if low:
        sections = butter(3, (low, high), "bandpass", fs=rate, output="sos")
    else:
        sections = butter(3, high, "lowpass", fs=rate, output="sos")
    return np.asarray(sosfiltfilt(sections, values))[round(rate) : -round(rate)]
