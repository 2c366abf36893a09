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
    looks = [each._replace(mark=".", width=1.6) for each in style.make_entries(list(found.damping))]
    note = "Sines from half to twice the resonance."
    figure, [[axes]] = style.make_page(
        "Damping test: motion of the mass over that of the floor", note, Grid((2.6,)), looks
    )
    for look, test in zip(looks, found.damping.values(), strict=True):
        style.draw_line(axes, test.frequencies, test.transmissibilities, look)
    axes.set_ylim(bottom=0.0)
    axes.set(xlabel="frequency [Hz]", ylabel="transmissibility [-]")
    return {"damping": style.name_coincident(figure)}
