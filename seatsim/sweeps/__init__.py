"""Sweeps and Monte Carlo: one scenario with many values of its keys, simulated on threads or a cluster, and resumable.

Here belongs what a sweep file states, how it becomes numbered runs, how these are carried out and kept, and what their
metrics say. Not here: how one run is simulated (`seatsim.simulation`), pictures and pages (`seatsim.plots`,
`seatsim.report`), the command line.
"""
