"""Settings of what is examined beside the verdict: the remainder's place, other dampers, the next experiment."""

from __future__ import annotations

from typing import NamedTuple


class ReconstructionSettings(NamedTuple):
    """Estimation of an unknown input that matches the measured channels."""

    probe_size: float = 0.1
    """Size of random probing inputs, as a share of the floor's motion and of the force that it means.
    Trades off: larger: the rig is not linear about the motion; smaller: rounding.
    Chosen: numerically."""
    largest_input: float = 10.0
    """Factor from the probing input to the largest plausible one.
    Trades off: larger: every block explains everything; smaller: strong causes are not reached.
    Chosen: on simulated rigs."""
    plausible_corner: float = 2.0
    """Frequency above which the spectrum of plausible inputs falls [Hz].
    Chosen: on simulated rigs."""
    probe_corner: float = 40.0
    """Frequency above which the spectrum of probing inputs falls [Hz].
    Chosen: numerically."""
    rounds: int = 20
    """Most corrections of an input.
    Trades off: more: time.
    Chosen: numerically."""
    settled: float = 0.02
    """A correction that lowers what is left by less than this share is fruitless.
    Chosen: numerically."""
    fruitless: int = 2
    """Fruitless corrections in a row after which the estimate ends.
    Trades off: 1: one misleading probe ends it.
    Chosen: numerically."""
    backtracking: tuple[float, ...] = (1.0, 0.4, 0.15, 0.05)
    """Fractions of a correction that are tried in turn.
    Chosen: numerically."""
    regained: float = 1.2
    """Factor on a random force that was estimated, for what its filter takes.
    Chosen: on simulated rigs."""


class LocalisationSettings(NamedTuple):
    """Which block holds the remainder, and what its signal is."""

    decisive: float = 0.1
    """Share of what the best block explains by which another must fall short to be distinguished from it.
    Trades off: higher: shares of blocks are similar; lower: a confident wrong block.
    Chosen: on simulated rigs."""
    above_noise: float = 1.0
    """Reduced chi-square less 1 from which an unknown input may take the place of effects.
    Trades off: lower: noise passes for an input, which gives up effects that runs left out support.
    Chosen: as much as noise itself leaves."""
    slight: float = 0.02
    """Share of the gap by which effects that do not explain it must help an unknown input to be kept.
    Trades off: higher: effects beside an unknown cause are given up.
    Chosen: on simulated rigs."""
    remainder_factor: float = 1.2
    """Share of the remainder's block beside the largest share of the effects found.
    Trades off: above 1, since an unknown cause stands first.
    Chosen: by convention."""
    slow_frequency: float = 0.5
    """Frequency below which the zero of a sensor drifts, and no floor moves so much that it matters [Hz].
    Trades off: higher: motions of the floor are taken for drift.
    Chosen: on simulated rigs."""
    slow_share: float = 0.9
    """Least share of its power that a bias drift has below that frequency.
    Chosen: on simulated rigs."""
    drift_alone: float = 2.0
    """Factor by which the gap left in a channel exceeds those of all others where its zero drifts.
    Trades off: lower: an error of the model is taken for drift.
    Chosen: on simulated rigs."""
    regression_rate: float = 100.0
    """Rate at which signals are regressed [Hz].
    Chosen: numerically."""
    lags: int = 10
    """Past samples of the motion that a linear filter may use.
    Trades off: more: overfitting.
    Chosen: on simulated rigs."""
    ridge: float = 1e-3
    """Ridge, relative to the regressors' power.
    Chosen: numerically."""
    least_ridge: float = 1e-9
    """Least ridge, for regressors that are all at rest, such as a current that never flows.
    Chosen: numerically."""
    slow_slip: float = 0.03
    """Velocity scale of the smooth friction among the regressors [m/s].
    Chosen: on simulated rigs."""
    fast_slip: float = 0.005
    """Velocity scale of the sharp friction among the regressors [m/s].
    Chosen: on simulated rigs."""
    worth_naming: float = 0.1
    """R2 from which a family of regressors is named in the report.
    Chosen: by convention."""


class DesignSettings(NamedTuple):
    """What can be distinguished, now and by a further experiment."""

    faint: float = 1e-9
    """Length of a projected sensitivity, in noise units, below which it is collinear with nothing.
    Chosen: numerically."""
    effect_std: float = 10.0
    """Prior standard deviation of an effect's parameter, in its natural size.
    Trades off: lower: effects are separable only because they are thought small.
    Chosen: by convention."""
    separated: float = 30.0
    """Least separability, in noise units, of an experiment that is proposed.
    Trades off: lower: experiments that do not decide; higher: none is proposed.
    Chosen: on simulated rigs."""
    unlike: float = 0.9
    """Likeness below which the cheapest experiment is taken.
    Trades off: higher: experiments whose outcome a model error can reverse.
    Chosen: on simulated rigs."""
    listed: int = 10
    """Most effects of the collinearity table.
    Chosen: by convention."""
    listed_probability: float = 0.003
    """Least probability of an effect of the collinearity table.
    Chosen: by convention."""
    trials: int = 16
    """Excitations that are tried to optimise the best of the menu, where none on it distinguishes all members.
    Trades off: more: time.
    Chosen: by convention."""
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
    rows: int = 4000
    """Rows of all runs together that a model is fitted to, the liveliest of each.
    Trades off: fewer: less of the range is seen; more: time.
    Chosen: seconds for the slowest model."""
    evaluations: tuple[int, int] = (4, 12)
    """Most evaluations of least squares from each start, and from the better one.
    Trades off: more: time.
    Chosen: numerically."""
    better: float = 0.1
    """Least share beyond the nominal's own: of the gap, for a model to be named; of the force, to be simulated.
    Trades off: lower: a form is named that only has more parameters.
    Chosen: by convention."""
