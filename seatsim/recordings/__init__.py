"""What was measured: recordings of rigs and bench tables, how far a simulation is from them, and their quality.

Nothing is fitted here.
"""
