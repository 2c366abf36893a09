"""Settings of the decision, and of the validation on a held-out run."""

from __future__ import annotations

from typing import NamedTuple


class DecisionSettings(NamedTuple):
    """From fitted sets to none, known, ambiguous or unknown, with probabilities."""

    material: float = 0.05
    """Movement of a channel, in its standard deviations, from which an effect is material.
    Trades off: lower: false alarms; higher: weak second effects are missed.
    Chosen: the recording's contract, which also asks for more than the channel's noise."""
    further_name: float = 0.15
    """Cost of each effect named beside the likeliest one, in right answers.
    Trades off: higher: a confident wrong one more often; lower: longer groups of effects.
    Chosen: by convention; a user who can check several parts lowers it."""
    wrong_name: float = 0.25
    """Cost of a set that is wrong, in right answers.
    Trades off: higher: more is unknown; lower: a confident wrong one more often.
    Chosen: by convention."""
    none_if_none: float = 0.93
    """Probability of `none` where nothing material is left; the rest is shared by all effects and `unknown`.
    Chosen: of 47 such recordings of simulated rigs, 44 were faultless."""
    least_lowered: float = 0.02
    """Cost by which a material effect lowers it, per number compared, for a gap within the expected noise.
    Trades off: lower: false alarms; higher: effects at a few frequencies stay hidden in the noise of all.
    Chosen: without an effect at most 0.035 on simulated rigs, and then never material."""
    unknown_if_unknown: float = 0.55
    """Least probability of `unknown` where it is the verdict.
    Chosen: by convention."""
    least_taken: float = 0.5
    """Share that a known set takes off the part of the gap that a right model would take off.
    Trades off: lower: confident wrong verdicts.
    Chosen: the recording's contract."""


class ValidationSettings(NamedTuple):
    """The shrink stated on a run held out of the fit, with its interval."""

    excitation_std: float = 0.1
    """Standard deviation by which the shrink differs between excitations of one kind.
    Trades off: lower: intervals that do not cover.
    Chosen: on sealed rigs with an unseen run."""
    most_share: float = 0.6
    """Largest share of what an effect moves in all runs that the held-out run may have.
    Trades off: higher: the fit loses the run that shows the effect.
    Chosen: on simulated rigs."""
    by_chance: float = 2.0
    """Standard deviations of the power of noise by which a residual must exceed it to show an error of the form.
    Trades off: higher: intervals that do not cover under a wrong form; lower: too wide ones under a right form.
    Chosen: on simulated rigs."""
