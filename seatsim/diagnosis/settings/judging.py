"""Settings of the decision, of cross-validation, and of the validation on a held-out run."""

from __future__ import annotations

from typing import NamedTuple


class DecisionSettings(NamedTuple):
    """From fitted sets to none, known, ambiguous or unknown, with probabilities."""

    material: float = 0.05
    """Movement of a channel, in its standard deviations, from which an effect is material.
    Trades off: lower: false alarms; higher: weak second effects are missed.
    Chosen: the recording's contract, which also asks for more than the channel's noise."""
    explained: float = 0.12
    """Share of the calibrated excess that a known set leaves at most.
    Trades off: lower: right sets are called unknown; higher: wrong ones known.
    Chosen: right explanations leave up to 0.06 (one 0.14), wrong ones 0.15 to 1, on simulated and sealed rigs."""
    most_taken: float = 0.65
    """Share of the gap beyond noise from which a set that takes it is known though it leaves more of the excess.
    Trades off: lower: wrong sets are known; higher: right sets are called unknown.
    Chosen: right sets take 0.7 and more, wrong ones up to 0.56, on sealed rigs."""
    left_if_taken: float = 0.35
    """Share of the calibrated excess that such a set leaves at most.
    Trades off: as `explained`.
    Chosen: on simulated rigs."""
    left_in_channel: float = 0.5
    """Share of the excess of a channel with a material gap that a known set leaves at most.
    Trades off: lower: one badly modelled channel makes everything unknown.
    Chosen: on simulated rigs."""
    equivalent: float = 1.2
    """Factor on the excess within which two sets explain a recording equally well.
    Trades off: higher: larger groups of equivalent effects; lower: a confident wrong one.
    Chosen: on simulated rigs."""
    equivalent_floor: float = 0.02
    """Excess added to it, for sets that leave almost nothing.
    Trades off: as `equivalent`.
    Chosen: on simulated rigs."""
    strong_evidence: float = 20.0
    """Ratio of the probabilities of two effects from which a held-out run that contradicts it no longer counts.
    Trades off: higher: more is ambiguous; lower: a confident wrong effect with few parameters.
    Chosen: a Bayes factor above 20 is strong (Kass and Raftery, 1995)."""
    contradicted: float = 0.02
    """Share of the gap by which another effect has to reduce it further in the held-out run.
    Trades off: as `strong_evidence`.
    Chosen: on simulated rigs and on effects put into measured records."""
    first_effect_helps: float = 0.9
    """Share of the excess above which a first effect that does not enlarge the set is passed over.
    Trades off: higher: an effect that hardly helps is chosen beside an unknown cause.
    Chosen: on simulated rigs."""
    equivalent_members: int = 2
    """Most members of a group for which a small remainder suffices to be known.
    Trades off: more: long lists of effects that stand for each other are called an explanation.
    Chosen: on simulated rigs."""
    least_lowered: float = 0.02
    """Cost by which a material effect lowers it, per number compared, for a gap within the expected noise.
    Trades off: lower: false alarms; higher: effects at a few frequencies stay hidden in the noise of all.
    Chosen: without an effect at most 0.035 on simulated rigs, and then never material."""
    none_width: float = 0.05
    """Excess over which the probability of `none` falls from sure to unsure.
    Chosen: on simulated rigs."""
    none_offset: float = 2.0
    """Log odds of `none` at the limit of `nothing_left`.
    Chosen: on simulated rigs."""
    none_least: float = 0.6
    """Least probability of `none` where it is the verdict.
    Chosen: by convention."""
    unknown_width: float = 0.4
    """Width, in the logarithm of the share left, of the step of the probability of `unknown`.
    Trades off: wider: less sure verdicts.
    Chosen: calibrated on simulated rigs."""
    least_share: float = 1e-4
    """Least share left whose logarithm is taken.
    Chosen: numerically."""
    unknown_if_known: tuple[float, float] = (0.02, 0.45)
    """Least and greatest probability of `unknown` beside a known set.
    Chosen: calibrated on simulated rigs."""
    unknown_if_unknown: float = 0.55
    """Least probability of `unknown` where it is the verdict.
    Chosen: by convention."""
    unknown_if_none: float = 0.02
    """Probability of `unknown` where there is no gap.
    Chosen: calibrated on simulated rigs."""
    none_if_gap: float = 0.01
    """Probability of `none` where there is a gap.
    Chosen: calibrated on simulated rigs."""
    effect_if_none: float = 0.004
    """Probability of every effect where there is no gap.
    Chosen: calibrated on simulated rigs."""
    prior: float = 0.05
    """Prior odds of one further effect in a set.
    Trades off: higher: larger sets are likelier.
    Chosen: a set must leave less than `enlarge` for a further effect to be likelier than not: enlarge^power."""
    power: float = 4.0
    """Half the count of independent numbers that tempered evidences stand for.
    Trades off: higher: surer of one of several sets that leave about as much.
    Chosen: a set that leaves `equivalent` times as much has half the weight."""
    excess_margin: float = 0.1
    """Excess added to that of each set before evidences are compared.
    Trades off: lower: surer where sets leave almost nothing.
    Chosen: `equivalent_floor` halves a weight."""
    effect_bounds: tuple[float, float] = (0.006, 0.98)
    """Least and greatest probability of an effect where there is a gap.
    Chosen: calibrated on simulated rigs."""
    least_taken: float = 0.5
    """Share that a known set takes off the part of the gap that a right model would take off.
    Trades off: lower: confident wrong verdicts.
    Chosen: the recording's contract."""
    least_removable: float = 0.01
    """Removable gap, in standard deviations, below which its share is not asked for.
    Trades off: lower: the share of a small number decides.
    Chosen: numerically."""
    stochastic: tuple[float, float, float] = (0.9, 0.01, 0.1)
    """Probability of an effect with a stochastic signal, and then of `none` and of `unknown`.
    Chosen: calibrated on simulated rigs."""


