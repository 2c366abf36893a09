"""Diagnoses of rigs that a simulator apart from the candidates' made."""

import pytest
from typer.testing import CliRunner

import seatsim
from seatsim.blind.make import draw_experiment, materiality
from seatsim.blind.make.make import make
from seatsim.blind.sealed import unseal
from seatsim.cli.app import app

KINDS = ["none", "one", "outside"]


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A faultless rig, one with a hidden effect, one with something outside the library, and their labels by kind."""
    folder = tmp_path_factory.mktemp("blind")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(draw_experiment, "SECONDS", 12.0)
        patch.setattr(draw_experiment, "UNSEEN_SECONDS", 2.6)
        patch.setattr(materiality, "SECONDS", 4.0)
        key = make(3, 11, folder / "set", folder / "set.sealed", kinds=KINDS, processes=1)
    labels = unseal(folder / "set.sealed", key, folder / "set").labels
    return folder / "set", {label["kind"]: (name, label) for name, label in labels.items()}


@pytest.mark.slow
def test_a_faultless_rig_has_no_gap(made):
    folder, labels = made
    diagnosis = seatsim.diagnose(folder / labels["none"][0], budget=1200.0)
    assert diagnosis.verdict == "none"
    assert diagnosis.selected == [] and diagnosis.where == []


@pytest.mark.slow
def test_a_hidden_effect_is_named_and_takes_the_gap_away(made):
    folder, labels = made
    name, label = labels["one"]
    diagnosis = seatsim.diagnose(folder / name, budget=1200.0)
    (effect,) = label["effects"]
    assert effect in diagnosis.selected or any(effect in group for group in diagnosis.indistinguishable)
    assert diagnosis.gap.after.overall < 0.8 * diagnosis.gap.calibrated.overall


@pytest.mark.slow
def test_what_no_effect_explains_is_unknown(made):
    folder, labels = made
    name, label = labels["outside"]
    diagnosis = seatsim.diagnose(folder / name, budget=1200.0)
    assert diagnosis.verdict == "unknown"
    assert diagnosis.probability_unknown > 0.5
    # An effect that stands beside the unknown cause lies in its block and lowers the gap of the run held out.
    assert {name.partition(".")[0] for name in diagnosis.selected} <= set(label["blocks"])
    if diagnosis.selected:
        assert diagnosis.gap.after.overall < diagnosis.gap.before.overall
    else:
        assert diagnosis.gap.after.overall == diagnosis.gap.before.overall
    assert diagnosis.where[0].block in label["blocks"]


def test_an_unknown_effect_cannot_be_withheld(tmp_path):
    done = CliRunner().invoke(app, ["diagnose", str(tmp_path), "--without", "suspension.frction"])
    assert "suspension.friction" in str(done.exception)
