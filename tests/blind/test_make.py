"""Sets: repeatable, resumable, sealed, and silent about their labels."""

import gzip

import pytest

from seatsim import load_recording
from seatsim.blind.make.make import make
from seatsim.blind.sealed import EFFECTS, unseal
from seatsim.schema.errors import InputError

from .carriers import files_of


def made(base, name, kinds, cases=1, seed=None, stop=None):
    key = make(cases, seed, base / name, base / f"{name}.sealed", stop, kinds, processes=1)
    return base / name, base / f"{name}.sealed", key


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A set of two cases with an effect each, its sealed file and its key."""
    return made(tmp_path_factory.mktemp("whole"), "set", "one", 2, seed=3)


def test_nothing_in_a_set_tells_the_label(whole, tmp_path):
    folder, sealed, key = whole
    opened = unseal(sealed, key, folder)
    assert {label["kind"] for label in opened.labels.values()} == {"one"}
    assert all(1.0 <= size < 11.0 for label in opened.labels.values() for size in label["materialities"])
    telling = {*EFFECTS, "effect:", "seed", "severity", "outside", *opened.labels["case-0001"]["forms"]}
    for name, data in files_of(folder, but="seal").items():
        text = (gzip.decompress(data) if name.endswith(".gz") else data).decode()
        shown = text if name.endswith("yaml") else text.splitlines()[0]
        assert not [word for word in telling if word in shown]
    runs = [f"run-{letter}.csv.gz" for letter in "abc"]
    assert sorted(p.name for p in (folder / "case-0001").iterdir()) == ["nominal.yaml", "recording.yaml", *runs]
    assert len({p.stat().st_mtime for p in folder.glob("case-*/*")}) == 1
    assert list(load_recording(folder / "case-0002").runs) == ["run-a", "run-b", "run-c"]
    assert list(load_recording(opened.extract("case-0002", tmp_path)).runs) == ["run-u"]
    assert not list(folder.parent.glob("*.partial"))


def test_a_set_that_was_broken_off_goes_on_where_it_stopped_and_is_what_its_seed_fixes(whole, tmp_path):
    def stop(done, _):
        if done == 1:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        made(tmp_path, "part", "one", 2, 3, stop)
    before = (tmp_path / "part" / "case-0001").stat().st_ino
    with pytest.raises(InputError, match="unfinished set"):
        made(tmp_path, "part", "one", 3, 3)
    part, resealed, rekey = made(tmp_path, "part", "one", 2)
    assert (part / "case-0001").stat().st_ino == before
    folder, sealed, key = whole
    assert files_of(folder, but="seal") == files_of(part, but="seal")
    assert unseal(sealed, key).labels == unseal(resealed, rekey, part).labels
    with pytest.raises(InputError, match="already"):
        made(tmp_path, "part", "one", 2, 3)


def test_wrong_keys_and_changed_files_are_refused(whole, tmp_path):
    folder, sealed, key = made(tmp_path, "set", "none")
    _, other, wrong = whole
    for bad in (wrong, "no key", ""):
        with pytest.raises(InputError, match="key"):
            unseal(sealed, bad, folder)
    with pytest.raises(InputError, match="not the file sealed"):
        unseal(other, wrong, folder)
    token = sealed.read_bytes()
    sealed.write_bytes(token[:-6] + b"AAAA==")
    with pytest.raises(InputError, match="not the file sealed"):
        unseal(sealed, key, folder)
    with pytest.raises(InputError, match="lies inside"):
        make(1, 1, folder, folder / "sealed", processes=1)


def test_a_public_set_is_the_same_bytes_whoever_makes_it_and_its_name_fixes_what_its_key_opens(tmp_path):
    def publish(name, place):
        return make(1, None, tmp_path / place / "set", tmp_path / f"{place}.sealed", processes=1, name=name)

    keys = [publish("a name", place) for place in "ab"]
    assert keys[0] == keys[1]
    assert files_of(tmp_path / "a") == files_of(tmp_path / "b")
    assert (tmp_path / "a.sealed").read_bytes() == (tmp_path / "b.sealed").read_bytes()
    opened = unseal(tmp_path / "a.sealed", keys[0], tmp_path / "a" / "set")
    assert opened.made["kinds"] == "varied" and opened.made["cases"] == 1
    assert all(value == float(f"{value:.9g}") for value in opened.labels["case-0001"]["severities"])
    assert load_recording(tmp_path / "a" / "set" / "case-0001").nominal.plant.damper_ratio <= 1.0
    key = publish("other", "c")
    assert files_of(tmp_path / "a") != files_of(tmp_path / "c")
    with pytest.raises(InputError, match="the key does not open it"):
        unseal(tmp_path / "c.sealed", keys[0])
    assert unseal(tmp_path / "c.sealed", key).labels
    with pytest.raises(InputError, match="a public set has 60 cases"):
        make(61, None, tmp_path / "d", tmp_path / "d.sealed", name="a name")


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        (("--set", "x", "--seed", "3"), "leave out --seed"),
        (("--set", "x", "--kinds", "one"), "the name fixes seed and rigs"),
        (("--set", "x", "--cases", "70"), "a public set has 60 cases"),
        ((), "state how many recordings by --cases"),
    ],
)
def test_a_public_set_takes_no_other_options(tmp_path, seatsim_command, options, expected):
    place = ("--out", tmp_path / "set", "--sealed", tmp_path / "set.sealed")
    status, out, err = seatsim_command("blind", "make", *options, *place)
    assert status == 2 and expected in " ".join((out + err).split()) and not (tmp_path / "set").exists()
