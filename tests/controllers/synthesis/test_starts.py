"""Where the search sets out from: which gains, in which sizes, in which order."""

import numpy as np
from scipy.linalg import solve_continuous_are

from controllers.synthesis.descent import project_state_feedback


def test_state_feedback_is_that_of_the_riccati_equation_where_the_state_is_measured(random_plant):
    plant = random_plant(1, n=3, ny=3)
    P = solve_continuous_are(plant.A, plant.B2, np.eye(3), np.eye(2))
    np.testing.assert_allclose(project_state_feedback(plant) @ plant.C2, -plant.B2.T @ P, rtol=1e-9)
    assert plant.close(project_state_feedback(plant)).abscissa < 0
