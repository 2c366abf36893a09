"""Where the search sets out from: which gains, in which sizes, in which order."""

from itertools import islice

import numpy as np
from scipy.linalg import solve_continuous_are

from controllers.synthesis.descent import generate_starting_gains, project_state_feedback

UNIT = np.full((2, 2), 8.0)


def test_the_same_seed_gives_the_same_starts_within_the_structure(random_plant):
    plant = random_plant(0, structure=[[1, 0], [1, 1]])
    first, second, other = (list(islice(generate_starting_gains([plant], UNIT, seed), 9)) for seed in (5, 5, 6))
    np.testing.assert_array_equal(first, second)
    assert not np.array_equal(first, other)
    assert not np.any(np.array(first)[:, 0, 0, 1])


def test_state_feedback_is_that_of_the_riccati_equation_where_the_state_is_measured(random_plant):
    plant = random_plant(1, n=3, ny=3)
    P = solve_continuous_are(plant.A, plant.B2, np.eye(3), np.eye(2))
    np.testing.assert_allclose(project_state_feedback(plant) @ plant.C2, -plant.B2.T @ P, rtol=1e-9)
    assert plant.close(project_state_feedback(plant)).abscissa < 0


def test_state_feedback_keeps_to_the_structure_and_needs_a_solution(random_plant):
    gain = project_state_feedback(random_plant(1, structure=[[1, 0], [1, 1]]))
    assert gain[0, 1] == 0.0 and gain[1, 0] != 0.0
    plant = random_plant(1)
    hopeless = type(plant)(np.eye(4), plant.B1, 0 * plant.B2, plant.C1, plant.C2, plant.D11, plant.D12, plant.D21)
    assert project_state_feedback(hopeless) is None
