"""Dampers that come as functional mock-up units (FMI 2 and 3): read with suspicion, stepped through FMPy."""
