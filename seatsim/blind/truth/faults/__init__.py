"""Fault scenarios: which parameters of the true rig depart from nominal, how that is drawn, how strong it can be.

No equation of motion: those are in `physics`.
"""
