"""Recordings beside their nominal scenarios, as the tests of the diagnosis pose them."""

from concurrent.futures import ThreadPoolExecutor

from seatsim.diagnosis.problem import pose_problem
from seatsim.diagnosis.solve import solve
from seatsim.recordings.recording import load_recording

POOL = ThreadPoolExecutor(2)


def pose(folder):
    return pose_problem(load_recording(folder), POOL)


def solved(problem, without=()):
    return solve(problem, without, lambda _: None)
