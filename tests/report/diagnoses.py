"""Made-up diagnoses of every verdict, for tests of reports."""

from dataclasses import replace
from functools import cache

import numpy as np

from seatsim.diagnosis import result
from seatsim.diagnosis.result import Cause, Estimate, GapFigures, Gaps

from ..text import words

RATE = 500.0
SEAT = {
    "damper_force": ("N", 2.5), "frame_acceleration": ("m/s^2", 0.03), "driver_acceleration": ("m/s^2", 0.015),
    "suspension_displacement": ("m", 5e-5), "coil_current": ("A", 0.003),
}  # fmt: skip
EFFECTS = words("""
    damper.remanence damper.magnetic_saturation damper.seal_friction suspension.friction coil.lag
    damper.thermal_fade suspension.progressive_spring cushion.hardening driver.mass sensor.gain
    sensor.clock_skew damper.free_play
""")
PARAMETERS = {
    "damper.remanence": {"width": Estimate(0.0812, 0.0041, "A"), "lift": Estimate(0.4, 0.05, "-")},
    "damper.seal_friction": {"force": Estimate(44.7, 1.3, "N")},
    "suspension.friction": {"force": Estimate(45.2, 1.2, "N")},
    "sensor.gain": {"channel": "driver_acceleration", "gain": Estimate(1.02, 0.01, "-")},
}


def narrow(rng, n, low, high):
    """Return noise within a band, of unit RMS."""
    spectrum = np.fft.rfft(rng.standard_normal(n))
    frequency = np.fft.rfftfreq(n, 1 / RATE)
    values = np.fft.irfft(spectrum * ((frequency > low) & (frequency < high)), n)
    return values / np.std(values)


@cache
def rig(seconds=24.0, bench=False):
    """Return motion and signals of a made-up rig, and what its simulation lacks: more force after current drops."""
    rng, n = np.random.default_rng(4), round(seconds * RATE)
    x = 0.012 * narrow(rng, n, 0.7, 3.0)
    v = np.gradient(x, 1 / RATE)
    current = np.clip(0.4 + 0.3 * narrow(rng, n, 0.3, 4.0), 0, 1)
    lacks = 70 * np.tanh(v / 0.02) * (np.gradient(current) < 0) * current
    force = 300 * v + (60 + 600 * current) * np.tanh(v / 0.03) + lacks
    shaking = 1.2 * narrow(rng, n, 1.0, 12.0)
    true = dict(zip(SEAT, (force, shaking - lacks / 20, 0.5 * shaking, x, current), strict=True))
    part = dict(zip(SEAT, (1.0, -0.05, 0.006, 3e-06, 2e-05), strict=True))
    motion = {"velocity": v, "displacement": x, "coil_current": current}
    motion |= {} if bench else {"damper_temperature": 20 + 15 * np.linspace(0, 1, n)}
    return motion, true, {name: factor * lacks for name, factor in part.items()}


def traces(channels, after=0.1, gap=1.0, runs=("run-c",), bench=False):
    _, true, lacks = rig(bench=bench)
    rng, found = np.random.default_rng(5), []
    for run in runs:
        for name in channels:
            unit, noise = SEAT[name]
            measured = true[name] + noise * rng.standard_normal(len(true[name]))
            nominal, better = (true[name] - part * lacks[name] for part in (gap, after * gap))
            rows = np.arange(len(measured)) / RATE
            found.append(result.Trace(run, name, unit, noise, rows, measured, nominal, nominal, better))
    return found


def gaps_of(found):
    def pooled(courses):
        channels = {t.channel: float(np.sqrt(np.mean(course**2)) / np.std(t.measured)) for t, course in courses}
        return GapFigures(float(np.sqrt(np.mean(np.square(list(channels.values()))))), channels)

    before = pooled([(t, t.measured - t.nominal) for t in found])
    after = pooled([(t, t.measured - t.after) for t in found])
    floor = pooled([(t, np.full(9, t.noise_rms)) for t in found])
    calibrated = GapFigures(0.97 * before.overall, {k: 0.97 * g for k, g in before.channels.items()})
    shrink = 1 - after.overall / before.overall
    return Gaps(before, calibrated, after, floor, shrink, (shrink - 0.04, shrink + 0.03))


def alike():
    matrix = np.abs(np.random.default_rng(3).normal(0, 0.2, (len(EFFECTS), len(EFFECTS))))
    matrix = np.clip((matrix + matrix.T) / 2, 0, 1)
    matrix[2, 3] = matrix[3, 2] = 0.99
    np.fill_diagonal(matrix, 1)
    return result.Collinearity(EFFECTS, matrix)


