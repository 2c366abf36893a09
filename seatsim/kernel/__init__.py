"""The compiled time loop, and the damper bench: they know no model by name."""
