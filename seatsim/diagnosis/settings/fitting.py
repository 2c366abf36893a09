"""Settings of the fits, and of the second pass with wider tolerances."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from seatsim.diagnosis.settings.threshold import CONVENTION, NUMERICAL, SIMULATED_RIGS, Threshold


class FitSettings(NamedTuple):
    """Gauss-Newton fits of nuisance parameters and effects."""

    prior_std: Annotated[
        float,
        Threshold(
            "-",
            "standard deviation of a nuisance parameter, as a share of its tolerance",
            "lower: parameters absorb less of an effect",
            "1/sqrt(3), of a uniform distribution",
        ),
    ] = 0.58
    difference_step: Annotated[
        float,
        Threshold(
            "-",
            "step of the finite differences, in natural sizes of a parameter",
            "larger: curvature enters; smaller: switching dampers make differences rough",
            NUMERICAL,
        ),
    ] = 0.02
    most_steps: Annotated[
        int,
        Threshold(
            "-",
            "most Gauss-Newton steps of a fit",
            "more: hard fits end nearer their minimum, and take longer",
            NUMERICAL,
        ),
    ] = 6
    settled: Annotated[
        float,
        Threshold(
            "-",
            "a fit ends where a step lowers its cost by less than this share",
            "lower: more steps for no change of the verdict",
            NUMERICAL,
        ),
    ] = 0.01
    backtracking: Annotated[
        tuple[float, ...],
        Threshold("-", "fractions of a step that are tried in turn", "more of them: slower, safer descents", NUMERICAL),
    ] = (1.0, 0.4, 0.12)
    pattern_steps: Annotated[
        tuple[float, ...],
        Threshold(
            "-",
            "steps of a pattern search, in natural sizes of a parameter",
            "the first larger: other minima are reached; the last smaller: a nearer minimum, more time",
            NUMERICAL,
        ),
    ] = (0.3, 0.15, 0.08, 0.04, 0.02)
    search_share: Annotated[
        float,
        Threshold(
            "-",
            "share of the time budget after which the search ends",
            "higher: more is tried where time is short; lower: more of it is left to validate and state the answer",
            CONVENTION,
        ),
    ] = 0.7
    fitted_tolerance: Annotated[
        float,
        Threshold(
            "-",
            "tolerance of parameters that a recording states as `fitted`",
            "higher: effects vanish in parameters; lower: what a fit has absorbed of an effect cannot be given back",
            "a viscous coefficient fitted in place of a missing friction came out twice as large",
        ),
    ] = 0.5


class WideningSettings(NamedTuple):
    """The second search, with wider tolerances of the parameters that end at their bounds."""

    at_bound: Annotated[
        float,
        Threshold("-", "deviation, in tolerances, from which a parameter is at its bound", "-", NUMERICAL),
    ] = 0.98
    factor: Annotated[
        float,
        Threshold(
            "-",
            "factor on the tolerance of parameters at their bounds",
            "larger: a parameter takes the place of an effect; smaller: what a fit has absorbed stays absorbed",
            CONVENTION,
        ),
    ] = 3.0
    promising: Annotated[
        float,
        Threshold(
            "-",
            "share of the remainder that the same effects may leave within the wider tolerance for a search to be made",
            "lower: a wrong first set is kept; higher: time",
            SIMULATED_RIGS,
        ),
    ] = 0.7
    clearly_less: Annotated[
        float,
        Threshold(
            "-",
            "share of the remainder that the second search may leave for it to be stated",
            "higher: stated tolerances are overruled by what lies outside the library",
            SIMULATED_RIGS,
        ),
    ] = 0.5
    strained: Annotated[
        int,
        Threshold(
            "-",
            "parameters at their bounds from which several effects that explain everything are tried with one less",
            "lower: a true second effect is taken for a parameter; higher: a false one stays beside the true one",
            SIMULATED_RIGS,
        ),
    ] = 3
