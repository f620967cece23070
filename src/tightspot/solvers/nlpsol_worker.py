"""The process in which a solver of CasADi's runs that may hang or crash. Started by :mod:`tightspot.solvers.remote` as
a script; imports CasADi only.

Standard input and output carry pickled messages, ``(word, content)``. The answers to one ``solve`` message are

- ``("program?", None)``: its key is not known here; a ``program`` message with the text or library must follow;
- ``("built", seconds)``: the solver is ready;
- ``("iteration", (number, objective, violation))``: any number of times, read from fatrop's own log or told by CasADi;
- ``("done", answer)``, ``("refused", sentence)`` if it could not be built, or ``("broken", sentence)`` if it gave up.
"""

from __future__ import annotations

import os
import pickle
import signal
import sys
import time
from collections import OrderedDict
from typing import Any, BinaryIO

import casadi as ca
import numpy as np

KEPT = 6
RESTORATION = "r"
"""Behind the number of an iteration that looks for a feasible point only."""


class Log:
    """Stands in for standard output while fatrop writes its log, and passes iterations on."""

    def __init__(self, answers: BinaryIO) -> None:
        self._answers = answers
        self._line = ""

    def write(self, text: str) -> int:
        """Take a piece of a line or of several."""
        *lines, self._line = (self._line + text).split("\n")
        for line in lines:
            words = line.split()
            if len(words) > 3 and words[0].rstrip(RESTORATION).isdigit():
                self._send(words)
        return len(text)

    def _send(self, words: list[str]) -> None:
        try:
            iteration = int(words[0].rstrip(RESTORATION)), float(words[1]), float(words[2])
        except ValueError:
            return
        send(self._answers, "iteration", iteration)

    def flush(self) -> None:
        """Nothing is held back but unfinished lines."""


def send(answers: BinaryIO, word: str, content: Any) -> None:
    """One message to the other process."""
    pickle.dump((word, content), answers)
    answers.flush()


class Progress(ca.Callback):
    """CasADi's iteration callback: passes iterations on."""

    def __init__(self, answers: BinaryIO, n: int, m: int) -> None:
        super().__init__()
        self._answers = answers
        self._sizes = {"f": 1, "x": n, "lam_x": n, "g": m, "lam_g": m}
        self._count = 0
        self._low = self._high = np.zeros(m)
        self.construct("progress", {})

    def begin(self, low: Any, high: Any) -> None:
        """Count from 0 again, with other bounds of the rows."""
        self._count, self._low, self._high = 0, low, high

    def get_n_in(self) -> int:
        """Of CasADi's."""
        return int(ca.nlpsol_n_out())

    def get_n_out(self) -> int:
        """Whether to stop, which is always no."""
        return 1

    def get_sparsity_in(self, i: int) -> Any:
        """As large as what it is told."""
        size = self._sizes.get(ca.nlpsol_out(i))
        return ca.Sparsity(0, 0) if size is None else ca.Sparsity.dense(size, 1)

    def eval(self, arguments: Any) -> list[float]:
        """Tell the other process."""
        values = dict(zip(ca.nlpsol_out(), arguments, strict=True))
        g = np.array(values["g"], float).ravel()
        violation = float(np.maximum(self._low - g, g - self._high).max(initial=0.0))
        send(self._answers, "iteration", (self._count, float(values["f"]), violation))
        self._count += 1
        return [0.0]


def build(task: dict[str, Any], program: dict[str, Any], answers: BinaryIO) -> tuple[Any, Progress | None]:
    """The solver of a program that is given as serialised text or as a compiled library, and what listens to it."""
    plugin, options = task["plugin"], dict(task["options"])
    if program["library"]:
        return ca.nlpsol("nlp", plugin, program["library"], options), None
    function = ca.Function.deserialize(program["text"])
    x, p = function.sx_in()
    f, g = function(x, p)
    progress = None
    if task["plugin"] != "fatrop":
        progress = options["iteration_callback"] = Progress(answers, x.numel(), g.numel())
    return ca.nlpsol("nlp", plugin, {"x": x, "p": p, "f": f, "g": g}, options), progress


def solve(solver: Any, progress: Progress | None, arguments: dict[str, Any], answers: BinaryIO) -> dict[str, Any]:
    """Solve once; iterations are told on the way."""
    output = sys.stdout
    if progress is None:
        sys.stdout = Log(answers)
    else:
        progress.begin(arguments["lbg"], arguments["ubg"])
    started = time.perf_counter()
    try:
        result = solver(**arguments)
    finally:
        sys.stdout = output
    seconds = time.perf_counter() - started
    stats = solver.stats()
    vectors = {name: np.array(result[name], float).ravel() for name in ("x", "g", "lam_x", "lam_g")}
    functions = sum(value for name, value in stats.items() if name.startswith("t_wall_"))
    facts = {"iterations": int(stats["iter_count"]), "success": bool(stats["success"]), "functions": float(functions)}
    words = {"word": str(stats["return_status"]), "unified": str(stats["unified_return_status"])}
    return vectors | facts | words | {"seconds": seconds, "objective": float(result["f"])}


def serve(questions: BinaryIO, answers: BinaryIO) -> None:
    """Answer until the other process closes the pipe."""
    solvers: OrderedDict[str, tuple[Any, Progress | None]] = OrderedDict()
    while True:
        try:
            task = pickle.load(questions)[1]
        except EOFError:
            return
        try:
            kept = solvers.pop(task["key"], None)
            if kept is None:
                send(answers, "program?", None)
                program = pickle.load(questions)[1]
                started = time.perf_counter()
                kept = build(task, program, answers)
                send(answers, "built", time.perf_counter() - started)
            else:
                send(answers, "built", 0.0)
        except RuntimeError as error:
            send(answers, "refused", last_line(error))
            continue
        solvers[task["key"]] = kept
        if len(solvers) > KEPT:
            solvers.popitem(last=False)
        try:
            answer = solve(kept[0], kept[1], task["arguments"], answers)
        except RuntimeError as error:
            send(answers, "broken", last_line(error))
        else:
            send(answers, "done", answer)


def last_line(error: RuntimeError) -> str:
    """What CasADi complains of, without where."""
    return str(error).strip().splitlines()[-1]


def main() -> None:
    """Keep the pipe for messages; what compiled code prints goes nowhere."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    answers = os.fdopen(os.dup(1), "wb")
    with open(os.devnull, "wb") as nowhere:
        os.dup2(nowhere.fileno(), 1)
    serve(sys.stdin.buffer, answers)


if __name__ == "__main__":
    main()
