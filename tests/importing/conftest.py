from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from ..text import parse

RECORDING = Path(__file__).resolve().parents[2] / "scenarios" / "data" / "recording"


@pytest.fixture(scope="session")
def seat_table():
    """Return the channels of a recorded seat, with the time, by name."""
    frame = pd.read_csv(RECORDING / "run-1.csv.gz")
    return {name: frame[name].to_numpy() for name in frame}


@pytest.fixture(scope="session")
def noisy_table(seat_table):
    """Return the same with the noise of sensors on every measured channel."""
    generator = np.random.default_rng(5)
    noise = parse("""
        {floor_acceleration: 0.01, frame_acceleration: 0.03, driver_acceleration: 0.015,
         suspension_displacement: 5e-05, damper_force: 2.5, coil_current: 0.003}
    """)
    return {
        name: values + noise.get(name, 0.0) * generator.standard_normal(len(values))
        for name, values in seat_table.items()
    }


@pytest.fixture(scope="session")
def nominal():
    """Return the nominal scenario of the recorded seat."""
    return str(RECORDING / "nominal.yaml")
