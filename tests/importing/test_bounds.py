"""Whatever a small file states, a reader is soon done with it, takes little memory and says one sentence."""

import time

import pytest

from seatsim.importing.readers.reading import read_file
from seatsim.schema.errors import InputError

from .attacks import ATTACKS, sheet
from .helpers import LET_LIBRARIES_WARN

pytestmark = LET_LIBRARIES_WARN


@pytest.mark.parametrize("name", ATTACKS)
def test_a_structure_that_asks_for_too_much_is_refused_at_once(name, tmp_path):
    path = tmp_path / "a.bin"
    path.write_bytes(ATTACKS[name](tmp_path))
    assert path.stat().st_size < 2**22
    start = time.process_time()
    with pytest.raises(InputError) as raised:
        read_file(path)
    # Far less than what is asked for would take.
    assert time.process_time() - start < 60.0
    assert "\n" not in str(raised.value)


def test_stated_dimensions_of_a_sheet_do_not_count(tmp_path):
    rows = "".join(f'<row r="{n}"><c r="A{n}"><v>{n}</v></c><c r="B{n}"><v>1</v></c></row>' for n in range(1, 5000))
    (tmp_path / "a.xlsx").write_bytes(sheet(rows, "A1:XFD1048576"))
    (group,) = read_file(tmp_path / "a.xlsx").groups
    assert [len(signal.values) for signal in group.signals] == [4999, 4999]
