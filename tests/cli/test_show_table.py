"""Tables on a terminal and in a pipe: names stay whole."""

import io

import pytest
from rich.console import Console
from rich.table import Table

from seatsim.cli import show_table as module
from seatsim.cli import terminal

NAMES = ("a scenario with a long name", "H-infinity output feedback")


@pytest.fixture
def table():
    made = Table(title="comfort \\[-]")
    made.add_column("scenario")
    made.add_column("variant")
    for k in range(6):
        made.add_column(f"figure\n{k}\n\\[m/s²]", justify="right", no_wrap=True)
    made.add_row(*NAMES, *(f"[bold]{k}.123[/]" for k in range(6)))
    made.add_section()
    made.add_row("b", "passive", *("-" for _ in range(6)))
    return made


@pytest.fixture
def show(monkeypatch):
    """Show a table on a terminal of some letters, or in a pipe."""

    def shown(table, width=None):
        console = Console(file=io.StringIO(), force_terminal=width is not None, width=width or 80, color_system=None)
        monkeypatch.setattr(module, "out", console)
        monkeypatch.setattr(terminal, "out", console)
        module.show_table(table)
        return console.file.getvalue()

    return shown


def test_a_pipe_gets_plain_aligned_text(table, show):
    title, head, *rows = show(table).splitlines()
    assert title == "comfort [-]"
    assert head.split() == ["scenario", "variant", *(part for k in range(6) for part in ("figure", str(k), "[m/s²]"))]
    assert rows[0].startswith(f"{NAMES[0]}  {NAMES[1]}  ") and "\x1b" not in head
    ends = [head.index("[m/s²]", start) + 6 for start in range(len(head)) if head.startswith("figure", start)]
    assert all(rows[0][end - 5 : end].endswith(".123") and rows[1][end - 1] == "-" for end in ends)


@pytest.mark.parametrize("width", [40, 60, 75])
def test_a_narrow_terminal_loses_figures_and_says_which_but_no_name(table, show, width):
    said = show(table, width)
    shown, _, note = said.partition("left out, as the terminal is narrow: ")
    assert max(map(len, shown.splitlines())) <= width
    letters = "".join(shown.split())
    assert all(word in letters for name in NAMES for word in name.split())
    assert note.strip().endswith("figure 5 [m/s²]") and "5.123" not in shown
