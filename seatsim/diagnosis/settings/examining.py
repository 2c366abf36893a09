"""Settings of what is examined beside the verdict: the remainder's place, other dampers, the next experiment."""

from __future__ import annotations

from typing import NamedTuple


class LocalisationSettings(NamedTuple):
    """Which block holds the remainder, and what its signal is."""

    decisive: float = 0.1
    """Share of what the best block explains by which another must fall short to be distinguished from it.
    Trades off: higher: shares of blocks are similar; lower: a confident wrong block.
    Chosen: on simulated rigs."""
    above_noise: float = 1.0
    """Reduced chi-square less 1 from which a random signal is sought beside known effects.
    Trades off: lower: noise passes for a signal; higher: a random force beside an effect stays unseen.
    Chosen: as much as noise itself leaves."""
    largest_input: float = 10.0
    """Factor from the probing input, which is a tenth of the floor's motion, to the largest plausible one.
    Trades off: larger: every block explains everything; smaller: strong causes are not reached.
    Chosen: on simulated rigs."""
    slight: float = 0.02
    """Share of the gap by which each effect must help a random signal to explain it.
    Trades off: higher: effects beside a random signal are given up for it.
    Chosen: on simulated rigs."""
    slow_frequency: float = 0.5
    """Frequency below which the zero of a sensor drifts, and no floor moves so much that it matters [Hz].
    Trades off: higher: motions of the floor are taken for drift.
    Chosen: on simulated rigs."""
    slow_share: float = 0.9
    """Least share of its power that a bias drift has below that frequency.
    Chosen: on simulated rigs."""


class DesignSettings(NamedTuple):
    """What can be distinguished, now and by a further experiment."""

    separated: float = 15.0
    """Least separability, in noise units, of an experiment that is proposed.
    Trades off: lower: experiments that do not decide; higher: none is proposed.
    Chosen: on simulated rigs."""
    unlike: float = 0.9
    """Likeness below which the cheapest experiment is taken.
    Trades off: higher: experiments whose outcome a model error can reverse.
    Chosen: on simulated rigs."""
    largest_travel: float = 0.05
    """Travel that an excitation may take either way, where the scenario states none [m].
    Trades off: higher: excitations that no seat can follow.
    Chosen: by convention."""


class DamperFormSettings(NamedTuple):
    """Other models of the damper in the place of the nominal's."""

    models: tuple[str, ...] = ("biviscous", "bouc_wen", "phase_transition", "maxwell_nonlinear_slider", "ellis")
    """Models that are fitted, but for the nominal's own.
    Trades off: more: time; fewer: forms of the force that nobody asks about.
    Chosen: one of each mechanism: no hysteresis, a state, a lag of the fluid, a spring in series, a free play."""
    least_rest: float = 0.1
    """Least gap of the damper force, in its standard deviations and beyond noise, from which they are fitted.
    Trades off: lower: time for forms that change little; higher: a wrong form is not mentioned.
    Chosen: twice what an effect moves to count as material."""
    better: float = 0.1
    """Least share beyond the nominal's own: of the gap, for a model to be named; of the force, to be simulated.
    Trades off: lower: a form is named that only has more parameters.
    Chosen: by convention."""
