"""Damaged files of every kind that others send: each is read, or refused by one sentence, soon and leaving nothing."""

import random
import time
import warnings

import pytest

from seatsim.schema.errors import SeatsimError

from ..importing.exports import FORMATS
from .mutations import mutate
from .readers import make_readers

MUTANTS, LIMIT = 25, 120.0
NAMES = (
    *("scenario", "variants", "recording", "table", "bench", "sweep", "floor", "map", "diagnosis", "manifest"),
    *(f"format {name}" for name in FORMATS),
)
pytestmark = [
    pytest.mark.slow,
    # Libraries that write and read tables leave files open.
    pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning"),
]


@pytest.fixture(scope="module")
def readers():
    made = make_readers()
    assert set(made) == set(NAMES)
    return made


def write(files, folder):
    for name, content in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content)


@pytest.mark.parametrize("name", NAMES)
def test_valid_files_are_read_and_damaged_ones_are_read_or_refused_by_a_sentence(readers, name, tmp_path):
    reader, refused = readers[name], 0
    write(reader.files, tmp_path / "valid")
    reader.read(tmp_path / "valid")
    for number in range(MUTANTS):
        generator, files, folder = random.Random(f"7 {number}"), dict(reader.files), tmp_path / str(number)
        changed = generator.choice(reader.changed)
        for _ in range(generator.choice((1, 1, 1, 2, 3))):
            files[changed] = mutate(files[changed], generator)
        write(files, folder)
        before, begun = sorted(folder.rglob("*")), time.perf_counter()
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                reader.read(folder)
        except SeatsimError as error:
            refused += 1
            assert "\n" not in str(error) and len(str(error)) < 3000, number
            assert sorted(folder.rglob("*")) == before, number
        assert time.perf_counter() - begun < LIMIT, number
    assert refused
