"""Measured data: recordings of rigs and bench tables, their quality, and the gap between them and a simulation.

Nothing is fitted here.
"""
