"""Force-velocity and force-displacement loops of a characterisation, and the clouds of records without cycles."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from seatsim.characterisation.rows import Row
from seatsim.characterisation.summary import Characterisation
from seatsim.plots import style
from seatsim.plots.bench.families import find_families, group_clouds, measure_legend
from seatsim.plots.labels import clean_text
from seatsim.plots.style import Entry, Grid

DOTS = 2000


def plot_loops(found: Characterisation) -> Figure:
    """Return the loops by current for each amplitude and frequency, by temperature where it varies, and clouds."""
    families, left_out = find_families(found.rows)
    clouds = group_clouds(found.rows)
    note = "Mean of the steady cycles." if found.measured else "Last cycle of a sine test."
    note = note if families else "Records without steady cycles."
    note += f" {left_out} further settings are not shown." if left_out else ""
    heights = (1.9,) * (len(families) + len(clouds))
    grid = Grid(heights, columns=2, right=measure_legend(families), top=0.3, gap=(0.2, 0.85))
    page = style.make_page(f"Loops: {found.name}", note, grid)
    for panels, family in zip(page.rows, families, strict=False):
        for row, name, colour in zip(family.rows, family.names, family.colours, strict=True):
            if row.loop is not None:
                look = Entry(name, colour, width=1.5)
                middle = 0.5 * (np.max(row.loop.displacement) + np.min(row.loop.displacement))
                style.draw_line(panels[0], row.loop.velocity, row.loop.force, look)
                style.draw_line(panels[1], 1e3 * (row.loop.displacement - middle), row.loop.force, look)
        _label_panels(panels, family.title, "from mid-stroke [mm]")
        style.draw_legend_beside(panels[1], family.legend)
    for panels, group in zip(page.rows[len(families) :], clouds, strict=True):
        _draw_clouds(panels, group)
    return page.figure


def _label_panels(panels: Sequence[Axes], title: str, displacement: str) -> None:
    panels[0].set_title(clean_text(title, 60), loc="left", fontsize=style.FONT)
    panels[0].set_xlabel("velocity [m/s]")
    panels[1].set_xlabel(displacement)
    panels[0].set_ylabel("damper force [N]")
    panels[1].set_ylim(panels[0].get_ylim())
    panels[1].tick_params(labelleft=False)


def _draw_clouds(panels: Sequence[Axes], group: Sequence[Row]) -> None:
    """Draw samples of records without cycles, coloured by current; with a bar of colours where a current varies."""
    most = max(float(np.percentile(row.cloud.current, 99)) for row in group if row.cloud is not None)
    # As in `style.sample_colours`, the light end of the map is left out.
    norm = Normalize(0.0, max(most, 1e-9) / 0.85)
    switched = False
    # The largest current first: its cloud is the widest and would cover the others.
    for row in sorted(group, key=lambda row: -row.current):
        if row.cloud is None:
            continue
        x, v, force, current = (values[:: max(1, len(row.cloud.force) // DOTS)] for values in row.cloud)
        switched |= float(np.ptp(current)) > 0.05 * most
        for axes, across in ((panels[0], v), (panels[1], 1e3 * x)):
            dots = axes.scatter(
                across, force, c=current, s=5, alpha=0.6, label=f"{row.current:.3g} A", cmap=colormaps["viridis"],
                norm=norm, linewidths=0, rasterized=True,
            )  # fmt: skip
    names = list(dict.fromkeys(row.record.split(",")[0] for row in group))
    title = names[0] if len(names) == 1 else f"{names[0]} and {len(names) - 1} more"
    _label_panels(panels, f"{title}, not cyclic", "displacement [mm]")
    if switched:
        beside = style.add_axes_beside(panels[1], 0.02, 0.02)
        bar = panels[1].figure.colorbar(dots, cax=beside, label="current [A]")
        if bar.solids is not None:
            bar.solids.set_alpha(1.0)
        beside.set_ylim(0.0, most)
    elif len(group) > 1:
        legend = style.draw_legend_beside(panels[1], "current")
        for handle in legend.legend_handles:
            if handle is not None:
                handle.set_alpha(1.0)
