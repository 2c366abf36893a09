"""Scores of diagnoses written by hand."""

from __future__ import annotations

import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rich.console import Console

from seatsim.blind.score.measures import Rate, calibration_error, reliability
from seatsim.blind.score.score import score, score_verdicts
from seatsim.blind.score.tables import tables
from seatsim.blind.score.verdicts import Verdict, is_right, read_verdict
from seatsim.blind.sealed import Sealed, new_key, seal
from seatsim.schema.errors import InputError

ONE = {"kind": "one", "effects": ["damper.remanence"], "blocks": ["damper"], "forms": ["remanence-decay"]}
TWO = {"kind": "two", "effects": ["coil.lag", "driver.mass"], "blocks": ["coil", "driver"]}
NONE: dict[str, Any] = {"kind": "none", "effects": [], "blocks": []}
OUT: dict[str, Any] = {"kind": "outside", "effects": [], "blocks": ["suspension"], "forms": ["maxwell-bushing"]}


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
    ],
)
def test_what_is_right(label: dict[str, Any], said: Verdict, right: bool) -> None:
    assert is_right(label, said) is right


def test_figures_of_a_small_set() -> None:
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
    assert [failure["case"] for failure in found.failures] == ["a", "c", "f"]
    assert found.brier == pytest.approx((0.9**2 + 1.0) / (5 * 24))
    json.dumps(found.as_dict())
    console = Console(record=True, width=200, file=io.StringIO())
    for table in tables(found):
        console.print(table)
    assert "right block first" in console.export_text()


def test_calibration_of_honest_and_boastful_probabilities() -> None:
    rng = np.random.default_rng(0)
    stated = rng.uniform(size=20000)
    true = rng.uniform(size=20000) < stated
    assert calibration_error(reliability(stated, true)) < 0.02
    assert calibration_error(reliability(np.ones(100), np.arange(100) % 2 == 0)) == pytest.approx(0.5)
    assert Rate(9, 10).interval == pytest.approx((0.596, 0.982), abs=2e-3)


def test_a_folder_is_scored_from_its_files(tmp_path: Path) -> None:
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
    with pytest.raises(InputError, match="is not a diagnosis"):
        read_verdict(place)
