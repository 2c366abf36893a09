"""Settings of the decision."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from seatsim.diagnosis.settings.threshold import CONVENTION, NUMERICAL, SIMULATED_RIGS, Threshold


class DecisionSettings(NamedTuple):
    """From fitted sets to none, known, ambiguous or unknown, with probabilities."""

    material: Annotated[
        float,
        Threshold(
            "-",
            "movement of a channel, in its standard deviations, from which an effect is material",
            "lower: false alarms; higher: weak second effects are missed",
            "the recording's contract, which also asks for more than the channel's noise",
        ),
    ] = 0.05
    explained: Annotated[
        float,
        Threshold(
            "-",
            "share of the calibrated excess that a known set leaves at most",
            "lower: right sets are called unknown; higher: wrong ones known",
            "right explanations leave up to 0.06 (one 0.14), wrong ones 0.15 to 1, on simulated and sealed rigs",
        ),
    ] = 0.12
    most_taken: Annotated[
        float,
        Threshold(
            "-",
            "share of the gap beyond noise from which a set that takes it is known though it leaves more of the excess",
            "lower: wrong sets are known; higher: right sets are called unknown",
            "right sets take 0.7 and more, wrong ones up to 0.56, on sealed rigs",
        ),
    ] = 0.65
    left_if_taken: Annotated[
        float,
        Threshold(
            "-",
            "share of the calibrated excess that such a set leaves at most",
            "as `explained`",
            SIMULATED_RIGS,
        ),
    ] = 0.35
    left_in_channel: Annotated[
        float,
        Threshold(
            "-",
            "share of the excess of a channel with a material gap that a known set leaves at most",
            "lower: one badly modelled channel makes everything unknown",
            SIMULATED_RIGS,
        ),
    ] = 0.5
    equivalent: Annotated[
        float,
        Threshold(
            "-",
            "factor on the excess within which two sets explain a recording equally well",
            "higher: larger groups of equivalent effects; lower: a confident wrong one",
            SIMULATED_RIGS,
        ),
    ] = 1.2
    equivalent_floor: Annotated[
        float,
        Threshold("-", "excess added to it, for sets that leave almost nothing", "as `equivalent`", SIMULATED_RIGS),
    ] = 0.02
    strong_evidence: Annotated[
        float,
        Threshold(
            "-",
            "ratio of the probabilities of two effects from which a held-out run that contradicts it no longer counts",
            "higher: more is ambiguous; lower: a confident wrong effect with few parameters",
            "a Bayes factor above 20 is strong (Kass and Raftery, 1995)",
        ),
    ] = 20.0
    contradicted: Annotated[
        float,
        Threshold(
            "-",
            "share of the gap by which another effect has to reduce it further in the held-out run",
            "as `strong_evidence`",
            "on simulated rigs and on effects put into measured records",
        ),
    ] = 0.02
    first_effect_helps: Annotated[
        float,
        Threshold(
            "-",
            "share of the excess above which a first effect that does not enlarge the set is passed over",
            "higher: an effect that hardly helps is chosen beside an unknown cause",
            SIMULATED_RIGS,
        ),
    ] = 0.9
    equivalent_members: Annotated[
        int,
        Threshold(
            "-",
            "most members of a group for which a small remainder suffices to be known",
            "more: long lists of effects that stand for each other are called an explanation",
            SIMULATED_RIGS,
        ),
    ] = 2
    least_lowered: Annotated[
        float,
        Threshold(
            "-",
            "cost by which a material effect lowers it, per number compared, for a gap within the expected noise",
            "lower: false alarms; higher: effects at a few frequencies stay hidden in the noise of all",
            "without an effect at most 0.035 on simulated rigs, and then never material",
        ),
    ] = 0.02
    none_width: Annotated[
        float,
        Threshold("-", "excess over which the probability of `none` falls from sure to unsure", "-", SIMULATED_RIGS),
    ] = 0.05
    none_offset: Annotated[
        float, Threshold("-", "log odds of `none` at the limit of `nothing_left`", "-", SIMULATED_RIGS)
    ] = 2.0
    none_least: Annotated[
        float, Threshold("-", "least probability of `none` where it is the verdict", "-", CONVENTION)
    ] = 0.6
    unknown_width: Annotated[
        float,
        Threshold(
            "-",
            "width, in the logarithm of the share left, of the step of the probability of `unknown`",
            "wider: less sure verdicts",
            "calibrated on simulated rigs",
        ),
    ] = 0.4
    least_share: Annotated[float, Threshold("-", "least share left whose logarithm is taken", "-", NUMERICAL)] = 1e-4
    unknown_if_known: Annotated[
        tuple[float, float],
        Threshold(
            "-",
            "least and greatest probability of `unknown` beside a known set",
            "-",
            "calibrated on simulated rigs",
        ),
    ] = (0.02, 0.45)
    unknown_if_unknown: Annotated[
        float, Threshold("-", "least probability of `unknown` where it is the verdict", "-", CONVENTION)
    ] = 0.55
    unknown_if_none: Annotated[
        float, Threshold("-", "probability of `unknown` where there is no gap", "-", "calibrated on simulated rigs")
    ] = 0.02
    none_if_gap: Annotated[
        float, Threshold("-", "probability of `none` where there is a gap", "-", "calibrated on simulated rigs")
    ] = 0.01
    effect_if_none: Annotated[
        float, Threshold("-", "probability of every effect where there is no gap", "-", "calibrated on simulated rigs")
    ] = 0.004
    prior: Annotated[
        float,
        Threshold(
            "-",
            "prior odds of one further effect in a set",
            "higher: larger sets are likelier",
            "a set must leave less than `enlarge` for a further effect to be likelier than not: enlarge^power",
        ),
    ] = 0.05
    power: Annotated[
        float,
        Threshold(
            "-",
            "half the count of independent numbers that tempered evidences stand for",
            "higher: surer of one of several sets that leave about as much",
            "a set that leaves `equivalent` times as much has half the weight",
        ),
    ] = 4.0
    excess_margin: Annotated[
        float,
        Threshold(
            "-",
            "excess added to that of each set before evidences are compared",
            "lower: surer where sets leave almost nothing",
            "`equivalent_floor` halves a weight",
        ),
    ] = 0.1
    effect_bounds: Annotated[
        tuple[float, float],
        Threshold(
            "-",
            "least and greatest probability of an effect where there is a gap",
            "-",
            "calibrated on simulated rigs",
        ),
    ] = (0.006, 0.98)
    least_taken: Annotated[
        float,
        Threshold(
            "-",
            "share that a known set takes off the part of the gap that a right model would take off",
            "lower: confident wrong verdicts",
            "the recording's contract",
        ),
    ] = 0.5
    least_removable: Annotated[
        float,
        Threshold(
            "-",
            "removable gap, in standard deviations, below which its share is not asked for",
            "lower: the share of a small number decides",
            NUMERICAL,
        ),
    ] = 0.01
    stochastic: Annotated[
        tuple[float, float, float],
        Threshold(
            "-",
            "probability of an effect with a stochastic signal, and then of `none` and of `unknown`",
            "-",
            "calibrated on simulated rigs",
        ),
    ] = (0.9, 0.01, 0.1)
