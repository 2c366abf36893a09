"""Maps: proposed from names in several languages, read with clear errors, and written to be read again."""

import shutil

import numpy as np
import pytest

from seatsim.importing.import_map import read_map, render_map
from seatsim.importing.importing import import_files
from seatsim.importing.matching import propose
from seatsim.importing.readers.reading import read_file
from seatsim.recordings.recording import load_recording
from seatsim.schema.errors import InputError

from ..text import beside, parse, words
from .helpers import read_run, write_csv

SEAT = tuple(
    words("""
    floor_acceleration frame_acceleration driver_acceleration suspension_displacement damper_force
    current_command coil_current damper_temperature
""")
)
NAMES = parse(beside(__file__, "names_by_language.yaml"))


def file_of(tmp_path, names, time="Zeit [s]"):
    generator = np.random.default_rng(1)
    columns = {time: np.arange(1500) / 500.0}
    return write_csv(tmp_path / "a.csv", {**columns, **{name: generator.standard_normal(1500) for name in names}})


@pytest.mark.parametrize("language", NAMES)
def test_columns_are_matched_by_name_and_unit(tmp_path, language):
    proposal, open_ends = propose([read_file(file_of(tmp_path, NAMES[language]))])
    assert open_ends == []
    columns = [name.split(" [")[0].split(" (")[0] for name in NAMES[language]]
    assert {name: entry.column for name, entry in proposal.channels.items()} == dict(zip(SEAT, columns, strict=True))
    assert all(entry.sign == 1 for entry in proposal.channels.values())


def test_lateral_axes_and_commands_of_other_things_are_left(tmp_path):
    names = ["acc_floor_x [g]", "acc_floor_y [g]", "acc_floor_z [g]", "displacement_cmd [mm]", "engine temp [C]"]
    names += ["Sitzkraft [N]", "seat temperature [C]"]
    proposal, _ = propose([read_file(file_of(tmp_path, names))])
    assert {name: entry.column for name, entry in proposal.channels.items()} == {"floor_acceleration": "acc_floor_z"}


@pytest.mark.parametrize(
    ("names", "expected"),
    [
        (["a_Boden"], "floor_acceleration: the file states no unit of 'a_Boden'; write it as unit, such as m/s"),
        (["x_1 [g]", "x_2 [g]"], "floor_acceleration: no column is it by name.*left are x_1, x_2"),
        (["acc floor left [g]", "acc floor right [g]"], "acc floor left and acc floor right fit equally well"),
    ],
)
def test_what_cannot_be_matched_is_asked_for_by_name(tmp_path, names, expected):
    path = file_of(tmp_path, names)
    with pytest.raises(InputError, match=expected):
        import_files([path], tmp_path / "out")
    assert [each.name for each in (tmp_path / "out").iterdir()] == ["map.yaml"]


def test_a_proposed_map_can_be_completed_and_used(tmp_path):
    path = file_of(tmp_path, ["Signal 1 [g]", "Signal 2 [mm]"])
    with pytest.raises(InputError, match="complete it and give it by --map"):
        import_files([path], tmp_path / "out")
    stated = tmp_path / "out" / "map.yaml"
    with pytest.raises(InputError, match="give either the name of its column, or value"):
        read_map(stated)
    text = stated.read_text().replace("{column: null, unit: null, sign: 1}", '{column: "Signal 1", unit: g, sign: -1}')
    stated.write_text(text)
    import_files([path], tmp_path / "out", stated)
    assert load_recording(tmp_path / "out").channels.keys() == {"floor_acceleration", "suspension_displacement"}


def test_a_map_is_written_as_it_is_read(tmp_path):
    text = """\
rig: seat
time: {column: 't [ms]', unit: ms}
resample: 250.0
channels:
  floor_acceleration: {column: 'a, floor', unit: g, sign: -1, remove_mean: true}
  driver_acceleration: {column: a_seat, unit: m/s^2, sign: 1, scale: 0.5, delay: 0.01, group: daq2.csv}
  coil_current: {unit: A, value: 0.3}
csv: {delimiter: ;, decimal: ',', header: 2}
gaps: split
align: {daq2.csv: 0.25}
runs:
  first: [a.csv, b.csv]
"""
    path = tmp_path / "map.yaml"
    path.write_text(text)
    stated = read_map(path)
    assert render_map(stated) == text


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("chanels: {}", "did you mean 'channels'"),
        ("rig: seat", "key 'channels' is missing"),
        ("channels: {flor_acceleration: {column: a}}", "did you mean 'floor_acceleration'"),
        ("channels: {floor_acceleration: {colum: a}}", "did you mean 'column'"),
        ("channels: {floor_acceleration: {column: a, sign: 2}}", "sign"),
        ("channels: {floor_acceleration: {unit: g}}", "give either the name of its column"),
        ("channels: {floor_acceleration: {column: a}}\nruns: {a: b}", "must be a list, such as \\[b\\]"),
        ("channels: {floor_acceleration: {column: a}}\ngaps: cut", "gaps"),
        ("channels: {floor_acceleration: {column: a}}\nalign: {b: soon}", "must be a finite number"),
        ("channels: {floor_acceleration: {column: a}}\nalign: {b: .nan}", "must be a finite number"),
        ("channels: {floor_acceleration: {column: a}}\nsample_rate: 1.0e-300", "must be at least 0.001 Hz"),
    ],
)
def test_a_wrong_map_is_one_clear_error(tmp_path, text, expected):
    path = tmp_path / "map.yaml"
    path.write_text(text + "\n")
    with pytest.raises(InputError, match=expected):
        read_map(path)


