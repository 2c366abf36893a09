"""Characterisation: what a bench shows of a damper before anything is modelled.

Here belong loops and energy of a cycle, asymmetry, offset, and response times to steps of current, of records or of a
model on the same bench. Fitting a model to records (`seatsim.identification`) and drawing (`seatsim.plots`) do not.
"""
