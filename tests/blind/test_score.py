"""Scores of diagnoses written by hand."""

import json

import numpy as np
import pytest

from seatsim.blind.carrier.recorded import encode_carrier
from seatsim.blind.score import verdicts
from seatsim.blind.score.score import score, score_shrink, score_verdicts
from seatsim.blind.score.verdicts import Rate, Verdict, is_right, is_wrong_name, read_verdict
from seatsim.blind.sealed import Sealed, new_key, seal
from seatsim.cli.outputs.diagnosis_results import tabulate_score
from seatsim.schema.content import to_content
from seatsim.schema.errors import InputError

from ..text import parse
from .carriers import bench_carrier, offset, write_yaml

ONE = {"kind": "one", "effects": ["damper.remanence"], "blocks": ["damper"], "forms": ["remanence-decay"]}
TWO = {"kind": "two", "effects": ["coil.lag", "driver.mass"], "blocks": ["coil", "driver"]}
NONE = {"kind": "none", "effects": [], "blocks": []}
CARRIED = {"kind": "carried", "effects": ["coil.delay"], "blocks": ["coil"], "forms": ["command advanced"]}
CARRIED |= {"materialities": [2.0], "shapes": [{"time": 0.01}]}
OUT = {"kind": "outside", "effects": [], "blocks": ["suspension"], "forms": ["maxwell-bushing"]}


@pytest.mark.parametrize(
    ("label", "said", "right"),
    [
        (NONE, Verdict("none"), True),
        (NONE, Verdict("unknown"), False),
        (ONE, Verdict("known", causes=("damper.remanence",)), True),
        (ONE, Verdict("known", causes=("coil.lag", "damper.remanence")), False),
        (ONE, Verdict("ambiguous", causes=("coil.lag",), groups=(("coil.lag", "damper.remanence"),)), True),
        (ONE, Verdict("ambiguous", causes=("coil.lag",), groups=(("coil.lag", "a", "damper.remanence"),)), False),
        (ONE, Verdict("unknown", causes=("damper.remanence",)), False),
        (ONE, Verdict("missing"), False),
        (TWO, Verdict("known", selected=("driver.mass", "coil.lag")), True),
        (TWO, Verdict("known", selected=("coil.lag",)), False),
        (TWO, Verdict("known", selected=("coil.lag", "driver.mass", "sensor.gain")), False),
        (OUT, Verdict("unknown", blocks=("damper",)), True),
        (OUT, Verdict("known", causes=("driver.mass",)), False),
        (CARRIED, Verdict("unknown", causes=("coil.delay",)), True),
        (CARRIED, Verdict("known", causes=("coil.delay",), selected=("coil.delay",)), True),
        (CARRIED, Verdict("ambiguous", causes=("coil.lag",), groups=(("coil.lag", "coil.delay"),)), True),
        (CARRIED, Verdict("unknown", causes=("coil.lag",), selected=("coil.lag",)), False),
        (CARRIED, Verdict("unknown", causes=("coil.lag",)), False),
        (CARRIED, Verdict("none", causes=("coil.delay",)), False),
        (CARRIED, Verdict("missing"), False),
    ],
)
def test_what_is_right_and_what_a_wrong_name(label, said, right):
    assert is_right(label, said) is right
    if label is CARRIED:
        assert is_wrong_name(label, said) == (bool(said.selected) and not right)


def test_figures_of_a_small_set():
    labels = {"a": NONE, "b": ONE, "c": TWO, "d": OUT, "e": OUT, "f": ONE}
    said = {
        "a": Verdict("known", ("sensor",), ("sensor.gain",), {"sensor.gain": 0.9}),
        "b": Verdict("known", ("damper",), ("damper.remanence",), {"damper.remanence": 1.0}, ("damper.remanence",)),
        "c": Verdict("known", ("coil",), ("coil.lag",), {"coil.lag": 1.0}, ("coil.lag",)),
        "d": Verdict("unknown", ("suspension",), (), {}),
        "e": Verdict("unknown", ("damper",), (), {}, isolable=(("damper", "suspension"),)),
        "f": Verdict("missing"),
    }
    found = score_verdicts(labels, said)
    assert (found.right, found.false_alarms, found.outside_with_block) == (Rate(3, 6), Rate(1, 1), Rate(1, 2))
    assert (found.top1, found.block, found.block_coarse) == (Rate(1, 2), Rate(3, 5), Rate(4, 5))
    assert (found.two_recall, found.two_precision, found.detected) == (Rate(1, 2), Rate(1, 1), Rate(4, 5))
    assert found.confusion["damper.remanence"] == {"damper.remanence": 1, "missing": 1}
    assert [failure.case for failure in found.failures] == ["a", "c", "f"]
    assert found.brier == pytest.approx((0.9**2 + 1.0) / (5 * 24))
    json.dumps(to_content(found))
    summary, failures = tabulate_score(found)
    assert "right block first" in {row[0] for row in summary.rows} and len(failures.rows) == 3


