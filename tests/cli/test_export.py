"""The command that exports: one file, or one clear sentence and nothing."""

import pytest


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--to", "fmu4", "--what", "damper", "--out", "x.fmu"), "no such export (did you mean"),
        (("--to", "c", "--what", "dampr", "--out", "x.c"), "did you mean 'damper'"),
        (("--to", "c", "--what", "damper", "--out", "."), "this is a folder"),
        (("--to", "c", "--what", "damper", "--out", "/proc/none/x.c"), "cannot be written"),
    ],
)
def test_a_wrong_word_is_refused_and_nothing_is_written(
    seatsim_command, kept_seat_file, arguments, said, tmp_path, here
):
    status, _, err = seatsim_command("export", kept_seat_file, *arguments)
    assert status == 2 and said in err
    assert list(tmp_path.iterdir()) == []


def test_a_law_without_counterpart_is_named_and_nothing_is_written(seatsim_command, tmp_path):
    out = tmp_path / "controller.c"
    options = ("--to", "c", "--what", "controller", "--out", out, "--set", "controller={law: mpc}")
    status, _, err = seatsim_command("export", "quickstart", *options)
    assert status == 2 and "controllers.laws.model_predictive.ask_planner" in err
    assert list(tmp_path.iterdir()) == []


def test_of_several_runs_the_first_is_exported(seatsim_command, tmp_path):
    out = tmp_path / "here" / "damper.mat"
    status, said, err = seatsim_command("export", "quickstart", "--to", "mat", "--what", "damper", "--out", out)
    assert status == 0 and out.is_file()
    assert "holds 24 runs; the first is exported: quickstart (H-infinity, spectral_class EM2" in err
    assert "--variant takes another one: H-infinity; " in err
    assert f"written: {out}" in said


def test_a_variant_is_chosen_by_its_name(seatsim_command, tmp_path):
    out = tmp_path / "controller.c"
    words = ("export", "laws", "--to", "c", "--what", "controller", "--out", out)
    status, _, err = seatsim_command(*words, "--variant", "LQR")
    assert status == 0 and "runs" not in err
    assert "control law Lqr" in out.read_text()
    status, _, err = seatsim_command(*words, "--variant", "skyhok")
    assert status == 2 and "(did you mean 'skyhook'?); its variants: passive, 0 A; passive, 1 A;" in err
