"""Pictures; the only part of seatsim that imports matplotlib. What is drawn is computed elsewhere.

Figures are built through matplotlib's objects, without pyplot and without global state, so threads may draw.
Equal results give equal bytes where a figure is saved with `metadata={"Software": "seatsim"}`.
"""