class CrossValidationSettings(NamedTuple):
    """Selection by the gap of runs left out, where no set explains the gap."""

    noise_level: float = 0.1
    """Share of the gap that counts as noise under uniform weights.
    Trades off: only scales the cost.
    Chosen: by convention."""
    independent: float = 40.0
    """How many of the numbers of a gap count as independent.
    Trades off: higher: effects are stated that take little of the gap, and parameters within their tolerance cost
    little.
    Chosen: on measured rigs."""
    equivalent: float = 3.0
    """Ratio of the evidences of two sets below which they help as much.
    Trades off: higher: larger groups, and more often one effect in place of two others.
    Chosen: a Bayes factor below 3 is not worth more than a bare mention (Kass and Raftery, 1995)."""
    prior_of_sensor: float = 0.01
    """Prior odds of a sensor that errs.
    Trades off: higher: a sensor is blamed where a change of the rig does as much.
    Chosen: sensors are calibrated, while dampers and cushions age; on measured rigs, where forms are wrong
    anyway."""
    sets_compared: int = 8
    """Sets of each size that are cross-validated.
    Trades off: more: time.
    Chosen: on measured rigs."""
    folds: int = 3
    """Parts of the runs that are left out in turn.
    Trades off: more: time.
    Chosen: by convention."""
    doubtful: float = 1.5
    """Factor by which a run left out may get worse before the step of the other runs is checked and shortened.
    Trades off: lower: time; higher: effects far from linear are judged by steps that no fit would take.
    Chosen: numerically."""

    @property
    def power(self) -> float:
        """Exponent of the mean square that a set leaves in its evidence."""
        return 0.5 * self.independent


class ValidationSettings(NamedTuple):
    """The shrink stated on a run held out of the fit, with its interval."""

    block_length: float = 1.0
    """Length of the blocks of the bootstrap [s].
    Trades off: shorter than the rig's memory: intervals too narrow; longer: too few blocks.
    Chosen: several periods of the seat's resonance."""
    draws: int = 400
    """Bootstrap samples.
    Trades off: more: time.
    Chosen: numerically."""
    percentiles: tuple[float, float] = (5.0, 95.0)
    """Ends of the interval [%].
    Chosen: by convention."""
    excitation_std: float = 0.1
    """Standard deviation by which the shrink differs between excitations of one kind.
    Trades off: lower: intervals that do not cover.
    Chosen: on sealed rigs with an unseen run."""
    most_share: float = 0.6
    """Largest share of what an effect moves in all runs that the held-out run may have.
    Trades off: higher: the fit loses the run that shows the effect.
    Chosen: on simulated rigs."""
    least_share: float = 0.05
    """Least share of it that the held-out run must have.
    Trades off: lower: a run that the effect does not touch checks nothing.
    Chosen: on simulated rigs."""
    quantile: float = 0.25
    """Quantile of the shrink over the suitable runs at which the held-out run lies.
    Trades off: higher: a stated shrink that other excitations do not reach.
    Chosen: least bias of the stated shrink on sealed rigs."""
    least_time: float = 0.03
    """Least standard deviation of a time, as a share of the interval between rows.
    Trades off: higher: intervals of delays that are known better are too wide.
    Chosen: a tenth of what rounding to whole rows makes."""
    settled: float = 1e-5
    """The stated fit ends where a step lowers its cost by less than this share.
    Trades off: higher: a parameter ends farther from its estimate than its standard deviation.
    Chosen: numerically."""
    by_chance: float = 2.0
    """Standard deviations of the power of noise by which a residual must exceed it to show an error of the form.
    Trades off: higher: intervals that do not cover under a wrong form; lower: too wide ones under a right form.
    Chosen: on simulated rigs."""
