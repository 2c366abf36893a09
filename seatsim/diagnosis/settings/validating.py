"""Settings of the cross-validation and of the validation on a held-out run."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from seatsim.diagnosis.settings.threshold import CONVENTION, NUMERICAL, SIMULATED_RIGS, Threshold


class CrossValidationSettings(NamedTuple):
    """Selection by the gap of runs left out, where no set explains the gap."""

    noise_level: Annotated[
        float,
        Threshold(
            "-", "share of the gap that counts as noise under uniform weights", "only scales the cost", CONVENTION
        ),
    ] = 0.1
    independent: Annotated[
        float,
        Threshold(
            "-",
            "how many of the numbers of a gap count as independent",
            "higher: effects are stated that take little of the gap, and parameters within their tolerance cost little",
            "on measured rigs",
        ),
    ] = 40.0
    equivalent: Annotated[
        float,
        Threshold(
            "-",
            "ratio of the evidences of two sets below which they help as much",
            "higher: larger groups, and more often one effect in place of two others",
            "a Bayes factor below 3 is not worth more than a bare mention (Kass and Raftery, 1995)",
        ),
    ] = 3.0
    prior_of_sensor: Annotated[
        float,
        Threshold(
            "-",
            "prior odds of a sensor that errs",
            "higher: a sensor is blamed where a change of the rig does as much",
            "sensors are calibrated, while dampers and cushions age; on measured rigs, where forms are wrong anyway",
        ),
    ] = 0.01
    sets_compared: Annotated[
        int, Threshold("-", "sets of each size that are cross-validated", "more: time", "on measured rigs")
    ] = 8
    folds: Annotated[int, Threshold("-", "parts of the runs that are left out in turn", "more: time", CONVENTION)] = 3
    doubtful: Annotated[
        float,
        Threshold(
            "-",
            "factor by which a run left out may get worse before the step of the other runs is checked and shortened",
            "lower: time; higher: effects far from linear are judged by steps that no fit would take",
            NUMERICAL,
        ),
    ] = 1.5

    @property
    def power(self) -> float:
        """Exponent of the mean square that a set leaves in its evidence."""
        return 0.5 * self.independent


class ValidationSettings(NamedTuple):
    """The shrink stated on a run held out of the fit, with its interval."""

    block_length: Annotated[
        float,
        Threshold(
            "s",
            "length of the blocks of the bootstrap",
            "shorter than the rig's memory: intervals too narrow; longer: too few blocks",
            "several periods of the seat's resonance",
        ),
    ] = 1.0
    draws: Annotated[int, Threshold("-", "bootstrap samples", "more: time", NUMERICAL)] = 400
    percentiles: Annotated[tuple[float, float], Threshold("%", "ends of the interval", "-", CONVENTION)] = (5.0, 95.0)
    excitation_std: Annotated[
        float,
        Threshold(
            "-",
            "standard deviation by which the shrink differs between excitations of one kind",
            "lower: intervals that do not cover",
            "on sealed rigs with an unseen run",
        ),
    ] = 0.1
    most_share: Annotated[
        float,
        Threshold(
            "-",
            "largest share of what an effect moves in all runs that the held-out run may have",
            "higher: the fit loses the run that shows the effect",
            SIMULATED_RIGS,
        ),
    ] = 0.6
    least_share: Annotated[
        float,
        Threshold(
            "-",
            "least share of it that the held-out run must have",
            "lower: a run that the effect does not touch checks nothing",
            SIMULATED_RIGS,
        ),
    ] = 0.05
    quantile: Annotated[
        float,
        Threshold(
            "-",
            "quantile of the shrink over the suitable runs at which the held-out run lies",
            "higher: a stated shrink that other excitations do not reach",
            "least bias of the stated shrink on sealed rigs",
        ),
    ] = 0.25
    least_time: Annotated[
        float,
        Threshold(
            "-",
            "least standard deviation of a time, as a share of the interval between rows",
            "higher: intervals of delays that are known better are too wide",
            "a tenth of what rounding to whole rows makes",
        ),
    ] = 0.03
    settled: Annotated[
        float,
        Threshold(
            "-",
            "the stated fit ends where a step lowers its cost by less than this share",
            "higher: a parameter ends farther from its estimate than its standard deviation",
            NUMERICAL,
        ),
    ] = 1e-5
    by_chance: Annotated[
        float,
        Threshold(
            "-",
            "standard deviations of the power of noise by which a residual must exceed it to show an error of the form",
            "higher: intervals that do not cover under a wrong form; lower: too wide ones under a right form",
            SIMULATED_RIGS,
        ),
    ] = 2.0
