"""Settings of the selection of effects."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from seatsim.diagnosis.settings.threshold import CONVENTION, NUMERICAL, SIMULATED_RIGS, Threshold


class SelectionSettings(NamedTuple):
    """Subset selection: screening by linear models, fits of single effects, then of larger sets."""

    first_shortlist: Annotated[
        int,
        Threshold(
            "-",
            "candidates whose fit is begun after the screening for a first effect",
            "fewer: an effect that a linear model underrates is missed; more: time",
            SIMULATED_RIGS,
        ),
    ] = 12
    further_shortlist: Annotated[
        int,
        Threshold(
            "-",
            "candidates whose fit is begun after the screening for a further effect",
            "as `first_shortlist`",
            SIMULATED_RIGS,
        ),
    ] = 7
    finalists: Annotated[
        int,
        Threshold(
            "-", "begun fits that are carried to their end", "fewer: slow starters are lost; more: time", SIMULATED_RIGS
        ),
    ] = 4
    begun_steps: Annotated[
        int,
        Threshold("-", "steps after which a begun fit is compared with the others", "as `finalists`", SIMULATED_RIGS),
    ] = 2
    beam: Annotated[
        int,
        Threshold(
            "-",
            "sets of each size from which the next larger ones are made",
            "1 is a greedy search, which a wrong first effect misleads",
            SIMULATED_RIGS,
        ),
    ] = 2
    largest_set: Annotated[
        int, Threshold("-", "most effects of a set", "more: time, and sets that explain anything", CONVENTION)
    ] = 3
    largest_uniform_set: Annotated[
        int,
        Threshold(
            "-",
            "most effects of a set that is sought under uniform weights",
            "more: time",
            CONVENTION,
        ),
    ] = 2
    stretch: Annotated[
        float,
        Threshold(
            "-",
            "largest factor by which the screening enlarges the start of a candidate",
            "larger: a linear model is trusted farther than it holds",
            SIMULATED_RIGS,
        ),
    ] = 6.0
    swap_within: Annotated[
        float,
        Threshold(
            "-",
            "factor on the cost of an effect within which another one is tried in its place",
            "larger: more fits; smaller: a wrong member of a set stays",
            SIMULATED_RIGS,
        ),
    ] = 1.5
    most_swaps: Annotated[
        int, Threshold("-", "effects that are tried in the place of each one", "as `swap_within`", SIMULATED_RIGS)
    ] = 3
    start_factors: Annotated[
        tuple[float, ...],
        Threshold(
            "-",
            "multiples of the size that a linear model predicts at which a candidate is started",
            "more: fewer fits that end in a wrong minimum, more time",
            SIMULATED_RIGS,
        ),
    ] = (0.6, 1.0, 1.6)
    limit_factors: Annotated[
        tuple[float, ...],
        Threshold(
            "-",
            "factors that are tried on a limit that acts too much; their inverses where it acts too little",
            "as `start_factors`: a limit acts by what exceeds it, so that its size must be near",
            SIMULATED_RIGS,
        ),
    ] = (1.08, 1.16, 1.27)
    limit_starts: Annotated[
        tuple[float, ...],
        Threshold(
            "-",
            "factors on the start of a limit from which fits are begun",
            "a fit does not feel a limit far beyond the motion",
            SIMULATED_RIGS,
        ),
    ] = (1.0, 0.5, 0.7, 1.4, 2.0)
    shape_reach: Annotated[
        float,
        Threshold(
            "-",
            "factor by which a parameter of shape may leave its start",
            "larger: effects imitate each other by extreme shapes",
            SIMULATED_RIGS,
        ),
    ] = 8.0
    least_factor: Annotated[
        float, Threshold("-", "factor on a start below which the data do not show the candidate at all", "-", NUMERICAL)
    ] = 1e-3
    nothing_left: Annotated[
        float,
        Threshold(
            "-",
            "reduced chi-square less 1 below which nothing is left to explain",
            "lower: false alarms; higher: weak effects are missed",
            SIMULATED_RIGS,
        ),
    ] = 0.15
    promising: Annotated[
        float,
        Threshold(
            "-",
            "share of what is left so far that a further effect may leave, as predicted, for it to be tried",
            "lower: further effects are missed; higher: time",
            "effects that are far from linear were predicted to leave up to 0.95, and left 0.05",
        ),
    ] = 0.97
    enlarge: Annotated[
        float,
        Threshold(
            "-",
            "share of what is left that a further effect must leave at most",
            "higher: a second effect is stated where the first has another form than its candidate",
            SIMULATED_RIGS,
        ),
    ] = 0.45
    enlarge_explained: Annotated[
        float,
        Threshold(
            "-",
            "the same of a set that explains the recording already, where the gap falls too",
            "as `enlarge`",
            "on simulated rigs true second effects left up to 0.66, false ones 0.77 and more",
        ),
    ] = 0.7
    gap_lowered: Annotated[
        float,
        Threshold(
            "-",
            "share of the gap beyond noise that it then leaves at most",
            "as `enlarge`",
            "on simulated rigs true second effects left up to 0.8, false ones 0.9 and more",
        ),
    ] = 0.85
    worthwhile: Annotated[
        float,
        Threshold(
            "-",
            "larger sets are sought while the last enlargement left less than this share",
            "higher: time",
            SIMULATED_RIGS,
        ),
    ] = 0.85
