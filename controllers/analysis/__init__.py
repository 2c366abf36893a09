"""Stability of a designed loop: margins with the coil's lag, poles and delay margin as it is sampled.

Loops are analysed here, not designed: nothing in this package chooses a gain or is asked during a run.
"""
