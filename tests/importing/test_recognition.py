"""What a column is by the words of its name and its unit together, and of which rig its file is."""

import numpy as np
import pytest

from seatsim.importing.matching import channel_of, propose, read_columns
from seatsim.importing.names import read_name
from seatsim.importing.readers.reading import read_file
from seatsim.importing.signals import DataFile, Group, Signal, find_clock

from ..text import beside, parse

T = np.arange(500) / 250.0


def file_of(tmp_path, *columns):
    generator = np.random.default_rng(3)
    signals = [
        Signal(name, unit, T if name == "t" else generator.standard_normal(len(T)))
        for name, unit in (("t", "s"), *columns)
    ]
    return DataFile(tmp_path / "a.csv", "CSV", (Group("", tuple(signals)),))


NAMES = parse(beside(__file__, "column_names.yaml"))


@pytest.mark.parametrize(("name", "unit", "quantity", "stated"), NAMES)
def test_the_unit_decides_between_the_words_of_a_name(name, unit, quantity, stated):
    found = read_name(name, unit)
    assert (found.quantity, found.unit) == (quantity, stated)


def test_of_a_force_in_volts_and_one_in_newtons_the_second_is_the_force(tmp_path):
    file = file_of(tmp_path, ("Force", "V"), ("Force 2", "N"), ("Displacement", "mm"))
    found, open_ends = propose([file])
    assert open_ends == [] and found.rig == "damper_bench"
    assert found.channels["damper_force"].column == "Force 2"
    columns = {each.signal.name: channel_of(each, "damper_bench") for each in read_columns(file.groups[0])}
    assert columns == {"t": None, "Force": None, "Force 2": "damper_force", "Displacement": "displacement"}


def test_a_force_in_volts_alone_is_asked_for_by_its_true_reason(tmp_path):
    _, (problem,) = propose([file_of(tmp_path, ("Force", "V"), ("Displacement", "mm"))])
    assert "'Force' is stated in V, which is no unit of it; write unit, such as N" in problem


@pytest.mark.parametrize(
    ("columns", "rig"),
    [
        ([("Weg", "mm"), ("Kraft", "N")], "damper_bench"),
        ([("Federweg", "mm"), ("Dämpferkraft", "daN")], "damper_bench"),
        ([("disp", "m"), ("load", "kN"), ("acc", "g")], "damper_bench"),
        ([("Débattement", "mm"), ("Effort", "N"), ("Accélération siège z", "m/s²")], "seat"),
        ([("a_Boden", "g"), ("Weg", "mm"), ("Kraft", "N")], "seat"),
        ([("Weg", "mm"), ("a_Boden", "g")], "seat"),
    ],
)
def test_a_displacement_and_a_force_alone_are_of_a_bench(tmp_path, columns, rig):
    assert propose([file_of(tmp_path, *columns)])[0].rig == rig


def test_x_beside_y_and_z_is_an_axis_and_no_displacement(tmp_path):
    columns = read_columns(file_of(tmp_path, ("x", ""), ("y", ""), ("z", ""), ("Federweg", "")).groups[0])
    assert [each.meaning.quantity for each in columns] == ["time", None, None, None, "displacement"]


def test_of_several_columns_called_time_the_even_one_counts(tmp_path):
    (tmp_path / "a.csv").write_text(
        "Zeitstempel,Time [ms],x\n" + "".join(f"10:00:0{k // 250},{4 * k},{k % 7}\n" for k in range(500))
    )
    (group,) = read_file(tmp_path / "a.csv").groups
    clock = find_clock(group)
    assert (clock.column, clock.axis.rate) == ("Time [ms]".partition(" ")[0], 250.0)
