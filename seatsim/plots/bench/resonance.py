"""The damping test of a seat: its transmissibility for sines about the resonance."""

from __future__ import annotations

from matplotlib.figure import Figure

from seatsim.plots import style
from seatsim.plots.style import Grid
from seatsim.standards.seat_rows import SeatTest


def plot_damping(found: SeatTest) -> dict[str, Figure]:
    """Return the transmissibility of the mass on the seat over the floor, where it was tested."""
    if not found.damping:
        return {}
    looks = style.make_entries(list(found.damping))
    note = "Mass on the seat over floor, for sines from half to twice the resonance."
    page = style.make_page("Transmissibility", note, Grid((2.6,)), looks)
    axes = page.rows[0][0]
    for look, test in zip(looks, found.damping.values(), strict=True):
        style.draw_line(axes, test.frequencies, test.transmissibilities, look._replace(mark=".", width=1.6))
    axes.set_ylim(bottom=0.0)
    axes.set_xlabel("frequency [Hz]")
    axes.set_ylabel("transmissibility [-]")
    return {"damping": page.figure}
