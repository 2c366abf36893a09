"""A bounded run of the fuzzing of all readers: no traceback, nothing that takes long, no file left."""

import pytest

from tests.importing.exports import FORMATS

MUTANTS = 40
# Libraries that write and read tables leave files open.
pytestmark = pytest.mark.filterwarnings(
    "ignore::ResourceWarning",
    "ignore::pytest.PytestUnraisableExceptionWarning",
)


@pytest.fixture(scope="module")
def fuzzing(benchmark):
    return benchmark("fuzz_readers")


@pytest.fixture(scope="module")
def readers(fuzzing):
    return fuzzing.make_readers()


NAMES = (
    "scenario", "variants", "recording", "table", "bench", "sweep", "design", "floor", "rows", "resumed", "unit",
    "import", "map", "synthesis", "diagnosis", "manifest", "sealed",
    *(f"format {name}" for name in (*FORMATS, "KRBI.crg", "LRFI.crg")),
)  # fmt: skip


@pytest.mark.parametrize("name", NAMES)
def test_damaged_files_are_read_or_refused_by_a_sentence(fuzzing, readers, name):
    found = fuzzing.fuzz(readers[name], MUTANTS, seed=7, limit=60.0)
    assert set(found.counts) <= {"read", "refused"}, found.examples
    assert found.counts["refused"]


def test_every_reader_is_fuzzed(readers):
    assert set(readers) == set(NAMES)


def test_valid_files_are_read(readers, tmp_path):
    for name, reader in readers.items():
        folder = tmp_path / name
        folder.mkdir()
        for file, content in reader.files.items():
            (folder / file).parent.mkdir(exist_ok=True)
            (folder / file).write_bytes(content)
        reader.read(folder)
