"""Settings of the comparison with other models of the damper."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from seatsim.diagnosis.settings.threshold import CONVENTION, NUMERICAL, Threshold


class DamperFormSettings(NamedTuple):
    """Other models of the damper in the place of the nominal's."""

    models: Annotated[
        tuple[str, ...],
        Threshold(
            "-",
            "models that are fitted, but for the nominal's own",
            "more: time; fewer: forms of the force that nobody asks about",
            "one of each mechanism: no hysteresis, a state, a lag of the fluid, a spring in series, a free play",
        ),
    ] = ("biviscous", "bouc_wen", "phase_transition", "maxwell_nonlinear_slider", "ellis")
    least_rest: Annotated[
        float,
        Threshold(
            "-",
            "least gap of the damper force, in its standard deviations and beyond noise, from which they are fitted",
            "lower: time for forms that change little; higher: a wrong form is not mentioned",
            "twice what an effect moves to count as material",
        ),
    ] = 0.1
    rows: Annotated[
        int,
        Threshold(
            "-",
            "rows of all runs together that a model is fitted to, the liveliest of each",
            "fewer: less of the range is seen; more: time",
            "seconds for the slowest model",
        ),
    ] = 4000
    evaluations: Annotated[
        tuple[int, int],
        Threshold(
            "-", "most evaluations of least squares from each start, and from the better one", "more: time", NUMERICAL
        ),
    ] = (4, 12)
    better: Annotated[
        float,
        Threshold(
            "-",
            "least share beyond the nominal's own: of the gap, for a model to be named; of the force, to be simulated",
            "lower: a form is named that only has more parameters",
            CONVENTION,
        ),
    ] = 0.1
