"""The committed C++ derivatives are what the Python models say today."""

import functools
import importlib.util
import re
import sys
from pathlib import Path

import casadi as ca
import pytest

CPP = Path(__file__).parents[2] / "cpp"


@functools.cache
def generator():
    specification = importlib.util.spec_from_file_location("generate_models", CPP / "generate_models.py")
    module = importlib.util.module_from_spec(specification)
    sys.modules[specification.name] = module
    specification.loader.exec_module(module)
    return module


@pytest.mark.parametrize("make", generator().MODELS)
def test_headers_are_up_to_date(make):
    module, model = generator(), make()
    committed = (module.FOLDER / module.file_name(model)).read_text(encoding="utf-8")
    version = re.search(r"with CasADi (\S+);", committed)
    assert version is not None
    if version[1] != ca.__version__:
        pytest.skip(f"written with CasADi {version[1]}, which orders operations in its own way")
    assert module.header(model) == committed, "run `python cpp/generate_models.py`"
