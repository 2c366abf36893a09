"""Other models of the damper, fitted in the nominal's place and judged on a run left out of their fit.

An effect changes the nominal damper; here its whole form is the hypothesis. The motion of the damper and the current in
its coil are known well, so that a model is fitted to the recorded force as on a bench (open loop),

    min over parameters   sum over runs  mean (F_model(x, v, i, T) + F_effects - F_measured)^2 / std(F_measured)^2

with the parameters free of the tolerance. F_effects is what the effects found add to the nominal's force along this
motion. The rig is then simulated with the model in the nominal's place (closed loop), effects and all, on the run left
out. The nominal's own model is fitted as freely, since another form is worth only what it takes beyond that.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple, cast

import numpy as np

from seatsim.dampers.base import Damper
from seatsim.diagnosis.problem import DiagnosisProblem
from seatsim.diagnosis.result import DamperForm, Gaps
from seatsim.effects.base import ON_DAMPER, acts_on
from seatsim.identification.damper_record import DamperRecord, FieldValue, find_model
from seatsim.identification.problem import state_problem
from seatsim.identification.search import default_vector, descend_from_defaults, refine
from seatsim.identification.settings import IdentificationSettings
from seatsim.recordings.bench_tables import BenchRecord
from seatsim.recordings.gap import measure_gap
from seatsim.rig.temperature import Thermal
from seatsim.scenario.scenario import Scenario
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError, RunError
from seatsim.schema.registry import name_of
from seatsim.schema.text import join_names
from seatsim.simulation.augment import undo_reading
from seatsim.simulation.inputs import BenchInputs
from seatsim.simulation.respond import fit_motion, respond

_MOTION = {"seat": "suspension_displacement", "damper_bench": "displacement"}
"""Channel from which the motion of the damper is taken, by rig."""


_ROWS = 4000
"""Rows of all runs together that a model is fitted to, the liveliest of each: seconds for the slowest model."""
_EVALUATIONS = (4, 12)
"""Most evaluations of least squares from each start, and from the better one."""


class _FormFit(NamedTuple):
    """A model fitted to the damper force: the rig with it, its parameters, and its cost."""

    model: str
    scenario: Scenario
    parameters: dict[str, FieldValue]
    cost: float


def are_forms_due(problem: DiagnosisProblem, gaps: Gaps, verdict: str) -> bool:
    """Whether the scenario found leaves so much of the damper force that other models are tried without being asked."""
    left, floor = (figures.channels.get("damper_force", 0.0) for figures in (gaps.after, gaps.floor))
    least = problem.settings.damper_forms.least_rest
    return verdict != "none" and left**2 - floor**2 > least**2 and not describe_obstacle(problem)


def describe_obstacle(problem: DiagnosisProblem) -> str:
    """Return why no other model of the damper can be judged on a recording, empty where one can."""
    motion = _MOTION[problem.recording.header.rig]
    missing = [name for name in ("damper_force", motion) if name not in problem.recording.channels]
    if missing:
        return f"Other forms of the damper were not tried: {missing[0]} is not recorded."
    if len(problem.runs) < 2:
        return "Other forms of the damper were not tried: there is no second run to judge them on."
    return ""


def compare_damper_forms(
    problem: DiagnosisProblem, calibrated: Scenario, augmented: Scenario, run: str
) -> list[DamperForm]:
    """Return other models of the damper beside the effects found, and the best one instead of them; the best first.

    On a bench every model is driven through the run left out; on a seat, where each has to be compiled into a time loop
    of its own, only the one that fits the force best, if it does so better than the nominal's own. A model that leaves
    all bounds is not among them.

    Args:
        problem: a recording with damper force and motion, and at least two runs.
        calibrated: the nominal scenario with refitted parameters, fitted without the run.
        augmented: the same with the effects found, which equals `calibrated` where none were.
        run: left out of all fits.
    """
    before = measure_gap(calibrated, problem.recording, [run]).overall
    if before == 0.0:
        return []
    own = name_of("damper", type(calibrated.damper.record))
    models = [name for name in problem.settings.damper_forms.models if name != own]
    beside = tuple(name_of("effect", type(each)) for each in augmented.effects if each not in calibrated.effects)
    found = list(_compare_about(problem, augmented, models, beside, run, before))
    if found and beside:
        best = max(found, key=lambda form: form.shrink).model
        found += _compare_about(problem, calibrated, [best], (), run, before)
    return sorted(found, key=lambda form: -form.shrink)


def describe_forms(forms: Sequence[DamperForm], gaps: Gaps, better: float) -> str:
    """Return what other models explain in one sentence, empty where they hardly take more than the nominal's own.

    Shares are of what remains of the calibrated gap: beside the effects found where there are any, else of all of it.
    `better`: least share that a model takes beyond the nominal's own to be named.
    """
    if not forms or gaps.after.overall == 0.0:
        return ""
    credit = 1.0 - gaps.after.overall / gaps.calibrated.overall
    best = next(form for form in forms if form.beside == max(each.beside for each in forms))
    credit = credit if best.beside else 0.0
    share, own = ((shrink - credit) / (1.0 - credit) for shrink in (best.shrink, best.refitted))
    said = ""
    if share - max(own, 0.0) >= better:
        said = f"another form of the damper (`{best.model}` for `{best.replaces}`) takes {share:.0%} of what remains"
        said += f", `{best.replaces}` itself with free parameters {own:.0%}" if own >= better else ""
    elif own >= better:
        said = f"`{best.replaces}` with parameters outside their tolerance takes {own:.0%} of what remains"
    instead = next((form for form in forms if not form.beside and best.beside), None)
    if instead is not None and instead.shrink >= max(credit, instead.refitted + better):
        said += f"{'; ' * bool(said)}the form `{instead.model}` in the place of {join_names(best.beside)} takes"
        said += f" {instead.shrink:.0%} of the gap against {credit:.0%}"
    return said and f"{said[0].upper()}{said[1:]}."


def _compare_about(
    problem: DiagnosisProblem, rig: Scenario, models: Sequence[str], beside: tuple[str, ...], run: str, before: float
) -> Iterator[DamperForm]:
    """Yield the models in one rig, in which the effects `beside` were found; `before`: the calibrated gap."""
    records = [_isolate_damper(problem, rig, name) for name in problem.runs if name != run]
    own = name_of("damper", type(rig.damper.record))

    def shrink(fit: _FormFit | None) -> float:
        """Return what a fit takes off the gap, minus infinity where there is none or its rig leaves all bounds."""
        if fit is None:
            return -math.inf
        try:
            return 1.0 - measure_gap(fit.scenario, problem.recording, [run]).overall / before
        except RunError:
            return -math.inf

    as_free = _fit_form(problem, rig, own, records)
    refitted = max(0.0, shrink(as_free))
    fits = [fit for name in models if (fit := _fit_form(problem, rig, name, records)) is not None]
    if not problem.bench:
        # The fit that leaves least of the force is simulated where that is less than the nominal's own leaves.
        highest = math.inf if as_free is None else as_free.cost * (1.0 - problem.settings.damper_forms.better) ** 2
        fits = [fit for fit in sorted(fits, key=lambda fit: fit.cost)[:1] if fit.cost < highest]
    for fit in fits:
        if math.isfinite(gain := shrink(fit)):
            yield DamperForm(fit.model, own, beside, gain, refitted, fit.parameters)


def _isolate_damper(problem: DiagnosisProblem, rig: Scenario, run: str) -> BenchRecord:
    """Return what moves the damper alone in a run, as a record of a bench, and the force without that of effects."""
    table, interval = problem.recording.table(run), 1.0 / problem.rate

    def true(channel: str, values: Array) -> Array:
        return undo_reading(rig.effects, values, channel, interval)

    channel, ratio = _MOTION[problem.recording.header.rig], rig.plant.damper_ratio if rig.plant else 1.0
    position, noise = ratio * true(channel, table[channel]), ratio * problem.recording.channels[channel].noise_rms
    spline, rows = fit_motion(interval, position.tobytes(), noise), interval * np.arange(len(position))
    warm = rig.temperature.start if isinstance(rig.temperature, Thermal) else rig.temperature
    temperature = table.get("damper_temperature", np.full(len(rows), warm))
    driving = true("coil_current", respond(rig, problem.inputs[run])["coil_current"])
    alone = BenchInputs(interval, position, noise, coil_current=driving, damper_temperature=temperature)
    acting = tuple(effect for effect in rig.effects if acts_on(type(effect), (*ON_DAMPER, "factors", "temperature")))
    with_effects, without = (
        respond(dataclasses.replace(rig, effects=effects), alone)["damper_force"] for effects in (acting, ())
    )
    force = true("damper_force", table["damper_force"]) - (with_effects - without)
    velocity = true("velocity", table["velocity"]) if "velocity" in table else spline.derivative()(rows)
    motion = spline(rows), velocity
    record = BenchRecord(run, run, problem.rate, *motion, force, np.maximum(driving, 0.0), False, temperature)
    return record.part(*record.liveliest(_ROWS // len(problem.runs)))


def _fit_form(problem: DiagnosisProblem, rig: Scenario, model: str, records: Sequence[BenchRecord]) -> _FormFit | None:
    """Return the rig with a model fitted to the damper's records, None where the model cannot be fitted to them."""
    record = cast("DamperRecord", rig.damper.record)
    known = record if name_of("damper", type(record)) == model else None
    try:
        stated, _ = state_problem(
            records, find_model(model), 0.0, IdentificationSettings(ignore_temperature=True), known
        )
        stated = stated._replace(factors=rig.damper.factors)
        start = (
            descend_from_defaults(stated, problem.pool, most=_EVALUATIONS[0]).vector
            if known is None
            else default_vector(stated)
        )
        found = refine(stated, start, problem.pool, most=_EVALUATIONS[1])
    except (InputError, ArithmeticError, np.linalg.LinAlgError):
        return None
    damper = stated.to_bench(found.vector).damper
    choice = dataclasses.replace(rig.damper, record=cast("Damper", damper))
    return _FormFit(model, dataclasses.replace(rig, damper=choice), damper._asdict(), found.cost)
