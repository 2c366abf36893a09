"""What is known of the figures of a report: collected from the results themselves, never stated by anybody."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from seatsim.dampers.base import DAMPERS, find_confidence
from seatsim.provenance.statement import current_invocation
from seatsim.recordings.header import NOT_STATED
from seatsim.schema.fields import UNUSUAL
from seatsim.schema.registry import name_of
from seatsim.simulation.result import Run

if TYPE_CHECKING:
    from seatsim.characterisation.summary import Characterisation
    from seatsim.diagnosis.result import Diagnosis
    from seatsim.identification.identify import Identification
    from seatsim.recordings.gap import Gap
    from seatsim.standards.seat_rows import SeatTest
    from seatsim.sweeps.rows import Exceedance, SweepRows
    from seatsim.sweeps.sensitivity import Sensitivities

COMFORT = "driver_acceleration_weighted"


class Evidence(NamedTuple):
    """What is known of some figures; None where it does not exist, shares of 1.

    kind: of the result, with "measured" in it where no figure is simulated. energy: largest part of the energy that
    is unaccounted for. step: largest change of an output by halving the step. compared, held_out: recorded runs
    that were compared, and those of them that took no part in a fit. error, noise: gap on the latter, where there
    are some, and that of the sensors' noise. inputs: files whose hashes the manifest keeps. doubts: ranges left,
    values that no seat has. dampers: models with the word on their source. parameters_known: the recording states
    how well, which is no default, or records of this damper determine them. loose: parameters that no data
    determine. intervals: what has one. parameter_intervals, answer_interval: whether parameters and the answer do.
    budget: the error is divided into its parts. runs: that were simulated or recorded. varied: keys that were
    varied or refitted. drawn: those from a distribution. explained: share of the variance that the keys explain.
    limits: shares of runs beyond limits are known.
    """

    kind: str
    energy: float | None = None
    step: float | None = None
    compared: int = 0
    held_out: int = 0
    error: float | None = None
    noise: float | None = None
    inputs: int | None = None
    doubts: Sequence[str] = ()
    dampers: Mapping[str, str] = {}
    parameters_known: bool = False
    loose: Sequence[str] = ()
    intervals: Sequence[str] = ()
    parameter_intervals: bool = False
    answer_interval: bool = False
    budget: bool = False
    runs: int = 0
    varied: Sequence[str] = ()
    drawn: Sequence[str] = ()
    explained: float | None = None
    limits: bool = False


def collect_runs(runs: Sequence[Run]) -> Evidence:
    """Return what is known of simulated runs."""
    energies = [run.metrics["energy_residual"].value for run in runs if "energy_residual" in run.metrics]
    return _record(
        Evidence(
            "runs",
            energy=_largest(energies),
            doubts=tuple(dict.fromkeys(text for run in runs for text in run.warnings)),
            dampers=_judge_dampers({type(run.scenario.damper.record) for run in runs}),
            runs=len(runs),
        )
    )


def collect_sweep(rows: SweepRows, found: Sensitivities, exceeded: Sequence[Exceedance]) -> Evidence:
    """Return what is known of a sweep, whose identity keeps the hashes of its inputs."""
    stated = rows.manifest["configuration"]
    damper = stated["scenario"].get("damper", {}) if isinstance(stated.get("scenario"), dict) else {}
    model = damper.get("model") if isinstance(damper, dict) else None
    reasons = tuple(sorted({str(text) for text in rows.every.reason.dropna() if text}))
    return Evidence(
        "sweep",
        energy=_largest(rows.usable["energy_residual"].dropna()) if "energy_residual" in rows.metrics else None,
        inputs=1 + len(stated.get("files", {})),
        doubts=reasons,
        dampers=_judge_dampers([DAMPERS.find(model)]) if model in DAMPERS.names() else {},
        intervals=[*(["shares of the variance"] if found.rows else []), *(["shares above limits"] if exceeded else [])],
        answer_interval=bool(found.rows),
        runs=len(rows.usable),
        varied=rows.keys,
        drawn=rows.drawn,
        explained=next((row.explained for row in found.of(COMFORT) or found.rows), None),
        limits=bool(exceeded),
    )


def collect_gap(scenario: str, folder: Path, found: Gap) -> Evidence:
    """Return what is known of a gap."""
    from seatsim.recordings.recording import load_recording
    from seatsim.scenario.loading import single

    chosen, recording = single(scenario), load_recording(folder)
    tolerance = recording.header.parameter_tolerance
    is_fitted = "fitted" in (tolerance.values() if isinstance(tolerance, Mapping) else [tolerance])
    is_nominal = Path(scenario).is_file() and Path(scenario).samefile(folder / recording.header.nominal)
    return _record(
        Evidence(
            "gap",
            compared=len(recording.runs),
            error=found.overall,
            noise=found.floor.overall,
            doubts=found.notes,
            dampers=_judge_dampers([type(chosen.damper.record)]),
            held_out=len(recording.runs) if is_nominal and not is_fitted else 0,
            parameters_known=tolerance is not None and not is_fitted,
            intervals=["the gap, as the noise of the sensors"] if found.floor.overall else [],
            runs=len(recording.runs),
        )
    )


def collect_diagnosis(diagnosis: Diagnosis) -> Evidence:
    """Return what is known of a diagnosis on the runs that it held out."""
    gap = diagnosis.gap
    spreads = {trace.channel: float(np.std(trace.measured)) for trace in diagnosis.evidence.traces}
    steps = [each.u_num / spreads[each.channel] for each in diagnosis.error_budget if spreads.get(each.channel, 0) > 0]
    model = diagnosis.augmented.get("damper", {})
    name = model.get("model") if isinstance(model, Mapping) else None
    uncertain = ["the shrink of the gap"] if all(map(math.isfinite, gap.shrink_interval)) else []
    fitted = [cause for cause in diagnosis.causes if cause.effect in diagnosis.selected and cause.parameters]
    return _record(
        Evidence(
            "diagnosis",
            step=_largest(steps),
            compared=max(len(diagnosis.gap.by_run), len(diagnosis.held_out)),
            held_out=len(diagnosis.held_out),
            error=gap.after.overall,
            noise=gap.floor.overall,
            doubts=[note for note in diagnosis.notes if UNUSUAL in note],
            dampers=_judge_dampers([DAMPERS.find(name)]) if name in DAMPERS.names() else {},
            parameters_known=bool(diagnosis.parameters) and not any(NOT_STATED in note for note in diagnosis.notes),
            loose=[each.name for each in diagnosis.parameters if each.at_bound],
            intervals=[*(["the parameters of the effects"] if fitted else []), *uncertain],
            parameter_intervals=bool(fitted),
            answer_interval=bool(uncertain),
            budget=bool(diagnosis.error_budget),
            runs=len(diagnosis.gap.by_run),
            varied=[each.name for each in diagnosis.parameters],
        )
    )


def collect_identification(found: Identification) -> Evidence:
    """Return what is known of an identified damper, on held-out records where there are some."""
    test, train = found.mean("test"), found.mean("train")
    mean, parts = test or train, [each.part for each in found.assessments]
    return _record(
        Evidence(
            "identification",
            compared=len(parts),
            held_out=parts.count("test"),
            error=None if mean is None else 1.0 - mean.fit_percent / 100.0,
            dampers=_judge_dampers([type(found.bench.damper)]),
            parameters_known=True,
            loose=[each.name for each in found.information.estimates if not each.identified],
            intervals=["the parameters"],
            parameter_intervals=True,
            runs=len(parts),
        )
    )


def collect_characterisation(found: Characterisation) -> Evidence:
    """Return what is known of the figures of a bench's records, or of a model's tests."""
    models = [] if found.measured or found.name not in DAMPERS.names() else [DAMPERS.find(found.name)]
    return _record(
        Evidence(
            "measured bench" if found.measured else "simulated bench",
            doubts=tuple(dict.fromkeys([*found.notes, *(note for row in found.rows for note in row.notes)])),
            dampers=_judge_dampers(models),
            intervals=["the response times"] if any(math.isfinite(each.t95_sd) for each in found.responses) else [],
            runs=len(found.rows),
        )
    )


def collect_seat_test(found: SeatTest, is_measured: bool) -> Evidence:
    """Return what is known of a seat test, simulated or measured."""
    spread = [row for row in found.rows if row.within_spread is not None]
    return _record(
        Evidence(
            "measured seat test" if is_measured else "simulated seat test",
            doubts=(*found.notes, *(failure.reason for failure in found.failures)),
            intervals=["the SEAT factors, by the spread of their runs"] if spread else [],
            runs=len(found.rows),
            varied=["spectral class", "mass of the test person"] if len({row.person for row in found.rows}) > 1 else [],
        )
    )


def _record(evidence: Evidence) -> Evidence:
    """Return evidence with what the manifest of the command at work keeps; from Python there is none."""
    invocation = current_invocation()
    if invocation is None:
        return evidence
    # Drafts that were read back are gone.
    return evidence._replace(inputs=sum(path.is_file() for path in invocation.reads))


def _largest(values: Iterable[float]) -> float | None:
    """Return the largest of some values, None where there is none or one is not known."""
    found = [float(value) for value in values]
    return max(found) if found and all(map(math.isfinite, found)) else None


def _judge_dampers(classes: Iterable[type]) -> dict[str, str]:
    """Return the word on the source of each damper model, by its name."""
    return dict(sorted((name_of("damper", cls), find_confidence(cls)) for cls in classes if cls in _registered()))


def _registered() -> set[type]:
    return {DAMPERS.find(name) for name in DAMPERS.names()}
