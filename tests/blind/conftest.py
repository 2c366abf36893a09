import pytest

from seatsim.blind.make import draw_experiment


@pytest.fixture(scope="package", autouse=True)
def short():
    """Runs of a few seconds."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(draw_experiment, "SECONDS", 2.6)
        patch.setattr(draw_experiment, "UNSEEN_SECONDS", 2.6)
        yield
