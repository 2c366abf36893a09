"""Names of others on a terminal and in tables for a spreadsheet."""

import pytest

from seatsim.schema.text import disarm, make_printable, shorten_paths


@pytest.mark.parametrize("cell", ['=HYPERLINK("http://x")', "+cmd|' /C calc'!A0", "-2+3", "@SUM(A1)", "\t=1", "=1"])
def test_a_text_that_a_spreadsheet_computes_is_disarmed(cell):
    assert disarm(cell) == f"'{cell}"


@pytest.mark.parametrize("cell", ["-10 degC", "-1.5", "+3 mm", "rough track", "", 3, -2.5, None])
def test_other_cells_stay_as_they_are(cell):
    assert disarm(cell) is cell


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("a\x1b[2Jb", "a\\x1b[2Jb"), ("a\u202egnp.exe", "a\\u202egnp.exe"), ("bell\x07", "bell\\x07"),
        ("\udc80", "\\udc80"), ("Dämpferkraft [N] :smile:\n", "Dämpferkraft [N] :smile:\n"),
    ],
)  # fmt: skip
def test_a_terminal_obeys_no_sign_of_a_text(text, shown):
    assert make_printable(text) == shown


def test_a_path_is_as_short_as_tells_it_from_others():
    paths = [("data", "rig-1", "sine"), ("data", "rig-2", "sine"), ("data", "rig-2", "chirp"), ("old", "rig-1", "sine")]
    assert shorten_paths(paths) == ["data/rig-1/sine", "rig-2/sine", "chirp", "old/rig-1/sine"]
    assert shorten_paths([("a", "sine"), ("a", "sine"), ("sine",)]) == ["a/sine", "a/sine", "sine"]
