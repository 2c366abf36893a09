"""Where the code of models comes from: plug-ins, installed packages, and files of the user's own that were named.

A plug-in is a module or package that an entry point of the group ``seatsim.plugins`` names; importing it and its
submodules registers its classes. Files are named on the command line or in Python, and one that nobody named is never
run, wherever it lies. A scenario or a recording from a stranger may say ``model: powerlaw:PowerLaw``; whether the
``powerlaw.py`` in its folder can be trusted is for the user to say, with ``--with powerlaw.py`` or
``seatsim.use("powerlaw.py")``. No folder is put on the import path for it.
"""

from __future__ import annotations

import importlib
import importlib.util
import os
import pkgutil
import shlex
import sys
import traceback
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from functools import cache
from importlib.machinery import ModuleSpec, SourceFileLoader
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, NoReturn, cast

from seatsim.schema.errors import InputError

if TYPE_CHECKING:
    from importlib.abc import Loader
    from importlib.metadata import EntryPoints


class MissingModuleError(InputError):
    """A module is named that is neither installed nor one of the files in use; `file` has its name, where one lies."""

    def __init__(self, problem: str, file: Path | None) -> None:
        super().__init__(problem)
        self.file = file


_SAFE_PATH = "PYTHONSAFEPATH"
_HOME = Path(__file__).resolve().parents[2]
"""The folder that seatsim lies in."""
_used: dict[str, tuple[Path, bytes]] = {}
"""What `use` has loaded, by module name, in the order in which it was named: where it lies, and its content."""


@cache
def load_plugins() -> None:
    """Import every plug-in, once."""
    for point in _plugins():
        package = import_named(point.value)
        for module in pkgutil.iter_modules(getattr(package, "__path__", ())):
            importlib.import_module(f"{point.value}.{module.name}")


@cache
def shipped_packages() -> frozenset[str]:
    """Return the top-level packages that are part of seatsim."""
    own = (point for point in _plugins() if point.dist is not None and point.dist.name == "seatsim")
    return frozenset(point.value.partition(".")[0] for point in own)


def _plugins() -> EntryPoints:
    from importlib.metadata import entry_points

    return entry_points(group="seatsim.plugins")


def use(path: str | Path) -> ModuleType:
    """Load a Python file as the module of its name, so that a scenario may say `powerlaw:PowerLaw` of `powerlaw.py`.

    A file that is in use already is loaded again only where its content has changed. Files that import one another are
    named in that order, the imported one first: the folder they lie in is not searched.

    Raises:
        InputError: there is no such file, its name is no module name or that of another module, or its import fails.
    """
    shown = Path(path)
    where, name = shown.resolve(), shown.stem
    file = (where, _read(shown))
    if _used.get(name) == file:
        return sys.modules[name]
    _check_name_is_free(name, where)
    # First, so that a name which a plug-in has is an error of the file that takes it, and not of the plug-in.
    load_plugins()
    if name in _used or name not in sys.modules:
        _load(name, shown, where)
    _used[name] = file
    return sys.modules[name]


def use_all(paths: Iterable[str | Path]) -> None:
    """Load several files in the order given; what a worker process does first with `used_files()` of its parent."""
    for path in paths:
        use(path)


def used_files() -> tuple[Path, ...]:
    """Return the files in use, in the order in which they were named."""
    return tuple(path for path, _ in _used.values())


def import_named(name: str, beside: Path | None = None) -> ModuleType:
    """Return a module that a scenario names: a file in use, a module that is imported already, or an installed one.

    `beside` is the folder of the file that names it; nothing is run from there.

    Raises:
        InputError: there is no such module (`MissingModuleError`), or its import fails.
    """
    top, *below = name.split(".")
    # Importing `antigravity` opens a browser, `pip.__main__` starts a program.
    if name not in sys.modules and top not in _used and (top in sys.stdlib_module_names or "__main__" in below):
        raise InputError(f"module '{name}' is part of Python or a program; permitted: the module of a class of seatsim")
    try:
        if top not in sys.modules:
            _import_installed(top)
        return importlib.import_module(name)
    except ImportError as error:
        if isinstance(error.__cause__, KeyboardInterrupt):  # modules in C++ make such an error of it
            raise KeyboardInterrupt from error
        is_named = isinstance(error, ModuleNotFoundError) and error.name is not None
        if is_named and f"{name}.".startswith(f"{error.name}."):
            raise _missing(name, beside) from error
        raise InputError(f"module '{name}' cannot be imported: {error}") from error


@contextmanager
def started_elsewhere() -> Iterator[None]:
    """Let Python processes that are started meanwhile not search the current folder for modules.

    The child of a spawn is started with `python -c`, which searches it first, even for modules of Python itself.
    """
    previous = os.environ.get(_SAFE_PATH)
    os.environ[_SAFE_PATH] = "1"
    try:
        yield
    finally:
        del os.environ[_SAFE_PATH]
        if previous is not None:
            os.environ[_SAFE_PATH] = previous


