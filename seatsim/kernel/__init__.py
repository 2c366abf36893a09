"""The compiled time loop and the damper bench; neither depends on any particular model."""
