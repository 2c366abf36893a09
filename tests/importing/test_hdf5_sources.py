"""Where the numbers of an HDF5 file come from: none of a stranger's file."""

import h5py
import numpy as np
import pytest

from seatsim.importing.readers.reading import read_file
from seatsim.schema.errors import InputError

ROWS = 1.0 + np.arange(100.0)


def write(path, fill):
    with h5py.File(path, "w") as file:
        file["force"] = ROWS
        fill(file)
    return path


def make_virtual(file):
    layout = h5py.VirtualLayout((100,), "f8")
    layout[:] = h5py.VirtualSource("beside.h5", "force", (100,))
    file.create_virtual_dataset("virtual", layout)


@pytest.mark.parametrize(
    ("fill", "said"),
    [
        (lambda file: file.__setitem__("x", h5py.ExternalLink("beside.h5", "/force")), "'x' is a link to another file"),
        (lambda file: file.__setitem__("x", h5py.SoftLink("/gone")), "'x' is a link to '/gone', which is not there"),
        (lambda file: file.create_dataset("x", (90,), "u1", external=[("/etc/passwd", 0, 90)]), "in another file"),
        (make_virtual, "virtual: is virtual"),
        (lambda file: file.__setitem__("linked", h5py.SoftLink("/force")), None),
    ],
    ids=["external link", "link to nothing", "external storage", "virtual", "link within"],
)
def test_numbers_come_from_the_file_itself(tmp_path, fill, said):
    write(tmp_path / "beside.h5", lambda file: None)
    path = write(tmp_path / "a.h5", fill)
    if said:
        with pytest.raises(InputError, match=said):
            read_file(path)
    else:
        (group,) = read_file(path).groups
        assert np.array_equal(group.find("linked").values, ROWS)


def test_what_is_no_column_is_said(tmp_path):
    path = write(tmp_path / "a.h5", lambda file: file.create_dataset("cube", data=np.zeros((3, 4, 5))))
    assert any("'/cube' is left out" in note for note in read_file(path).notes)
