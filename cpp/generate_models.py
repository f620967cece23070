"""Writes the C++ derivatives of the vehicle models for the stagewise solver, from the models' Python text.

    python cpp/generate_models.py [FOLDER]

One header a model: the classical Runge-Kutta step (value, Jacobian, contracted Hessian) and the cover of a swept
interval (value, gradient, Hessian). CasADi differentiates; the instructions of its expressions are printed as plain
C++ here, so that the sines and cosines of a step are computed once, with its value, and handed to the derivatives.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import casadi as ca

from tightspot.transcription.integrators import rk4
from tightspot.vehicles import SingleTrack, VehicleModel

FOLDER = Path(__file__).parent / "include" / "tightspot" / "stagewise" / "generated"

_BINARY = {ca.OP_ADD: "+", ca.OP_SUB: "-", ca.OP_MUL: "*", ca.OP_DIV: "/"}
_COMMUTES = (ca.OP_ADD, ca.OP_MUL)
_SHARED = (ca.OP_SIN, ca.OP_COS)


@dataclass(frozen=True)
class Symbolic:
    """A model with symbols in place of its numbers.

    Attributes:
        name: Of the C++ structure and, in lower case with underscores, of the header.
        vehicle: The Python model, its parameters symbols.
        parameters: Column of those symbols.
        meaning: What they are, for the reader.
        tangents: Symbols that stand for the tangent of others, by those others' names.
    """

    name: str
    vehicle: VehicleModel
    parameters: Any
    meaning: str
    tangents: dict[str, Any]


class _Namespace:
    """CasADi's functions, with tan written as sin/cos, so that derivatives need no other functions."""

    sin, cos, sqrt = staticmethod(ca.sin), staticmethod(ca.cos), staticmethod(ca.sqrt)

    def __init__(self, tangents: dict[str, Any]) -> None:
        self.tangents = tangents

    def tan(self, x: Any) -> Any:
        known = self.tangents.get(str(x))
        return ca.sin(x) / ca.cos(x) if known is None else known


class _Adapted:
    """What the integrator needs of a vehicle, evaluated with our namespace."""

    def __init__(self, model: Symbolic) -> None:
        self.vehicle, self.namespace = model.vehicle, _Namespace(model.tangents)

    def dynamics(self, state: Sequence[Any], control: Sequence[Any], ns: Any) -> list[Any]:
        return self.vehicle.dynamics(state, control, self.namespace)


def single_track() -> Symbolic:
    """The kinematic single-track model with symbolic wheelbase and largest steering angle."""

    class Limits:
        steering = ca.SX.sym("steering")

    tangent, wheelbase = ca.SX.sym("tangent"), ca.SX.sym("wheelbase")
    vehicle = object.__new__(SingleTrack)
    object.__setattr__(vehicle, "wheelbase", wheelbase)
    object.__setattr__(vehicle, "limits", Limits)
    parameters = ca.vertcat(wheelbase, Limits.steering, tangent)
    meaning = "wheelbase, m; delta_max, rad; tan(delta_max)"
    return Symbolic("SingleTrack", vehicle, parameters, meaning, {"steering": tangent})


MODELS: tuple[Callable[[], Symbolic], ...] = (single_track,)


