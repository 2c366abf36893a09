"""Sets on a measured recording."""

import gzip
import json

import pytest

from seatsim import load_recording
from seatsim.blind.carrier.make import UNTOUCHED, make_on_carrier
from seatsim.blind.carrier.recorded import read_carrier
from seatsim.blind.score.score import score_verdicts
from seatsim.blind.score.verdicts import Verdict
from seatsim.blind.sealed import EFFECTS, unseal
from seatsim.schema.content import to_content
from seatsim.schema.errors import InputError

from .carriers import bench_carrier, files_of, write_carrier
from .test_score import CARRIED


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    return write_carrier(bench_carrier(0.02), tmp_path_factory.mktemp("carrier") / "mine")


def test_a_set_is_sealed_repeatable_and_silent(recording, tmp_path):
    def make(name):
        return make_on_carrier(recording, 3, 5, tmp_path / name, tmp_path / f"{name}.sealed", processes=1)

    first, second = make("first"), make("second")
    opened = unseal(tmp_path / "first.sealed", first, tmp_path / "first")
    assert opened.labels == unseal(tmp_path / "second.sealed", second, tmp_path / "second").labels
    cases = files_of(tmp_path / "first", but="seal")
    assert cases == files_of(tmp_path / "second", but="seal")
    for name, data in cases.items():
        text = (gzip.decompress(data) if name.endswith(".gz") else data).decode().splitlines()
        assert not [word for word in (*EFFECTS, "carried", UNTOUCHED) if any(word in line for line in text)]
    label = next(label for label in opened.labels.values() if label["kind"] == "carried")
    assert label["effects"][0] in EFFECTS
    assert 1.0 < label["materialities"][0] < 10.0
    assert list(load_recording(tmp_path / "first" / "case-0001").runs) == ["run-0", "run-1"]
    assert list(load_recording(opened.extract("case-0001", tmp_path)).runs) == ["run-2"]


def test_labels_beside_the_recordings_and_short_runs_are_refused(recording, tmp_path):
    with pytest.raises(InputError, match="must lie elsewhere"):
        make_on_carrier(recording, 1, 1, tmp_path / "set", tmp_path / "set" / "labels.sealed")
    carrier = bench_carrier()
    cut = {run: {c: v[:400] for c, v in table.items()} for run, table in carrier.tables.items()}
    short = write_carrier(type(carrier)(carrier.header, carrier.nominal, cut), tmp_path / "short")
    with pytest.raises(InputError, match="shorter than"):
        read_carrier(short)


def test_a_score_counts_wrong_names_and_sizes_and_leaves_the_untouched_out():
    untouched = {"kind": "untouched", "effects": [], "blocks": []}
    delay = ("coil.delay",)
    named = Verdict("unknown", causes=delay, selected=delay, parameters={"coil.delay": {"time": 0.012}})
    wrong = Verdict("known", causes=("driver.mass",), selected=("driver.mass",))
    found = score_verdicts({"a": CARRIED, "b": CARRIED, "c": untouched}, {"a": named, "b": wrong, "c": wrong})
    assert (found.right.right, found.right.total, found.cases) == (1, 2, 3)
    assert (found.wrong_names.right, found.wrong_names.total) == (1, 2)
    assert found.untouched == {"driver.mass": 1}
    assert [(s.parameter, s.true, s.found) for s in found.found_sizes] == [("time", 0.01, 0.012)]
    assert json.dumps(to_content(found))
