"""Names and numbers of a history's columns belong together."""

from seatsim.kernel import channels

PARTS = {
    "acceleration": ("floor", "frame", "driver"), "displacement": ("suspension", "cushion"),
    "velocity": ("suspension", "cushion"), "energy": ("floor", "damper", "suspension", "cushion"),
}  # fmt: skip


def test_every_name_has_its_number():
    for index, name in enumerate(channels.CHANNELS):
        assert getattr(channels, name.upper()) == index, name
    assert len(set(channels.CHANNELS)) == len(channels.CHANNELS) == 17


def test_every_quantity_of_a_run_is_a_column():
    energies = {f"energy_{part}" for part in PARTS["energy"]}
    motion = {f"{part}_{kind}" for kind in ("acceleration", "displacement", "velocity") for part in PARTS[kind]}
    control = {"damper_force", "wanted_force", "force_served", "coil_current", "current_command", "damper_temperature"}
    assert set(channels.CHANNELS) == energies | motion | control
