"""Settings of the localisation of what no effect explains."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from seatsim.diagnosis.settings.threshold import CONVENTION, NUMERICAL, SIMULATED_RIGS, Threshold


class ReconstructionSettings(NamedTuple):
    """Estimation of an unknown input that matches the measured channels."""

    probe_size: Annotated[
        float,
        Threshold(
            "-",
            "size of random probing inputs, as a share of the floor's motion and of the force that it means",
            "larger: the rig is not linear about the motion; smaller: rounding",
            NUMERICAL,
        ),
    ] = 0.1
    largest_input: Annotated[
        float,
        Threshold(
            "-",
            "factor from the probing input to the largest plausible one",
            "larger: every block explains everything; smaller: strong causes are not reached",
            SIMULATED_RIGS,
        ),
    ] = 10.0
    plausible_corner: Annotated[
        float, Threshold("Hz", "frequency above which the spectrum of plausible inputs falls", "-", SIMULATED_RIGS)
    ] = 2.0
    probe_corner: Annotated[
        float, Threshold("Hz", "frequency above which the spectrum of probing inputs falls", "-", NUMERICAL)
    ] = 40.0
    rounds: Annotated[int, Threshold("-", "most corrections of an input", "more: time", NUMERICAL)] = 20
    settled: Annotated[
        float,
        Threshold("-", "a correction that lowers what is left by less than this share is fruitless", "-", NUMERICAL),
    ] = 0.02
    fruitless: Annotated[
        int,
        Threshold(
            "-",
            "fruitless corrections in a row after which the estimate ends",
            "1: one misleading probe ends it",
            NUMERICAL,
        ),
    ] = 2
    backtracking: Annotated[
        tuple[float, ...], Threshold("-", "fractions of a correction that are tried in turn", "-", NUMERICAL)
    ] = (1.0, 0.4, 0.15, 0.05)
    regained: Annotated[
        float,
        Threshold("-", "factor on a force that repeated runs show, for what its filter takes", "-", SIMULATED_RIGS),
    ] = 1.2


class LocalisationSettings(NamedTuple):
    """Which block holds the remainder, and what its signal is."""

    decisive: Annotated[
        float,
        Threshold(
            "-",
            "share of what the best block explains by which another must fall short to be distinguished from it",
            "higher: shares of blocks are similar; lower: a confident wrong block",
            SIMULATED_RIGS,
        ),
    ] = 0.1
    above_noise: Annotated[
        float,
        Threshold(
            "-",
            "reduced chi-square less 1 from which an unknown input may take the place of effects",
            "lower: noise passes for an input, which gives up effects that runs left out support",
            "as much as noise itself leaves",
        ),
    ] = 1.0
    slight: Annotated[
        float,
        Threshold(
            "-",
            "share of the gap by which effects that do not explain it must help an unknown input to be kept",
            "higher: effects beside an unknown cause are given up",
            SIMULATED_RIGS,
        ),
    ] = 0.02
    remainder_factor: Annotated[
        float,
        Threshold(
            "-",
            "share of the remainder's block beside the largest share of the effects found",
            "above 1, since an unknown cause stands first",
            CONVENTION,
        ),
    ] = 1.2
    slow_frequency: Annotated[
        float,
        Threshold(
            "Hz",
            "frequency below which the zero of a sensor drifts, and no floor moves so much that it matters",
            "higher: motions of the floor are taken for drift",
            SIMULATED_RIGS,
        ),
    ] = 0.5
    slow_share: Annotated[
        float,
        Threshold("-", "least share of its power that a bias drift has below that frequency", "-", SIMULATED_RIGS),
    ] = 0.9
    drift_alone: Annotated[
        float,
        Threshold(
            "-",
            "factor by which the gap left in a channel exceeds those of all others where its zero drifts",
            "lower: an error of the model is taken for drift",
            SIMULATED_RIGS,
        ),
    ] = 2.0
    stochastic_share: Annotated[
        float,
        Threshold(
            "-",
            "share of the gap that an effect with a stochastic signal is said to make beside others",
            "-",
            CONVENTION,
        ),
    ] = 0.6
    regression_rate: Annotated[float, Threshold("Hz", "rate at which signals are regressed", "-", NUMERICAL)] = 100.0
    lags: Annotated[
        int,
        Threshold("-", "past samples of the motion that a linear filter may use", "more: overfitting", SIMULATED_RIGS),
    ] = 10
    ridge: Annotated[float, Threshold("-", "ridge, relative to the regressors' power", "-", NUMERICAL)] = 1e-3
    least_ridge: Annotated[
        float,
        Threshold(
            "-", "least ridge, for regressors that are all at rest, such as a current that never flows", "-", NUMERICAL
        ),
    ] = 1e-9
    predicted: Annotated[
        float,
        Threshold(
            "-",
            "share of the variance on left-out runs (R2) from which a force belongs to the rig",
            "higher: rattles are taken for forces from outside",
            SIMULATED_RIGS,
        ),
    ] = 0.12
    steady: Annotated[
        float,
        Threshold(
            "-",
            "ratio of its RMS in two runs up to which a force may come from outside",
            "higher: forces that follow the motion are taken for forces from outside",
            SIMULATED_RIGS,
        ),
    ] = 1.4
    steady_by_chance: Annotated[
        float,
        Threshold(
            "-",
            "standard deviations by which its power may differ beyond that, as it differs between blocks of time",
            "higher: rattles are taken for forces from outside; lower: a few knocks are not",
            "two, as in a test at 5 %",
        ),
    ] = 2.0
    slow_slip: Annotated[
        float, Threshold("m/s", "velocity scale of the smooth friction among the regressors", "-", SIMULATED_RIGS)
    ] = 0.03
    fast_slip: Annotated[
        float, Threshold("m/s", "velocity scale of the sharp friction among the regressors", "-", SIMULATED_RIGS)
    ] = 0.005
    worth_naming: Annotated[
        float, Threshold("-", "R2 from which a family of regressors is named in the report", "-", CONVENTION)
    ] = 0.1
