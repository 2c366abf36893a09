"""Figures of results; the only package that imports matplotlib. What is drawn is computed elsewhere.

`runs`, `bench` and `diagnosis` hold the figures of one kind of result each and know nothing of each other. What they
share stands beside them, as `style` (page, lines, colours, texts) and `thinning` (fewer points).

Functions called `plot_...` return whole figures, `draw_...` draw into a panel. Figures are built through matplotlib's
objects, without pyplot and without global state, so threads may draw. Equal results give equal bytes where a figure is
saved with `metadata={"Software": "seatsim"}`.
"""
