"""Figures of simulated runs: histories, spectra, damper loops, comparisons; not of recordings or benches."""