def ranked(first):
    """Return all effects, the given ones first with their probabilities, the others ever less probable."""
    rest = [name for name in EFFECTS if name not in first]
    likely = {**first, **{name: 0.04 / (k + 1) for k, name in enumerate(rest)}}
    return [Cause(name, p, 0.87 * p if p > 0.1 else 0.02, PARAMETERS.get(name, {})) for name, p in likely.items()]


def known(channels=tuple(SEAT), bench=False, runs=("run-c",)):
    found = traces(channels, bench=bench, runs=runs)
    comfort = [result.ComfortFigure("RMS driver acceleration", "m/s^2", 0.61, 0.72, 0.615)]
    return result.Diagnosis(
        name="field-07", verdict="known",
        sentence="the yield force remembers past current (damper.remanence, 0.08 A): it explains 87 % of the gap",
        where=[result.Share("damper", 0.93), result.Share("coil", 0.04), result.Share("sensor", 0.03)],
        causes=ranked({"damper.remanence": 0.97}), probability_none=0.0, probability_unknown=0.02,
        selected=["damper.remanence"], stochastic="", indistinguishable=[], experiment=None, held_out=list(runs),
        isolable=[["damper"], ["coil"], ["suspension", "floor"], ["cushion"], ["driver", "sensor"]],
        gap=gaps_of(found), notes=["no run is warmer than 35 degC: thermal fade cannot be assessed"],
        augmented={} if bench else {"plant": {}},
        evidence=result.Evidence(found, rig(bench=bench)[0], None, alike(), [] if bench else comfort),
        parameters=[result.CalibratedParameter("plant.suspension_damping", 150.0, 147.0, (147.0, 153.0), True, "N s/m"),
                    result.CalibratedParameter("plant.frame_mass", 20.0, 20.2, (19.6, 20.4), False, "kg")],
    )  # fmt: skip


def ambiguous():
    first = {"suspension.friction": 0.55, "damper.seal_friction": 0.45}
    reason = "at zero current the damper's own force is small, so that a load cell sees the friction of the seal alone"
    sentence = "friction of 45 N in the linkage or at the damper's seal explains 83 % of the gap"
    return replace(
        known(("frame_acceleration", "driver_acceleration", "suspension_displacement")), verdict="ambiguous",
        sentence=f"{sentence}; without a load cell they cannot be distinguished", causes=ranked(first),
        where=[result.Share("suspension", 0.5), result.Share("damper", 0.5)], selected=["suspension.friction"],
        indistinguishable=[list(first)],
        experiment=result.ProposedExperiment("intervention", "add_load_cell", reason, 0.9876, 0.3456),
    )  # fmt: skip


def unknown(channels=tuple(SEAT), lacking=("damper", "force", "N")):
    motion, _, lacks = rig()
    rows = np.arange(len(motion["velocity"])) / RATE
    force = lacks["damper_force"] + 3 * np.random.default_rng(6).standard_normal(len(rows))
    words = ["It follows the sign of the velocity.", "It is there only while the current falls."]
    discrepancy = result.DiscrepancySignal(*lacking, rows, force, words)
    base = known(channels)
    found = [replace(trace, after=trace.calibrated) for trace in base.evidence.traces]
    return replace(
        base, verdict="unknown", sentence="a force of 70 N in the damper stays that no effect of the library explains",
        causes=ranked({"damper.magnetic_saturation": 0.3}), probability_unknown=0.94, selected=[], gap=gaps_of(found),
        evidence=replace(base.evidence, traces=found, discrepancy=discrepancy),
    )  # fmt: skip


def none():
    base, found = known(), traces(tuple(SEAT), gap=0.0)
    return replace(
        base, verdict="none", sentence="there is no gap beyond noise and the tolerance of the parameters", where=[],
        causes=ranked({}), probability_none=0.98, probability_unknown=0.01, selected=[], gap=gaps_of(found),
        evidence=replace(base.evidence, traces=found),
    )  # fmt: skip


def bench():
    return known(("damper_force", "coil_current"), bench=True)


def with_every_run():
    """A diagnosis of three runs of 24 s at 500 Hz, two of which were fitted."""
    base, others = known(), traces(tuple(SEAT), runs=("run-a", "run-b"))
    sizes = (base.gap.before, base.gap.calibrated, base.gap.after, base.gap.floor, base.gap.shrink)
    gaps = [result.RunGaps(run, *sizes) for run in ("run-a", "run-b", "run-c")]
    return replace(base, evidence=replace(base.evidence, other_traces=others), gap=replace(base.gap, by_run=gaps))


CASES = {"none": none, "known": with_every_run, "ambiguous": ambiguous, "unknown": lambda: unknown(("damper_force",)),
         "bench": bench}  # fmt: skip
