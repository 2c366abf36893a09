"""Files and tables of the command line."""

import json

import pandas as pd
import pyarrow.parquet as pq


def test_run_writes_table_histories_and_pictures(seat_file, seatsim_command):
    out = seat_file.parent / "results"
    variants = 'variants={"a": {}, "passive": {"controller": {"law": "constant", "current": 0.0}}}'
    status, printed, _ = seatsim_command("run", seat_file, "--out", out, "--set", variants)
    assert status == 0
    assert "passive" in printed and "travel" in printed
    table = pd.read_csv(out / "summary.csv")
    assert list(table.variant) == ["a", "passive"]
    summary = json.loads((out / "summary.json").read_text())
    assert summary["runs"][0]["metrics"]["driver_acceleration_rms"]["unit"] == "m/s^2"
    history = pq.read_table(out / "history.parquet")
    assert history.schema.field("suspension_displacement").metadata == {b"unit": b"m"}
    assert set(history["run"].to_pylist()) == {"seat (a)", "seat (passive)"}
    assert sorted(path.suffix for path in out.iterdir()).count(".png") >= 5
    assert not [path for path in out.iterdir() if path.name.startswith(".")]


def test_a_failed_run_exits_with_1_and_keeps_the_others(seat_file, undrawn, seatsim_command):
    out = seat_file.parent / "results"
    bad = (
        '{"damper.parameters": {"c_a": 0.0, "c_b": 0.0, "alpha_a": 0.0, "alpha_b": 0.0, "k0": -1.0e+7, "x0": 0.0,'
        ' "f0": 0.0, "A": 1.0, "beta": 0.0, "gamma": 0.0, "n": 1.0}}'
    )
    status, _, err = seatsim_command("run", seat_file, "--out", out, "--set", f'variants={{"a": {{}}, "b": {bad}}}')
    assert status == 1
    assert "failed: seat (b)" in err
    assert len(pd.read_csv(out / "summary.csv")) == 1
    assert "1 of 2 runs failed: seat (b)" in (out / "report.html").read_text(encoding="utf-8")


def test_compare_puts_several_files_in_one_table(seat_file, undrawn, seatsim_command):
    other = seat_file.with_name("other.yaml")
    other.write_text(seat_file.read_text().replace("EM5", "EM6"))
    out = seat_file.parent / "results"
    assert seatsim_command("compare", seat_file, other, "--out", out)[0] == 0
    assert list(pd.read_csv(out / "summary.csv").scenario) == ["seat", "other"]


def test_run_gives_each_of_several_files_a_folder(seat_file, undrawn, seatsim_command):
    other = seat_file.with_name("other.yaml")
    other.write_text(seat_file.read_text())
    out = seat_file.parent / "results"
    assert seatsim_command("run", seat_file, other, "--out", out)[0] == 0
    assert sorted(path.name for path in out.iterdir()) == ["other", "seat"]


def test_describe_names_every_key_with_its_unit(seatsim_command):
    assert "bouc_wen" in seatsim_command("describe")[1]
    assert "frame_mass [kg]" in seatsim_command("describe", "plant")[1]


def test_two_files_never_write_to_one_folder(seat_file, seatsim_command):
    other = seat_file.parent / "other" / seat_file.name
    other.parent.mkdir()
    other.write_text(seat_file.read_text())
    out = seat_file.parent / "results"
    status, _, err = seatsim_command("run", seat_file, other, "--out", out)
    assert status == 2 and "would write to" in err
    assert not out.exists()


def test_names_are_shown_as_they_are_written(seat_file, undrawn, seatsim_command):
    out = seat_file.parent / "results"
    name = 'name="a[b] [x]"'
    assert "a[b] [x]" in seatsim_command("run", seat_file, "--out", out, "--set", name)[1]
