"""Figures of dampers on a bench: characterisation and identification."""
