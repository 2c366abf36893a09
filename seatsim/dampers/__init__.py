"""Damper models: one file per family, each with its equation, its parameters and their source."""
