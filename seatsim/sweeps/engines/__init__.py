"""Engines of a sweep: what carries out its runs. Each gives the same outcomes, in any order.

Here belongs where and how many runs are simulated at once; not what a run is, nor how its row is kept.
"""
