"""Localisation: which block of the rig an unexplained remainder lies in, and what its signal depends on.

What the library's effects explain is decided in `select` and `decide`.
"""
