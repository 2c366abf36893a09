"""What problems of both toys are built with."""

from concurrent.futures import Executor, Future

import numpy as np

from seatsim.diagnosis.fit import fit
from seatsim.diagnosis.noise import weigh_uniformly
from seatsim.diagnosis.objective import Objective, Parameters


class SerialExecutor(Executor):
    """Does everything at once, in the caller's thread."""

    def submit(self, function, /, *args, **keywords):
        future = Future()
        future.set_result(function(*args, **keywords))
        return future


def weigh_stated(problem):
    """Return an objective that weighs by the stated white noise alone."""
    return Objective(problem, weigh_uniformly(problem, problem.noise**2))


def place(problem, *terms, deviations=None):
    """Return parameters with candidates, each given as (candidate, values)."""
    parameters = Parameters(problem.nominal if deviations is None else np.asarray(deviations, dtype=float))
    for candidate, *values in terms:
        parameters = parameters.add(candidate, np.array(values, dtype=float))
    return parameters


def refit(objective, parameters):
    """Return the evaluation at the end of a fit from some parameters, linearised there."""
    start = objective.evaluate([parameters])[0]
    return fit(objective, start, objective.linearise_nuisances(start))
