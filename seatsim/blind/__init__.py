"""Recordings of rigs whose effects are withheld: made, sealed and scored.

`truth` simulates reality, `make` draws cases and writes them, `score` compares verdicts with labels. `truth` and `make`
share no code with the candidate effects, the damper models or the kernel: they are a second, independent writing of the
physics, with other functional forms, another integrator and a finer step. What is diagnosed here never stands here.
"""
