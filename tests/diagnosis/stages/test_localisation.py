"""Shares of the gap by block: from movements of effects, from evidence, and ties between blocks that move as one."""

import dataclasses
import itertools
import math

import numpy as np
import pytest

from seatsim.diagnosis.localise import localisation
from seatsim.diagnosis.localise.hypotheses import FaultHypothesis
from seatsim.diagnosis.localise.localisation import Remainder, localise_remainder, share_gap
from seatsim.diagnosis.objective import Evaluation, Linearisation

from .toy import CHANNELS, Added, offer, place, pose, record, weigh_stated


@pytest.fixture(scope="module")
def objective(folder):
    return weigh_stated(pose(record(folder, (Added("one", 0.5),))))


def rig(objective, *effects):
    terms = [(offer(name, cause), amount) for name, cause, amount in effects]
    return objective.evaluate([place(objective.problem, *terms)])[0]


def hypothesis(evidence):
    return FaultHypothesis(evidence, "force", "N", {})


def as_dict(shares):
    assert all(a.share >= b.share for a, b in itertools.pairwise(shares))
    assert sum(each.share for each in shares) == pytest.approx(1.0)
    return {each.block: each.share for each in shares}


def test_effects_share_the_gap_by_the_power_that_they_move(objective):
    # The same cause twice as strong moves four times the power; two effects of a block add up.
    chosen = rig(objective, ("coil.a", "one", 1.0), ("damper.b", "one", 2.0), ("coil.c", "one", -1.0))
    found = as_dict(share_gap(objective, chosen, None))
    assert list(found) == ["damper", "coil"]
    assert found == pytest.approx({"damper": 4.0 / 6.0, "coil": 2.0 / 6.0})


def test_movements_count_in_standard_deviations_over_all_channels(folder, objective):
    problem = objective.problem
    found = as_dict(share_gap(objective, rig(objective, ("a.x", "frame alone", 1.0), ("b.x", "one", 1.0)), None))
    power = {}
    for cause in ("frame alone", "one"):
        parts = [
            problem.simulated(r, problem.nominal, (Added(cause, 1.0),)) - problem.simulated(r, problem.nominal, ())
            for r in problem.runs
        ]
        power[cause] = np.mean(np.mean(np.concatenate(parts, axis=1) ** 2, axis=1) / problem.spread**2)
    assert found["a"] / found["b"] == pytest.approx(power["frame alone"] / power["one"])
    assert CHANNELS[:2] == problem.channels


def test_an_effect_that_moves_nothing_has_no_share(objective):
    found = as_dict(share_gap(objective, rig(objective, ("a.x", "one", 1.0), ("b.x", "one", 0.0)), None))
    assert found == {"a": 1.0}


def test_a_remainder_stands_first_by_a_fifth_over_the_largest_effect(objective):
    chosen = rig(objective, ("coil.a", "one", 1.0), ("damper.b", "one", 2.0))
    remainder = Remainder({}, {"cushion": 0.8, "driver": 0.2})
    found = as_dict(share_gap(objective, chosen, remainder))
    # 1.2 times 4 to the likeliest block, a quarter of that to the other.
    total = 4.8 + 1.2 + 4.0 + 1.0
    assert list(found)[:2] == ["cushion", "damper"]
    assert found == pytest.approx(
        {"cushion": 4.8 / total, "damper": 4.0 / total, "driver": 1.2 / total, "coil": 1.0 / total}
    )


def test_a_remainder_in_the_block_of_an_effect_adds_to_it(objective):
    found = as_dict(
        share_gap(objective, rig(objective, ("damper.b", "one", 2.0)), Remainder({}, {"damper": 0.5, "coil": 0.5}))
    )
    assert found == pytest.approx({"damper": 2.2 / 3.4, "coil": 1.2 / 3.4})


def test_a_remainder_alone_keeps_its_shares(objective):
    found = as_dict(share_gap(objective, rig(objective), Remainder({}, {"cushion": 0.7, "driver": 0.3})))
    assert found == pytest.approx({"cushion": 0.7, "driver": 0.3})


@pytest.fixture
def weigh(objective, monkeypatch):
    """Return a function that weighs blocks from stated evidence, of a rig with a stated excess."""

    def weigh(evidence, before=1.0):
        monkeypatch.setattr(
            localisation, "evaluate_hypotheses", lambda *_: {b: hypothesis(e) for b, e in evidence.items()}
        )
        rig = objective.evaluate([place(objective.problem)])[0]
        rig = Evaluation(rig.parameters, rig.residuals, rig.whitened, (1.0 + before) * rig.rows)
        return localise_remainder(objective, rig, rig)[0]

    return weigh


def test_blocks_share_by_their_evidence_over_a_tenth_of_what_the_best_explains(weigh):
    found = weigh({"coil": 0.6, "cushion": 0.2, "driver": 0.7, "sensor": 0.28, "damper": 0.9}, before=1.0)
    width = 0.1 * (1.0 - 0.2)
    evidence = {"cushion": 0.2, "sensor": 0.28, "coil": 0.6, "driver": 0.7, "damper": 0.9}
    weights = {block: math.exp(-(value - 0.2) / width) for block, value in evidence.items()}
    assert list(found.shares) == list(evidence)
    assert found.shares == pytest.approx({block: weight / sum(weights.values()) for block, weight in weights.items()})
    assert found.block == "cushion" and found.likeliest.negative_log_evidence == 0.2


