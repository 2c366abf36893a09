"""Recordings of rigs whose effects are withheld: made, sealed and scored.

The makers (`rig`, `truths_*`, `draw`, `make`) share no code with the candidate effects or the damper models: they are a
second, independent writing of the physics, with other functional forms, another integrator and a finer step.
"""