def test_calibration_of_honest_and_boastful_probabilities():
    rng = np.random.default_rng(0)
    stated = rng.uniform(size=20000)
    true = rng.uniform(size=20000) < stated
    assert verdicts.calibration_error(verdicts.reliability(stated, true)) < 0.02
    assert verdicts.calibration_error(verdicts.reliability(np.ones(100), np.arange(100) % 2 == 0)) == pytest.approx(0.5)
    assert Rate(9, 10).interval == pytest.approx((0.596, 0.982), abs=2e-3)


def test_a_folder_is_scored_from_its_files(tmp_path):
    folder, sealed, key = tmp_path / "set", tmp_path / "set.sealed", new_key()
    folder.mkdir()
    seal(sealed, folder, key, Sealed({"case-0001": ONE, "case-0002": NONE}, {}, {}))
    with pytest.raises(InputError, match="diagnose the cases first"):
        score(folder, sealed, key)
    place = folder / "case-0001" / "bic" / "diagnosis.json"
    place.parent.mkdir(parents=True)
    causes = [{"effect": "coil.lag", "probability": 0.2}, {"effect": "damper.remanence", "probability": 0.7}]
    place.write_text(json.dumps({"verdict": "known", "causes": causes}))
    found = score(folder, sealed, key, "bic")
    assert (found.right, found.kinds["none"], found.shrink) == (Rate(1, 2), Rate(0, 1), None)
    place.write_text("[]")
    with pytest.raises(InputError, match="is no diagnosis"):
        read_verdict(place)


def test_shrink_claimed_and_reached(tmp_path):
    """The recording has an offset of the force that the nominal lacks and the augmented scenario has, or half of it."""
    base, carrier = tmp_path / "set", bench_carrier()
    files = encode_carrier(offset(carrier, 60.0), ("run-0",))
    augmented = {}
    for name, preload in (("whole", 60.0), ("half", 30.0), ("wrong", -60.0)):
        effect = {"effect": "damper.gas_spring", "parameters": {"preload": preload}}
        augmented[name] = write_yaml({**carrier.nominal, "effects": [effect]}, tmp_path / f"{name}.yaml")
    said = {
        "a": Verdict("known", shrink=0.9, shrink_interval=(0.8, 1.0), augmented=augmented["whole"]),
        "b": Verdict("unknown", shrink=0.6, shrink_interval=(0.55, 0.65), augmented=augmented["half"]),
        "c": Verdict("ambiguous", shrink=0.5, shrink_interval=(0.4, 0.6), augmented=tmp_path / "none.yaml"),
        "d": Verdict("none", shrink=0.0, augmented=augmented["whole"]),
        "e": Verdict("known", augmented=augmented["whole"]),
        "f": Verdict("known", shrink=0.1, augmented=augmented["wrong"]),
    }
    for name in said:
        (base / name).mkdir(parents=True)
        (base / name / "nominal.yaml").write_bytes(files["nominal.yaml"])
    opened = Sealed(dict.fromkeys(said, ONE), dict.fromkeys(said, files), {})
    found = score_shrink(base, opened, said, 1, None)
    assert found is not None and found.predicted is None
    expected = [("a", 0.9, True), ("b", 0.6, False), ("c", 0.5, None), ("f", 0.1, None)]
    assert [(name, stated, held) for name, stated, _, held in found.cases] == expected
    true = {name: value for name, _, value, _ in found.cases}
    assert true["a"] > 0.95 and true["b"] == pytest.approx(0.5, abs=0.02) and true["f"] < -0.9
    assert found.coverage == Rate(1, 2)
    off = np.array([0.9 - true["a"], 0.6 - true["b"], 0.1 - true["f"]])
    assert (found.mean_difference, found.bias) == pytest.approx((np.mean(np.abs(off)), np.mean(off)))
    assert score_shrink(base, opened, dict.fromkeys(said, Verdict("known")), 1, None) is None


def test_a_verdict_is_read_as_the_contract_has_it(tmp_path):
    path = tmp_path / "diagnosis.json"
    assert read_verdict(path) == Verdict("missing")
    data = parse("""
        {verdict: ambiguous, where: [{block: coil, share: 0.9}, {block: damper, share: 0.1}], selected: [b],
         causes: [{effect: a, probability: 0.2}, {effect: b, probability: 0.7}, {effect: c}],
         indistinguishable: [[b, a]], isolable: [[coil, damper], [driver]], augmented: augmented.yaml,
         gap: {shrink: 0.8, shrink_interval: [0.7, 0.9]}}
    """)
    path.write_text(json.dumps(data))
    verdict = read_verdict(path)
    assert (verdict.causes, verdict.named, verdict.groups) == (("b", "a", "c"), "b", (("b", "a"),))
    assert verdict.probabilities == {"a": 0.2, "b": 0.7, "c": 0.0}
    assert (verdict.blocks, verdict.shrink, verdict.shrink_interval) == (("coil", "damper"), 0.8, (0.7, 0.9))
    assert verdict.augmented == tmp_path / "augmented.yaml"
    path.write_text(json.dumps({"verdict": "none", "gap": {"shrink": None, "shrink_interval": [None, None]}}))
    assert read_verdict(path) == Verdict("none", probabilities={})