@pytest.mark.parametrize(
    ("entry", "expected"),
    [
        ("{column: floor_accel}", "no column 'floor_accel' \\(did you mean 'floor_acceleration'\\?\\)"),
        ("{column: floor_acceleration, unit: kN}", "'kN' is no unit of a value in m/s\\^2"),
        ("{column: floor_acceleration, minus: nothing}", "no column 'nothing'"),
        ("{column: floor_acceleration, group: other}", "of group 'other'"),
    ],
)
def test_a_map_that_contradicts_the_file_is_one_clear_error(tmp_path, entry, expected):
    stated = tmp_path / "map.yaml"
    stated.write_text(f"time: {{column: time, unit: s}}\nchannels: {{floor_acceleration: {entry}}}\n")
    with pytest.raises(InputError, match=expected):
        import_files([file_of(tmp_path, ["floor_acceleration"], "time")], tmp_path / "out", stated)
    assert not (tmp_path / "out").exists()


def test_a_map_names_the_files_of_runs_and_what_repeats_what(tmp_path):
    first = file_of(tmp_path, ["floor_acceleration"], "time")
    paths, stated = [first, shutil.copy(first, tmp_path / "b.csv")], tmp_path / "map.yaml"
    channels = "channels: {floor_acceleration: {column: floor_acceleration}}\n"
    stated.write_text(f"time: {{column: time, unit: s}}\n{channels}runs: {{x: [a.csv], y: [c.csv]}}\n")
    with pytest.raises(InputError, match=r"runs\.y: 'c\.csv' was not given"):
        import_files(paths, tmp_path / "out", stated)
    stated.write_text(f"time: {{column: time}}\n{channels}runs: {{x: [a.csv], y: [b.csv]}}\nrepeats: {{y: x}}\n")
    import_files(paths, tmp_path / "out", stated)
    assert load_recording(tmp_path / "out").runs["y"].repeat_of == "x"


def test_differences_and_derivatives(tmp_path):
    times = np.arange(0.0, 10.0, 0.002)
    floor, body = 0.01 * np.sin(9 * times), 0.004 * np.cos(6 * times)
    path = write_csv(tmp_path / "a.csv", {"time": times, "low_mm": 1e3 * floor, "high_mm": 1e3 * body})
    stated = tmp_path / "map.yaml"
    stated.write_text(
        "time: {column: time, unit: s}\nchannels:\n"
        "  floor_acceleration: {column: low_mm, unit: mm, differentiate: 2}\n"
        "  suspension_displacement: {column: high_mm, minus: low_mm, unit: mm}\n"
    )
    import_files([path], tmp_path / "out", stated)
    table = read_run(tmp_path / "out")
    np.testing.assert_allclose(table["floor_acceleration"][5:-5], (-81 * floor)[5:-5], atol=1e-3)
    np.testing.assert_allclose(table["suspension_displacement"], body - floor, atol=1e-9)


def test_a_column_without_a_channel_is_named_and_an_offset_is_added_in_the_unit(tmp_path):
    file = file_of(tmp_path, [*NAMES["German"], "Kopf z [g]"])
    found = import_files([file], tmp_path / "as-proposed")
    assert any("'Kopf z'" in note and "left out" in note for note in found.notes)
    text = (tmp_path / "as-proposed" / "map.yaml").read_text(encoding="utf-8")
    (tmp_path / "map.yaml").write_text(text.replace("unit: mm,", "unit: mm, offset: -3,"), encoding="utf-8")
    import_files([file], tmp_path / "moved", tmp_path / "map.yaml")
    plain, moved = (read_run(tmp_path / each) for each in ("as-proposed", "moved"))
    change = moved["suspension_displacement"] - plain["suspension_displacement"]
    np.testing.assert_allclose(change, -0.003, atol=1e-7)
