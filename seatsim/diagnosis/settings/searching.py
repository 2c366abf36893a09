"""Settings of the noise model and of the search for effects."""

from __future__ import annotations

from typing import NamedTuple


class NoiseSettings(NamedTuple):
    """What counts as noise in the residuals, by channel and frequency."""

    highest_frequency: float = 100.0
    """Content above it is not compared [Hz].
    Trades off: higher: broadband noise dilutes the evidence; lower: stops and clearances are seen less.
    Chosen: above what a seat transmits, below what 500 rows per second resolve."""
    model_error: float = 0.01
    """Share of a channel's local amplitude spectrum that a right model may miss.
    Trades off: higher: small effects stay unseen; lower: the form of the nominal model is taken for an effect.
    Chosen: on simulated rigs."""
    independent: float = 40.0
    """How many of the numbers of a gap count as independent where it is weighed uniformly.
    Trades off: higher: parameters within their tolerance cost little beside what they take off the gap.
    Chosen: on measured rigs."""
    broadband_excess: float = 2.0
    """Factor on the stated noise power above `highest_frequency` from which a residual is broadband.
    Trades off: higher: where noise is not stated, or too low, the verdict is unknown.
    Chosen: on simulated rigs."""
    broadband_share: float = 0.5
    """Share of what the best set leaves from which a broadband residual is added to the noise.
    Trades off: lower: real effects are counted as noise; higher: a broadband residual makes a verdict unknown.
    Chosen: on simulated rigs."""


class SelectionSettings(NamedTuple):
    """Subset selection: screening by linear models, fits of single effects, then of larger sets."""

    fitted_tolerance: float = 0.5
    """Tolerance of parameters that a recording states as `fitted`.
    Trades off: higher: effects vanish in parameters; lower: what a fit has absorbed of an effect cannot be given
    back.
    Chosen: a viscous coefficient fitted in place of a missing friction came out twice as large."""
    shortlist: int = 8
    """Candidates beside a set that are simulated after the screening.
    Trades off: fewer: an effect that a linear model underrates is missed; more: time.
    Chosen: of 79 true effects on simulated rigs, 76 were among the first six of the screening."""
    finalists: int = 4
    """Sets of each size that are fitted first, and most that are weighed as hypotheses.
    Trades off: fewer: slow starters are lost; more: time.
    Chosen: of 86 true sets on simulated rigs, 81 were among the first two after the screening, one the fourth."""
    beam: int = 2
    """Sets of each size from which the next larger ones are made.
    Trades off: 1 is a greedy search, which a wrong first effect misleads.
    Chosen: on simulated rigs."""
    shape_reach: float = 8.0
    """Factor by which a parameter of shape may leave its start.
    Trades off: larger: effects imitate each other by extreme shapes.
    Chosen: on simulated rigs."""
    nothing_left: float = 0.15
    """Reduced chi-square less 1 below which nothing is left to explain.
    Trades off: lower: false alarms; higher: weak effects are missed.
    Chosen: on simulated rigs."""
    worthwhile: float = 0.85
    """Larger sets are sought while the last enlargement left less than this share.
    Trades off: higher: time.
    Chosen: on simulated rigs."""
