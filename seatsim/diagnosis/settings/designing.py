"""Settings of the collinearity table and of proposed experiments."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from seatsim.diagnosis.settings.threshold import CONVENTION, NUMERICAL, SIMULATED_RIGS, Threshold


class DesignSettings(NamedTuple):
    """What can be distinguished, now and by a further experiment."""

    faint: Annotated[
        float,
        Threshold(
            "-",
            "length of a projected sensitivity, in noise units, below which it is collinear with nothing",
            "-",
            NUMERICAL,
        ),
    ] = 1e-9
    effect_std: Annotated[
        float,
        Threshold(
            "-",
            "prior standard deviation of an effect's parameter, in its natural size",
            "lower: effects are separable only because they are thought small",
            CONVENTION,
        ),
    ] = 10.0
    structures: Annotated[
        int, Threshold("-", "structures and channels of an effect that are fitted", "more: time", SIMULATED_RIGS)
    ] = 4
    stretch: Annotated[
        float,
        Threshold("-", "largest factor by which the start of an effect is made larger or smaller", "-", NUMERICAL),
    ] = 8.0
    separated: Annotated[
        float,
        Threshold(
            "-",
            "least separability, in noise units, of an experiment that is proposed",
            "lower: experiments that do not decide; higher: none is proposed",
            SIMULATED_RIGS,
        ),
    ] = 30.0
    unlike: Annotated[
        float,
        Threshold(
            "-",
            "likeness below which the cheapest experiment is taken",
            "higher: experiments whose outcome a model error can reverse",
            SIMULATED_RIGS,
        ),
    ] = 0.9
    listed: Annotated[int, Threshold("-", "most effects of the collinearity table", "-", CONVENTION)] = 10
    listed_probability: Annotated[
        float, Threshold("-", "least probability of an effect of the collinearity table", "-", CONVENTION)
    ] = 0.003
    trials: Annotated[
        int,
        Threshold("-", "excitations that are tried to optimise the best of the menu", "more: time", CONVENTION),
    ] = 16
    largest_travel: Annotated[
        float,
        Threshold(
            "m",
            "travel that an excitation may take either way, where the scenario states none",
            "higher: excitations that no seat can follow",
            CONVENTION,
        ),
    ] = 0.05
