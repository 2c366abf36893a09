"""Data that nobody here wrote: every file is imported with at most a ten-line map, and its quirks are found."""

import pytest

from seatsim.importing.importing import import_files
from seatsim.importing.inspection import inspect_file

from ..text import beside, parse

KNOWN = parse(beside(__file__, "shared_data.yaml"))
QUIRKS = {name: set(map(tuple, quirks)) for name, quirks in KNOWN["quirks"].items()}


@pytest.mark.slow
def test_every_file_is_imported_with_a_short_map(shared, tmp_path):
    files = [path for path in sorted((shared / "data").glob("*/*.csv.gz")) if path.parent.name != "roads"]
    assert len(files) >= 20
    for path in files:
        text = KNOWN["maps"].get(path.parent.name)
        stated = tmp_path / "map.yaml" if text else None
        if text and stated:
            assert len(text.splitlines()) <= 10
            stated.write_text(text)
        folder = tmp_path / path.name.partition(".")[0]
        import_files([path], folder, stated)
        assert (folder / "recording.yaml").exists()


@pytest.mark.parametrize("name", QUIRKS)
def test_the_quirks_that_a_description_states_are_found(shared, name):
    found = inspect_file(shared / "data" / f"{name}.csv.gz")
    assert QUIRKS[name] <= {(issue.channel, issue.kind) for issue in found.doubts}
