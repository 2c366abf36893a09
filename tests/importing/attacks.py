"""Small files of every format whose structure asks a reader for far more than they hold: cycles, doubling, lies."""

import io
import struct
import zipfile
import zlib
from functools import partial

import h5py
import numpy as np
import pandas as pd

from ..text import words
from . import exports

ROWS = np.arange(200.0)
TABLE = {"time": 0.002 * ROWS} | {name: np.sin(ROWS / 9.0 + len(name)) for name in exports.UNITS}
DOUBLINGS = 40
FAR = 2**31


def _written(write, name, folder):
    write(folder / name, TABLE)
    return bytearray((folder / name).read_bytes())


def _hdf5(fill):
    content = io.BytesIO()
    with h5py.File(content, "w") as file:
        file["force"] = ROWS
        fill(file)
    return content.getvalue()


def hdf5_group_in_itself(folder):
    return _hdf5(lambda file: file.create_group("inner").__setitem__("outer", file["/"]))


def hdf5_doubling_links(folder):
    def fill(file):
        group = file.create_group("g0")
        group["force"] = ROWS
        for number in range(1, DOUBLINGS):
            outer = file.create_group(f"g{number}")
            outer["left"] = outer["right"] = group
            group = outer

    return _hdf5(fill)


def hdf5_never_written(folder):
    return _hdf5(lambda file: file.create_dataset("x", (6 * 10**8,), "f8", chunks=(10**6,), compression="gzip"))


def hdf5_virtual_of_itself(folder):
    def fill(file):
        layout = h5py.VirtualLayout((100,), "f8")
        layout[:] = h5py.VirtualSource(".", "v", (100,))
        file.create_virtual_dataset("v", layout)

    return _hdf5(fill)


def _mat73(folder, fill):
    path = folder / "a.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        fill(file)
    return b"MATLAB 7.3 MAT-file".ljust(124) + b"\0\2IM" + path.read_bytes()[128:]


def mat73_doubling_references(folder):
    def fill(file):
        cell = file.create_dataset("#refs#/a", data=ROWS[None, :])
        cell.attrs["MATLAB_class"] = np.bytes_("double")
        for number in range(DOUBLINGS):
            outer = file.create_dataset(f"#refs#/c{number}", (1, 2), h5py.ref_dtype)
            outer[...] = [[cell.ref, cell.ref]]
            outer.attrs["MATLAB_class"] = np.bytes_("cell")
            cell = outer
        file["cells"] = cell

    return _mat73(folder, fill)


def mat73_cell_in_itself(folder):
    def fill(file):
        cell = file.create_dataset("cells", (1, 1), h5py.ref_dtype)
        cell[0, 0] = cell.ref
        cell.attrs["MATLAB_class"] = np.bytes_("cell")

    return _mat73(folder, fill)


def _mat(*elements):
    return b"MATLAB 5.0 MAT-file".ljust(124) + b"\0\1IM" + b"".join(elements)


def _element(kind, content):
    return struct.pack("<II", kind, len(content)) + content + b"\0" * (-len(content) % 8)


def _array(kind, shape, *parts, name=b"a"):
    head = _element(6, struct.pack("<II", kind, 0)) + _element(5, np.array(shape, "<i4").tobytes()) + _element(1, name)
    return _element(14, head + b"".join(parts))


def mat_zeros_packed(folder):
    content = zlib.compress(_array(6, (2**24, 1), _element(9, bytes(2**27))), 9)
    return _mat(struct.pack("<II", 15, len(content)) + content)


def mat_cells_by_dimensions_alone(folder):
    return _mat(_array(1, (2**30, 2**30)))


def mat_cells_deep_in_each_other(folder):
    inner = _array(6, (200, 1), _element(9, ROWS.tobytes()))
    for _ in range(3000):
        inner = _array(1, (1, 1), inner)
    return _mat(inner)


def _blocks(content, kind):
    """Yield the addresses of the blocks of a kind of an MDF file of version 4."""
    at = content.find(kind)
    while at >= 0:
        yield at
        at = content.find(kind, at + 4)


def _link(content, block, number, address):
    struct.pack_into("<Q", content, block + 24 + 8 * number, address)


def _mdf_in_a_circle(kind, link, folder):
    content = _written(exports.mdf, "a.mf4", folder)
    block = next(_blocks(content, kind))
    _link(content, block, link, block)
    return bytes(content)


