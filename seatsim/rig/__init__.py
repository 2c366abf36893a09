"""The parts of the rig that are not pluggable: plant, coil, sensors, temperature, and what a control law sees.

Records and their equations only; what a user may replace by a model of his own has a package of its own.
"""