@pytest.mark.parametrize(
    ("evidence", "likeliest"),
    [
        # The width is 0.1 (1 - 0.2) = 0.08: a frame's force that is less than that behind the driver's is the frame's.
        ({"driver": 0.2, "suspension": 0.27, "cushion": 0.9}, "suspension"),
        ({"driver": 0.2, "damper": 0.27, "suspension": 0.9}, "damper"),
        ({"driver": 0.2, "floor": 0.27, "suspension": 0.9}, "floor"),
        ({"driver": 0.2, "suspension": 0.29, "damper": 0.9}, "driver"),
        # What moves with the driver alone is not the frame's.
        ({"driver": 0.2, "cushion": 0.21, "suspension": 0.9}, "driver"),
        ({"driver": 0.5, "cushion": 0.2, "suspension": 0.4}, "cushion"),
    ],
)
def test_a_force_on_the_driver_that_one_on_the_frame_explains_as_well_is_the_frames(weigh, evidence, likeliest):
    assert weigh(evidence, before=1.0).block == likeliest


def test_a_tie_moves_the_driver_behind_by_the_width(weigh):
    found = weigh({"driver": 0.2, "suspension": 0.24}, before=1.0)
    assert found.hypotheses["driver"].negative_log_evidence == pytest.approx(0.28)
    # Weights are relative to what is best then.
    weight = math.exp(-0.04 / 0.08)
    assert found.shares == pytest.approx({"suspension": 1.0 / (1.0 + weight), "driver": weight / (1.0 + weight)})


def test_where_no_block_explains_anything_they_still_have_shares(weigh):
    found = weigh({"driver": 1.0, "suspension": 1.0 + 2e-6, "coil": 1.0}, before=0.9)
    assert sum(found.shares.values()) == pytest.approx(1.0)
    assert found.shares["suspension"] / found.shares["coil"] == pytest.approx(math.exp(-2e-6 / 1e-7), rel=1e-3)


@pytest.mark.parametrize(
    ("alone", "beside", "kept"),
    [
        (0.2, 0.2, False), (0.2, 0.3, False), (0.259, 0.2, False), (0.261, 0.2, True), (0.9, 0.1, True),
        # An input that leaves more than 12 % of the excess explains nothing, so that it takes no effect's place.
        (0.359, 0.5, False), (0.361, 0.5, True),
    ],
)  # fmt: skip
def test_effects_are_kept_where_an_input_beside_them_explains_enough_more(objective, monkeypatch, alone, beside, kept):
    # Enough is 2 % of the calibrated excess, which is 3.
    remainder, is_kept = localise_effect(objective, monkeypatch, 3.0, alone, beside)
    assert is_kept is kept
    assert remainder.likeliest.negative_log_evidence == (beside if kept else alone)


@pytest.mark.parametrize(("excess", "kept"), [(1.01, False), (0.99, True)])
def test_effects_are_kept_where_the_gap_stands_below_the_noise(objective, monkeypatch, excess, kept):
    assert localise_effect(objective, monkeypatch, excess, -0.1, 0.2)[1] is kept


@pytest.mark.parametrize(("channel", "kept"), [("frame_acceleration", True), ("driver_acceleration", False)])
def test_an_error_of_the_sensor_that_an_effect_names_takes_no_effects_place(objective, monkeypatch, channel, kept):
    calibrated, chosen = rig(objective), rig(objective, ("sensor.x", "one", 1.0))
    cost = 4.0 * calibrated.rows
    calibrated = Evaluation(calibrated.parameters, calibrated.residuals, calibrated.whitened, cost)
    term = chosen.parameters.terms[0]._replace(fixed={"channel": "frame_acceleration"})
    chosen = dataclasses.replace(chosen, parameters=dataclasses.replace(chosen.parameters, terms=(term,)))
    monkeypatch.setattr(type(objective), "linearise_nuisances", lambda self, rig: Linearisation(rig, {}))
    error = hypothesis(0.2)._replace(channel=channel)
    monkeypatch.setattr(localisation, "weigh_blocks", lambda *_: Remainder({"sensor": error}, {"sensor": 1.0}))
    assert (localise_remainder(objective, calibrated, chosen)[1] is chosen) is kept


def localise_effect(objective, monkeypatch, excess, alone, beside):
    """Return the remainder of a rig with one effect, and whether it is kept, from evidences of an input."""
    calibrated, chosen = rig(objective), rig(objective, ("a.x", "one", 1.0))
    cost = (1.0 + excess) * calibrated.rows
    calibrated = Evaluation(calibrated.parameters, calibrated.residuals, calibrated.whitened, cost)

    def evaluate(objective, nuisances):
        evidence = beside if nuisances.evaluation is chosen else alone
        return {"driver": hypothesis(2.0), "coil": hypothesis(evidence), "damper": hypothesis(9.0)}

    monkeypatch.setattr(localisation, "evaluate_hypotheses", evaluate)
    remainder, found = localise_remainder(objective, calibrated, chosen)
    return remainder, found is chosen


def test_without_effects_the_rig_is_the_one_chosen(objective, monkeypatch):
    calibrated, chosen = rig(objective), rig(objective)
    found = {"driver": hypothesis(0.5), "coil": hypothesis(0.1), "damper": hypothesis(0.9)}
    monkeypatch.setattr(localisation, "evaluate_hypotheses", lambda *_: found)
    assert localise_remainder(objective, calibrated, chosen)[1] is chosen
