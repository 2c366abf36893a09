"""Text tables as loggers and spreadsheets write them."""

import numpy as np
import pytest

from seatsim.importing.readers.reading import TextLayout, read_file
from seatsim.schema.errors import InputError

ROWS = np.column_stack([np.arange(40) / 100.0, np.sin(np.arange(40)), 1000.0 + np.arange(40)])


def written(path, delimiter, decimal, above, encoding="utf-8", end="\n", rows=ROWS):
    lines = [delimiter.join(f"{value:.9g}".replace(".", decimal) for value in row) for row in rows]
    path.write_bytes(end.join([*above, *lines, ""]).encode(encoding))
    return path


def columns(file):
    return {signal.name: signal.unit for signal in file.groups[0].signals}


@pytest.mark.parametrize("delimiter", [";", "\t", ",", "|", " "])
@pytest.mark.parametrize("decimal", [".", ","])
def test_delimiter_and_decimal_sign_are_found(tmp_path, delimiter, decimal):
    if delimiter == decimal:
        return
    path = written(tmp_path / "a.csv", delimiter, decimal, [delimiter.join(["t", "acc", "load"])])
    file = read_file(path)
    assert list(columns(file)) == ["t", "acc", "load"]
    for signal, expected in zip(file.groups[0].signals, ROWS.T, strict=True):
        np.testing.assert_allclose(signal.values, expected, rtol=1e-8, atol=1e-12)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "cp1252", "utf-16"])
def test_titles_units_and_encodings(tmp_path, encoding):
    above = ["Prüfstand; Nr. 7", "Datum;23.11.2026", "Zeit;Dämpferkraft;Weg (mm)", "s;kN;", ""]
    file = read_file(written(tmp_path / "a.csv", ";", ",", above[:-1], encoding, "\r\n"))
    assert columns(file) == {"Zeit": "s", "Dämpferkraft": "kN", "Weg": "mm"}
    assert file.groups[0].rows == len(ROWS)


def test_units_in_brackets_and_no_names_at_all(tmp_path):
    file = read_file(written(tmp_path / "a.csv", ",", ".", ["t [ms],a_z (g),F"]))
    assert columns(file) == {"t": "ms", "a_z": "g", "F": ""}
    file = read_file(written(tmp_path / "b.csv", ",", ".", []))
    assert columns(file) == {"column 1": "", "column 2": "", "column 3": ""}


def test_a_stated_layout_counts_the_lines_above_the_numbers(tmp_path):
    path = written(tmp_path / "a.csv", ";", ".", ["a;b;c", "1;2;3"])
    assert read_file(path, TextLayout(header=2)).groups[0].rows == len(ROWS)
    assert read_file(path, TextLayout(header=1)).groups[0].rows == len(ROWS) + 1
    with pytest.raises(InputError, match=r"csv\.header 99"):
        read_file(path, TextLayout(header=99))


def test_cells_without_a_value_are_missing_and_texts_are_named(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("time,force,state\n" + "".join(f"{k / 10},{'NaN' if k == 3 else k},run\n" for k in range(30)))
    file = read_file(path)
    assert np.isnan(file.groups[0].signals[1].values).sum() == 1
    assert file.notes == ("columns that hold no numbers: state",)
