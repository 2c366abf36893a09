"""Control laws for semi-active seats, and the synthesis of H-infinity static output feedback."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from controllers.synthesis import Design, GeneralisedPlant, synthesise

__all__ = ["Design", "GeneralisedPlant", "synthesise"]


def __getattr__(name: str) -> Any:
    """Import the synthesis when it is first asked for: a run with a stated gain does not need it."""
    if name not in __all__:
        raise AttributeError(f"module 'controllers' has no attribute '{name}'")
    from controllers import synthesis

    return getattr(synthesis, name)
