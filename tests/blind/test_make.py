"""Sets: repeatable, resumable, sealed, and silent about their labels."""

from __future__ import annotations

import gzip
from pathlib import Path

import numpy as np
import pytest

from seatsim import load_recording
from seatsim.blind.make.compose import compose, null_subsets
from seatsim.blind.make.folder import encode_table
from seatsim.blind.make.make import make, make_public
from seatsim.blind.sealed import EFFECTS, unseal
from seatsim.schema.errors import InputError


def contents(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*.*")) if path.is_file()}


def made(base: Path, name: str, seed: int | None, kinds: str = "one") -> tuple[Path, Path, str]:
    key = make(2, seed, base / name, base / f"{name}.sealed", kinds=kinds, processes=1)
    return base / name, base / f"{name}.sealed", key


def test_a_seed_fixes_the_set_and_nothing_in_it_tells_the_label(tmp_path: Path) -> None:
    first, sealed, key = made(tmp_path, "first", 3)
    second, again, other = made(tmp_path, "second", 3)
    cases = {name: data for name, data in contents(first).items() if "seal" not in name}
    assert cases == {name: data for name, data in contents(second).items() if "seal" not in name}
    opened = unseal(sealed, key, first)
    assert opened.labels == unseal(again, other, second).labels
    assert {label["kind"] for label in opened.labels.values()} == {"one"}
    telling = {*EFFECTS, "effect:", "seed", "severity", "outside", *opened.labels["case-0001"]["forms"]}
    for name, data in cases.items():
        text = (gzip.decompress(data) if name.endswith(".gz") else data).decode()
        assert not [
            word for word in telling if word in text.splitlines()[0] or (name.endswith("yaml") and word in text)
        ]
    assert sorted(p.name for p in (first / "case-0001").iterdir()) == (
        ["nominal.yaml", "recording.yaml", "run-a.csv.gz", "run-b.csv.gz", "run-c.csv.gz"]
    )
    assert len({p.stat().st_mtime for p in first.glob("case-*/*")}) == 1
    assert list(load_recording(first / "case-0002").runs) == ["run-a", "run-b", "run-c"]
    assert list(load_recording(opened.extract("case-0002", tmp_path)).runs) == ["run-u"]
    assert not list(tmp_path.glob("*.partial"))


def test_a_broken_off_set_goes_on_where_it_stopped(tmp_path: Path) -> None:
    def stop(done: int, _: int) -> None:
        if done == 1:
            raise KeyboardInterrupt

    _, sealed, key = made(tmp_path, "whole", 4, "null")
    with pytest.raises(KeyboardInterrupt):
        make(2, 4, tmp_path / "part", tmp_path / "part.sealed", stop, "null", 1)
    before = (tmp_path / "part" / "case-0001").stat().st_ino
    with pytest.raises(InputError, match="unfinished set"):
        make(3, 4, tmp_path / "part", tmp_path / "part.sealed", None, "null", 1)
    part, resealed, rekey = made(tmp_path, "part", None, "null")
    assert (part / "case-0001").stat().st_ino == before
    assert unseal(sealed, key).labels == unseal(resealed, rekey, part).labels
    with pytest.raises(InputError, match="already"):
        made(tmp_path, "part", 4, "null")


def test_wrong_keys_and_changed_files_are_refused(tmp_path: Path) -> None:
    folder, sealed, key = made(tmp_path, "set", None, "background")
    assert "repeat_of: run-a" in (folder / "case-0001" / "recording.yaml").read_text()
    _, _, wrong = made(tmp_path, "other", 1, "null")
    for bad in (wrong, "no key", ""):
        with pytest.raises(InputError, match="key"):
            unseal(sealed, bad, folder)
    with pytest.raises(InputError, match="not the file sealed"):
        unseal(tmp_path / "other.sealed", wrong, folder)
    token = sealed.read_bytes()
    sealed.write_bytes(token[:-6] + b"AAAA==")
    with pytest.raises(InputError, match="not the file sealed"):
        unseal(sealed, key, folder)
    with pytest.raises(InputError, match="lies inside"):
        make(1, 1, folder, folder / "sealed", processes=1)


def test_the_composition() -> None:
    orders = compose(400, "mixed", np.random.default_rng(0))
    counts = {kind: sum(order.kind == kind for order in orders) for kind in ("none", "one", "two", "outside")}
    assert counts == {"none": 80, "one": 160, "two": 80, "outside": 80}
    singles = [order.names[0] for order in orders if order.kind == "one"]
    assert {singles.count(effect) for effect in EFFECTS} <= {6, 7}
    assert all(len(set(order.names)) == 2 for order in orders if order.kind == "two")
    assert [order.kind for order in orders[:20]].count("none") < 15
    assert len(null_subsets()) > 60
    with pytest.raises(InputError, match="did you mean 'outside'"):
        compose(3, "outsid", np.random.default_rng(0))


def test_a_public_set_is_the_same_bytes_whoever_makes_it(tmp_path: Path) -> None:
    keys = [make_public("a name", tmp_path / k / "set", tmp_path / f"{k}.sealed", None, 1, 1) for k in "ab"]
    assert keys[0] == keys[1]
    assert contents(tmp_path / "a") == contents(tmp_path / "b")
    assert (tmp_path / "a.sealed").read_bytes() == (tmp_path / "b.sealed").read_bytes()
    opened = unseal(tmp_path / "a.sealed", keys[0], tmp_path / "a" / "set")
    assert opened.made["kinds"] == "varied" and opened.made["cases"] == 1
    for value in opened.labels["case-0001"]["rig"].values():
        assert value == float(f"{value:.9g}")
    with pytest.raises(InputError, match="a public set has 60 cases"):
        make_public("a name", tmp_path / "c", tmp_path / "c.sealed", cases=61)


def test_the_name_of_a_public_set_fixes_what_its_key_opens(tmp_path: Path) -> None:
    key = make_public("one", tmp_path / "one", tmp_path / "one.sealed", None, 1, 1)
    other = make_public("other", tmp_path / "other", tmp_path / "other.sealed", None, 1, 1)
    assert contents(tmp_path / "one") != contents(tmp_path / "other")
    with pytest.raises(InputError, match="the key does not open it"):
        unseal(tmp_path / "other.sealed", key)
    assert unseal(tmp_path / "other.sealed", other).labels


@pytest.mark.parametrize("rows", [1, 5000, 30000])
def test_a_table_is_a_gzip_file_that_does_not_depend_on_who_packs_it(rows: int) -> None:
    packed = encode_table({"time": np.arange(rows) / 500.0, "x": np.ones(rows)}, ("%.3f", "%.4f"))
    lines = gzip.decompress(packed).decode().splitlines()
    assert len(lines) == rows + 1 and lines[0] == "time,x" and lines[-1] == f"{(rows - 1) / 500.0:.3f},1.0000"
    assert len(packed) < len(gzip.decompress(packed)) + 100


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        (("--set", "x", "--seed", "3"), "leave out --seed"),
        (("--set", "x", "--kinds", "one"), "the name fixes seed and rigs"),
        (("--set", "x", "--cases", "70"), "a public set has 60 cases"),
        ((), "state how many recordings by --cases"),
    ],
)
def test_a_public_set_takes_no_other_options(tmp_path: Path, seatsim_command, options, expected) -> None:
    place = ("--out", tmp_path / "set", "--sealed", tmp_path / "set.sealed")
    status, out, err = seatsim_command("blind", "make", *options, *place)
    assert status == 2 and expected in " ".join((out + err).split()) and not (tmp_path / "set").exists()
