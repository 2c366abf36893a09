"""The open reference for semi-active seat suspensions.

Three name spaces are for users:

    seatsim                                   what the commands do: run, compare, sweep, gap, diagnose, identify, ...
    controllers                               design of control laws: synthesise
    seatsim.dampers, seatsim.effects,
    seatsim.laws                              what the writer of a damper, an effect or a control law needs

`docs/python.md` shows an example of each task. A name is imported when it is first asked for, from where
`__init__.pyi` says.
"""

from importlib import import_module

with open(f"{__path__[0]}/__init__.pyi", encoding="utf-8") as _stub:
    # `from HOME import OWN as NAME`, for type checkers too
    _HOME = {words[5]: (words[1], words[3]) for words in map(str.split, _stub) if words[4:5] == ["as"]}
__all__ = sorted(_HOME)  # noqa: PLE0605  # the names of the stub, stated once


def __getattr__(name: str) -> object:
    """Import a public name when it is first asked for."""
    if name == "__version__":
        return import_module("importlib.metadata").version("seatsim")
    if name not in _HOME:
        raise AttributeError(f"module 'seatsim' has no attribute '{name}'")
    home, own = _HOME[name]
    return getattr(import_module(home), own)


def __dir__() -> list[str]:
    """List the public names."""
    return __all__
