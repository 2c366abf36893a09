"""What comes out of a run: comfort, motion, force and energy as single figures, and the spectra behind them.

Everything here is a function of sampled signals in SI units: no scenario, no simulation, no file is known.
"""
