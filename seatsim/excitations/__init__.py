"""Excitations of the floor: random roads, machine spectra, tones, bumps and measured tables."""