def _read(path: Path) -> bytes:
    """Return the content of a Python file whose name can be that of a module."""
    if path.suffix != ".py" or not path.stem.isidentifier():
        raise InputError(
            f"{path}: not a Python file that can be imported; its name has letters, digits and _, then .py"
        )
    try:
        return path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}; give the path of a Python file") from error


def _check_name_is_free(name: str, path: Path) -> None:
    """Raise InputError where the name is that of another module: one of the two would be taken for the other."""
    spec = None if name in sys.modules else _find_installed(name)
    origin = spec.origin if spec else getattr(sys.modules.get(name), "__file__", None)
    if (spec or name in sys.modules) and (origin is None or Path(origin).resolve() != path):
        raise InputError(f"{path}: '{name}' is the name of another module, {origin or 'built in'}; rename the file")


class _FreshLoader(SourceFileLoader):
    """Compiles a file whenever it is loaded: an edit may keep its second and size, by which Python tells bytecode."""

    def path_stats(self, path: str) -> NoReturn:
        """Say that the file has no time, so that no bytecode is looked for or kept."""
        raise OSError


def _load(name: str, shown: Path, path: Path) -> None:
    """Execute a file as a new module; the one that it replaces stays where that fails."""
    # A .py file always has one. An `assert` here, which pytest rewrites, would change the key of what is compiled.
    spec = cast("ModuleSpec", importlib.util.spec_from_file_location(name, path, loader=_FreshLoader(name, str(path))))
    previous = sys.modules.get(name)
    try:
        _execute(spec)
    except Exception as error:
        if previous is not None:
            sys.modules[name] = previous
        raise InputError(_failure(error, shown, path)) from error


def _import_installed(name: str) -> None:
    """Import a top-level module that is installed, and not one of its name in the current folder."""
    spec = _find_installed(name) if name.isidentifier() else None
    if spec is None:
        raise ModuleNotFoundError(f"No module named '{name}'", name=name)
    _execute(spec)


def _execute(spec: ModuleSpec) -> None:
    module = importlib.util.module_from_spec(spec)
    # Before its execution, because the decorators and numba look a class up by the name of its module.
    sys.modules[spec.name] = module
    try:
        cast("Loader", spec.loader).exec_module(module)  # `module_from_spec` has asked for it
    except BaseException:
        del sys.modules[spec.name]
        raise


def _find_installed(name: str) -> ModuleSpec | None:
    """Return where a top-level module is installed: anywhere but in the folder that Python was started in.

    `python -m`, `python -c` and notebooks put the current folder on the import path, a script puts its own first: what
    lies there was not named by anyone.
    """
    script = getattr(sys.modules["__main__"], "__file__", None)
    # The folder that this package itself was imported from is one that was chosen, wherever Python was started.
    started = ({_folder("")} | ({Path(script).resolve().parent} if script else set())) - {_HOME}
    first_is_start = bool(sys.path) and not sys.flags.safe_path and _folder(sys.path[0]) in started
    path = [entry for entry in sys.path[1 if first_is_start else 0 :] if entry not in ("", ".")]
    # All finders: packages that are installed to be edited lie on no path, and have one of their own.
    found = (finder.find_spec(name, path) for finder in sys.meta_path)
    return next((spec for spec in found if spec is not None), None)


def _failure(error: Exception, shown: Path, path: Path) -> str:
    """Say in which line of the file its import failed, and how a module in its folder is named."""
    frames = traceback.extract_tb(error.__traceback__)
    lines = [(frame.lineno, frame.line) for frame in frames if frame.filename == str(path)]
    if isinstance(error, SyntaxError) and error.filename == str(path):
        lines = [(error.lineno, (error.text or "").strip())]
    place = f"{shown}, line {lines[-1][0]} ({lines[-1][1]})" if lines else str(shown)
    missing = f"{error.name}.py" if isinstance(error, ModuleNotFoundError) else ""
    beside = bool(missing) and path.with_name(missing).is_file()
    hint = f"; name {missing} before it: --with {shlex.quote(str(shown.with_name(missing)))}" if beside else ""
    return f"{place}: cannot be imported: {type(error).__name__}: {error}{hint}"


def _folder(entry: str) -> Path:
    return Path(entry or ".").resolve()


def _missing(name: str, beside: Path | None) -> MissingModuleError:
    """Return the error of a module that is not there, with the option that names its file, where one is found."""
    problem = f"no module '{name}' is installed"
    if "." in name:
        return MissingModuleError(f"{problem}; install the package that has it", None)
    candidates = [folder / f"{name}.py" for folder in (beside, Path()) if folder is not None]
    file = next((path for path in candidates if path.is_file()), None)
    if file is None:
        how = f"--with {name}.py, in Python seatsim.use('{name}.py')"
        return MissingModuleError(f"{problem}; name its file: {how}", None)
    how = f"--with {shlex.quote(str(file))}, in Python seatsim.use({str(file)!r})"
    return MissingModuleError(f"{problem}, and {file} runs only where it is named: {how}", file)
