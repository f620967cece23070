"""The compiled core, or one clear sentence if it was not built."""

from __future__ import annotations

from types import ModuleType

from tightspot.errors import BuildError


def compiled_core() -> ModuleType:
    """The module ``tightspot._core``, whose types are in ``_core.pyi``.

    Raises:
        BuildError: It is missing or was built for another Python.
    """
    try:
        from tightspot import _core
    except ImportError as error:
        raise BuildError(
            f"tightspot's compiled core cannot be loaded ({error}); install a C++17 compiler, e.g. "
            "`apt install g++`, and install tightspot again with `pip install .` in its folder"
        ) from None
    return _core