class Printer:
    """Prints functions as straight-line C++, with one numbering of values for all of them.

    Attributes:
        shared: Expressions (as value numbers) that the first function computes and the others read.
    """

    def __init__(self) -> None:
        self.numbers: dict[tuple[Any, ...], int] = {}
        self.keys: list[tuple[Any, ...]] = []
        self.shared: dict[int, int] = {}

    def number(self, *key: Any) -> int:
        """The value number of an operation on value numbers."""
        if key not in self.numbers:
            self.numbers[key] = len(self.keys)
            self.keys.append(key)
        return self.numbers[key]

    def read(self, inputs: Sequence[tuple[str, Any]], expression: Any) -> list[int]:
        """Value numbers of the entries of a dense column-major expression, -1 for structural zeros."""
        function = ca.Function("f", [symbol for _, symbol in inputs], [ca.SX(expression)], {"cse": True})
        work: dict[int, int] = {}
        entries = [-1] * ca.SX(expression).numel()
        places = ca.SX(expression).sparsity().find()
        for k in range(function.n_instructions()):
            operation, into = function.instruction_id(k), function.instruction_output(k)
            source = function.instruction_input(k)
            if operation == ca.OP_OUTPUT:
                entries[places[into[1]]] = work[source[0]]
            elif operation == ca.OP_INPUT:
                name, symbol = inputs[source[0]]
                scalar = symbol.numel() == 1 and name in ("h", "rho", "poses")
                work[into[0]] = self.number("input", name if scalar else f"{name}[{source[1]}]")
            elif operation == ca.OP_CONST:
                work[into[0]] = self.number("constant", function.instruction_constant(k))
            else:
                work[into[0]] = self._operation(operation, [work[i] for i in source])
        return entries

    def _operation(self, operation: int, arguments: list[int]) -> int:
        if operation in (ca.OP_SQ, ca.OP_TWICE):
            binary = ca.OP_MUL if operation == ca.OP_SQ else ca.OP_ADD
            return self.number(binary, arguments[0], arguments[0])
        if operation == ca.OP_INV:
            return self._reciprocal(arguments[0])
        if operation == ca.OP_DIV:
            operation, arguments = ca.OP_MUL, [arguments[0], self._reciprocal(arguments[1])]
        known = {*_BINARY, *_SHARED, ca.OP_SQRT, ca.OP_NEG}
        if operation not in known:
            raise NotImplementedError(f"CasADi operation {operation} has no C++ text here; add it to the printer")
        return self.number(operation, *(sorted(arguments) if operation in _COMMUTES else arguments))

    def _reciprocal(self, number: int) -> int:
        """Divisions are dear: one for each divisor."""
        key = self.keys[number]
        if key[0] == "constant":
            return self.number("constant", 1.0 / key[1])
        return self.number(ca.OP_DIV, self.number("constant", 1.0), number)

    def share(self, entries: Iterable[int]) -> None:
        """Sines, cosines and reciprocals among the entries' ancestors are to be computed once."""
        for number in self._ancestors(entries, stop=False):
            if self.keys[number][0] in (*_SHARED, ca.OP_DIV):
                self.shared.setdefault(number, len(self.shared))

    def _ancestors(self, entries: Iterable[int], stop: bool) -> list[int]:
        """Everything the entries depend on, in order; ``stop`` at shared values."""
        seen: set[int] = set()
        stack = [entry for entry in entries if entry >= 0]
        while stack:
            number = stack.pop()
            if number in seen:
                continue
            seen.add(number)
            key = self.keys[number]
            if key[0] not in ("input", "constant") and not (stop and number in self.shared):
                stack += key[1:]
        return sorted(seen)

    def body(self, outputs: Sequence[tuple[str, list[int]]], first: bool) -> list[str]:
        """Statements that compute the outputs; the ``first`` function fills the shared values."""
        wanted = [entry for _, entries in outputs for entry in entries]
        wanted += list(self.shared) if first else []
        lines: list[str] = []
        done: set[int] = set()
        for number in self._ancestors(wanted, stop=not first):
            if first and self.keys[number][0] in _SHARED:
                lines += self._pair(number, done)
                continue
            text = self._text(number, first)
            if text:
                lines.append(f"const P a{number} = {text};")
        for name, entries in outputs:
            lines += [f"{name}[{i}] = {self._name(entry)};" for i, entry in enumerate(entries)]
        if first:
            lines += [f"shared[{place}] = a{number};" for number, place in self.shared.items()]
        return lines

    def _pair(self, number: int, done: set[int]) -> list[str]:
        """Sine and cosine of one angle, together, unless they are there already."""
        angle = self.keys[number][1]
        if angle in done:
            return []
        done.add(angle)
        sine, cosine = self.number(ca.OP_SIN, angle), self.number(ca.OP_COS, angle)
        call = f"sine_cosine({self._name(angle)}, a{sine}, a{cosine});"
        return [f"P a{sine}, a{cosine};", call]

    def _name(self, number: int) -> str:
        if number < 0:
            return "0.0"
        key = self.keys[number]
        if key[0] == "constant":
            return repr(float(key[1])) if key[1] >= 0 else f"({float(key[1])!r})"
        return str(key[1]) if key[0] == "input" else f"a{number}"

    def _text(self, number: int, first: bool) -> str:
        key = self.keys[number]
        if key[0] in ("input", "constant"):
            return ""
        if not first and number in self.shared:
            return f"shared[{self.shared[number]}]"
        names = [self._name(argument) for argument in key[1:]]
        if key[0] in _BINARY:
            return f"{names[0]} {_BINARY[key[0]]} {names[1]}"
        if key[0] == ca.OP_NEG:
            return f"-{names[0]}"
        return f"square_root({names[0]})"


