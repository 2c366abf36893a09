"""The fixed parts of the rig: plant, coil, sensors, temperature, and the measurements of a control law.

Records and their equations only; parts that a user may replace by another model have packages of their own.
"""