def mdf_doubling_conversions(folder):
    content = _written(exports.mdf, "a.mf4", folder)
    address = 0
    for _ in range(DOUBLINGS):
        block = struct.pack("<4s4xQQ", b"##CC", 24 + 8 * 6 + 24, 6) + struct.pack("<6Q", 0, 0, 0, 0, address, address)
        content += bytes(-len(content) % 8)
        address = len(content)
        content += block + struct.pack("<BBHHHdd", 7, 0, 0, 2, 0, 0.0, 0.0)
    _link(content, list(_blocks(content, b"##CN"))[1], 4, address)
    return bytes(content)


def mdf_rows_beyond_the_file(folder):
    content = _written(exports.mdf, "a.mf4", folder)
    at = content.index(struct.pack("<Q", len(ROWS)), next(_blocks(content, b"##CG")))
    struct.pack_into("<Q", content, at, 2**40)
    return bytes(content)


def _mdf_packed(stated, folder):
    """Put a packed block of 64 MiB of zeros, which states so many bytes, in the place of the rows."""
    content = _written(exports.mdf, "a.mf4", folder)
    content += bytes(-len(content) % 8)
    packed = zlib.compress(bytes(2**26), 9)
    _link(content, next(_blocks(content, b"##DG")), 2, len(content))
    content += struct.pack("<4s4xQQ2sBBIQQ", b"##DZ", 48 + len(packed), 0, b"DT", 0, 0, 0, stated, len(packed)) + packed
    return bytes(content)


def sheet(rows, dimension="A1:H201"):
    """Return a workbook with these rows in the place of those of its only sheet."""
    written, content = io.BytesIO(), io.BytesIO()
    pd.DataFrame().to_excel(written)
    head = f'<worksheet xmlns="{SHEET}"><dimension ref="{dimension}"/><sheetData>'
    with zipfile.ZipFile(written) as book, zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as changed:
        for name in book.namelist():
            is_sheet = name == "xl/worksheets/sheet1.xml"
            changed.writestr(name, f"{head}{rows}</sheetData></worksheet>" if is_sheet else book.read(name))
    return content.getvalue()


SHEET = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"


def xlsx_last_column_in_every_row(folder):
    rows = (f'<row r="{n}"><c r="A{n}"><v>{n}</v></c><c r="XFD{n}"><v>1</v></c></row>' for n in range(1, 20_000))
    return sheet("".join(rows))


def xlsx_row_number_beyond_excel(folder):
    return sheet('<row r="1"><c><v>1</v></c></row><row r="99999999999"><c><v>1</v></c></row>')


def xlsx_packed_zeros(folder):
    return sheet("<row>" + "<c><v>0</v></c>" * 4 + "</row>" + " " * 2**26)


def tdms_values_beyond_the_file(folder):
    content = _written(exports.tdms, "a.tdms", folder)
    at = content.index(struct.pack("<IQ", 1, len(ROWS)))
    struct.pack_into("<Q", content, at + 4, 2**40)
    return bytes(content)


def rpc_channels_without_frames(folder):
    content = bytes(_written(exports.rpc, "a.rsp", folder))
    for key, old, new in ((b"CHANNELS", b"7", b"9999999999"), (b"FRAMES", b"1", b"0")):
        record = key.ljust(32, b"\0") + old.ljust(96, b"\0")
        assert record in content
        content = content.replace(record, key.ljust(32, b"\0") + new.ljust(96, b"\0"))
    return content


def uff_values_beyond_the_file(folder):
    return bytes(_written(exports.uff, "a.uff", folder)).replace(b"%10d" % len(ROWS), b"%10d" % (FAR - 1))


def parquet_of_one_value(folder):
    import pyarrow as pa
    from pyarrow import parquet

    content = io.BytesIO()
    parquet.write_table(pa.table({"a": np.zeros(2**24, "u1")}), content)
    return content.getvalue()


ATTACKS = {
    name: make
    for name, make in list(globals().items())
    if name.partition("_")[0] in tuple(words("hdf5 mat73 mat mdf xlsx tdms rpc uff parquet"))
} | {
    "mdf_groups_in_a_circle": partial(_mdf_in_a_circle, b"##DG", 0),
    "mdf_channel_composed_of_itself": partial(_mdf_in_a_circle, b"##CN", 1),
    "mdf_packed_zeros": partial(_mdf_packed, 2**26),
    "mdf_packed_zeros_that_state_less": partial(_mdf_packed, 64 * len(ROWS)),
}
"""Name of an attack, of which the first word is the format, and what makes the file."""
