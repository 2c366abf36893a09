"""Where the numbers of an HDF5 file come from: no stranger's file, and no zeros in place of a missing source."""

import h5py
import numpy as np
import pytest

from seatsim.importing.readers.reading import read_file
from seatsim.schema.errors import InputError

from ..text import parse

ROWS = 1.0 + np.arange(100.0)


def write(path, fill):
    with h5py.File(path, "w") as file:
        file["force"] = ROWS
        fill(file)
    return path


def virtual(source, name="force", rows=100, read=100):
    """Return what adds a virtual data set of so many rows that takes them from a file."""

    def fill(file):
        layout = h5py.VirtualLayout((rows,), "f8")
        layout[:read] = h5py.VirtualSource(source, name, (read,))
        file.create_virtual_dataset("virtual", layout)

    return fill


@pytest.mark.parametrize(
    ("fill", "said"),
    [
        (lambda file: file.__setitem__("x", h5py.ExternalLink("beside.h5", "/force")), "'x' is a link to another file"),
        (lambda file: file.__setitem__("x", h5py.SoftLink("/gone")), "'x' is a link to '/gone', which is not there"),
        (lambda file: file.create_dataset("x", (90,), "u1", external=[("/etc/passwd", 0, 90)]), "in another file"),
        (virtual("gone.h5"), "'force' of 'gone.h5', which is not there"),
        (virtual("beside.h5", "gone"), "'gone' of 'beside.h5', which is not there"),
        (virtual("beside.h5", rows=300, read=300), "'force' of 'beside.h5', which is not there"),
        (virtual("../beside.h5"), "must lie beside it"),
        (virtual("."), None),
        (virtual("beside.h5"), None),
        (virtual(".", rows=120), "20 of its 120 numbers have no source"),
        (lambda file: file.__setitem__("virtual", h5py.SoftLink("/force")), None),
    ],
    ids=parse("""
            [external link, link to nothing, external storage, no source file, no source, source too short,
             source above, virtual, virtual of a file beside, virtual in part, link within]
        """),
)
def test_numbers_come_from_the_file_itself_or_from_sources_that_are_there(tmp_path, fill, said):
    write(tmp_path / "beside.h5", lambda file: None)
    path = write(tmp_path / "a.h5", fill)
    if said:
        with pytest.raises(InputError, match=said):
            read_file(path)
    else:
        (group,) = read_file(path).groups
        assert np.array_equal(group.find("virtual").values, ROWS)


def test_rows_that_were_never_written_are_said(tmp_path):
    def fill(file):
        file.create_dataset("half", (100,), "f8", chunks=(10,))[:50] = 1.0
        file.create_dataset("cube", data=np.zeros((3, 4, 5)))

    notes = read_file(write(tmp_path / "a.h5", fill)).notes
    assert any("'/half': 50% of it was never written" in note for note in notes)
    assert any("'/cube' is left out" in note for note in notes)
