"""Where the search sets out from: which gains, in which sizes, in which order."""

from itertools import islice

import numpy as np
from scipy.linalg import solve_continuous_are

from controllers.synthesis.starts import generate_starting_gains, project_state_feedback

UNIT = np.full((2, 2), 8.0)


def test_the_same_seed_gives_the_same_starts_within_the_structure(random_plant):
    plant = random_plant(0, structure=[[1, 0], [1, 1]])
    first, second, other = (list(islice(generate_starting_gains([plant], UNIT, seed), 9)) for seed in (5, 5, 6))
    np.testing.assert_array_equal(first, second)
    assert not np.array_equal(first, other)
    assert not np.any(np.array(first)[:, 0, 0, 1])


def test_no_gain_then_state_feedback_then_gains_over_decades(random_plant):
    plants = [random_plant(0), random_plant(1)]
    starts = list(islice(generate_starting_gains(plants, UNIT, 1), 15))
    np.testing.assert_array_equal(starts[0], [np.zeros((2, 2)), UNIT])
    for start, plant in zip(starts[1:3], plants, strict=True):
        np.testing.assert_array_equal(start, [project_state_feedback(plant), np.ones((2, 2))])
    for k, (own, scaled) in enumerate([(1.0, 1.0), (10.0, 100.0), (0.1, 10.0), (100.0, 1000.0)]):
        user, plain, wide = starts[3 + 3 * k : 6 + 3 * k]
        np.testing.assert_array_equal(user.unit, own * UNIT)
        np.testing.assert_array_equal(plain.unit, scaled * np.ones((2, 2)))
        size = wide.unit / (1.0, 8.0)[k % 2]
        assert np.all((size >= 10**-1.5) & (size <= 10**1.5)) and len(np.unique(size)) == 4
        np.testing.assert_array_equal(np.abs(wide.gain), wide.unit)


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