def _step(model: Symbolic) -> tuple[list[str], int]:
    """Text of the Runge-Kutta step's three functions, and the number of shared values."""
    nx, nu = model.vehicle.n_states, model.vehicle.n_inputs
    x, h, u, multipliers = ca.SX.sym("x", nx), ca.SX.sym("h"), ca.SX.sym("u", nu), ca.SX.sym("lam", nx)
    after = rk4(_Adapted(model), x, u, h, 1)
    inner = ca.vertcat(x[2:], h, u)
    jacobian = ca.jacobian(after, inner)
    if ca.jacobian(after, x[:2]).sparsity() != ca.DM.eye(nx)[:, :2].sparsity():
        raise ValueError(f"{model.name}: the dynamics must not depend on the position (x, y)")
    hessian = ca.hessian(ca.dot(multipliers, after), inner)[0]
    printer = Printer()
    inputs = [("x", x), ("h", h), ("u", u), ("p", model.parameters), ("lam", multipliers)]
    value = printer.read(inputs, after)
    first = printer.read(inputs, jacobian.T)
    second = _upper(printer.read(inputs, hessian), inner.numel())
    printer.share([*value, *first, *second])
    common = "const P* x, P h, const P* u, const double* p"
    text = _function("step", f"{common}, P* after, P* shared", printer.body([("after", value)], True))
    common += ", const P* shared"
    text += _function("step_jacobian", f"{common}, P* J", printer.body([("J", first)], False))
    text += _function("step_hessian", f"{common}, const P* lam, P* H", printer.body([("H", second)], False))
    return text, len(printer.shared)


def _cover(model: Symbolic) -> list[str]:
    """Text of the cover's two functions: how far a point can leave its chord between two poses of an interval."""
    nx, nu = model.vehicle.n_states, model.vehicle.n_inputs
    x, h, u = ca.SX.sym("x", nx), ca.SX.sym("h"), ca.SX.sym("u", nu)
    rho, poses = ca.SX.sym("rho"), ca.SX.sym("poses")
    namespace = _Namespace(model.tangents)
    bound = model.vehicle.acceleration_bound(0, rho, ca.vertsplit(x), ca.vertsplit(u), h / 2, namespace)
    cover = bound * (h / poses) ** 2 / 8
    hessian, gradient = ca.hessian(cover, ca.vertcat(x, h, u))
    inputs = [("x", x), ("h", h), ("u", u), ("p", model.parameters), ("rho", rho), ("poses", poses)]
    printer = Printer()
    value = printer.read(inputs, cover)
    second = _upper(printer.read(inputs, hessian), nx + 1 + nu)
    derivatives = [("gradient", printer.read(inputs, gradient)), ("H", second)]
    common = "const P* x, P h, const P* u, const double* p, double rho, double poses"
    text = _function("cover", f"{common}, P* value", printer.body([("value", value)], False))
    arguments = f"{common}, P* gradient, P* H"
    return text + _function("cover_derivatives", arguments, printer.body(derivatives, False))


def _upper(hessian: list[int], n: int) -> list[int]:
    """The same symmetric matrix, with both halves from one, so that the other need not be computed."""
    return [hessian[min(i, j) * n + max(i, j)] for i in range(n) for j in range(n)]


def _function(name: str, arguments: str, lines: list[str]) -> list[str]:
    """A static member; arguments that it does not use are marked as such."""
    body = [f"        {line}" for line in lines]
    used = "\n".join(body)
    names = [argument.split()[-1] for argument in arguments.split(", ")]
    unused = [f"        (void){name};" for name in names if not _appears(name, used)]
    head = ["    template <class P>", f"    static inline void {name}({arguments}) {{"]
    return [*head, *unused, *body, "    }", ""]


def _appears(name: str, text: str) -> bool:
    return f"{name}[" in text or f" {name} " in text or f" {name};" in text or f"({name})" in text


def header(model: Symbolic) -> str:
    """The model's C++ header."""
    nx, nu = model.vehicle.n_states, model.vehicle.n_inputs
    step, shared = _step(model)
    lines = [
        f"// Written by cpp/generate_models.py with CasADi {ca.__version__}; change the Python model, not this file.",
        "#pragma once",
        "",
        '#include "tightspot/stagewise/sine_cosine.hpp"',
        "",
        "namespace tightspot::stagewise {",
        "",
        f"// Parameters p: {model.meaning}. P: double, or Pack for several at once.",
        f"struct {model.name} {{",
        f"    static constexpr int states = {nx}, inputs = {nu}, parameters = {model.parameters.numel()};",
        f"    static constexpr int shared = {shared};",
        "",
        "    // One Runge-Kutta step of h seconds. Derivatives: with respect to (x[2], ..., h, u); J by rows, H full.",
        *step,
        "    // The cover of an interval of h seconds with middle state x. Derivatives: with respect to (x, h, u).",
        *_cover(model)[:-1],
        "};",
        "",
        "}  // namespace tightspot::stagewise",
        "",
    ]
    return "\n".join(lines)


def file_name(model: Symbolic) -> str:
    """``SingleTrack`` becomes ``single_track.hpp``."""
    words = "".join(f"_{letter.lower()}" if letter.isupper() else letter for letter in model.name)
    return f"{words.lstrip('_')}.hpp"


def main(folder: Path) -> None:
    """Write every model's header into the folder."""
    for make in MODELS:
        model = make()
        (folder / file_name(model)).write_text(header(model), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else FOLDER)
