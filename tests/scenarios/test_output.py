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
    assert "failed: seat (b): no solution beyond" in err
    assert len(pd.read_csv(out / "summary.csv")) == 1
    assert "1 of 2 runs failed: seat (b)" in (out / "report.html").read_text(encoding="utf-8")


def test_several_files_are_one_table_or_a_folder_each_under_their_names_as_written(seat_file, undrawn, seatsim_command):
    other, out = seat_file.with_name("other.yaml"), seat_file.parent / "results"
    other.write_text('name: "a[b] [x]"\n' + seat_file.read_text())
    short = ("--set", "excitation.duration=2", "--out")
    status, printed, _ = seatsim_command("compare", seat_file, other, *short, out / "table")
    assert status == 0 and "a[b] [x]" in printed
    assert list(pd.read_csv(out / "table" / "summary.csv").scenario) == ["seat", "a[b] [x]"]
    assert seatsim_command("run", seat_file, other, *short, out / "each")[0] == 0
    assert sorted(path.name for path in (out / "each").iterdir()) == ["other", "seat"]


def test_two_files_never_write_to_one_folder(seat_file, seatsim_command):
    other = seat_file.parent / "other" / seat_file.name
    other.parent.mkdir()
    other.write_text(seat_file.read_text())
    out = seat_file.parent / "results"
    status, _, err = seatsim_command("run", seat_file, other, "--out", out)
    assert status == 2 and "would write to" in err
    assert not out.exists()
