"""The process in which fatrop runs. Started by :mod:`tightspot.solvers.fatrop` as a script; imports CasADi only.

Standard input and output carry pickled messages, ``(word, content)``. The answers to one ``solve`` message are

- ``("program?", None)``: its key is not known here; a ``program`` message with the text or library must follow;
- ``("built", seconds)``: fatrop is ready;
- ``("iteration", (number, objective, violation))``: any number of times, read from fatrop's own log;
- ``("done", answer)`` or ``("refused", sentence)``.
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


def build(program: dict[str, Any], options: dict[str, Any]) -> Any:
    """The solver of a program that is given as serialised text or as a compiled library."""
    if program["library"]:
        return ca.nlpsol("nlp", "fatrop", program["library"], options)
    function = ca.Function.deserialize(program["text"])
    x, p = function.sx_in()
    f, g = function(x, p)
    return ca.nlpsol("nlp", "fatrop", {"x": x, "p": p, "f": f, "g": g}, options)


def solve(solver: Any, arguments: dict[str, Any], answers: BinaryIO) -> dict[str, Any]:
    """Solve once; iterations are told on the way."""
    output = sys.stdout
    sys.stdout = Log(answers)
    started = time.perf_counter()
    try:
        result = solver(**arguments)
    finally:
        sys.stdout = output
    seconds = time.perf_counter() - started
    stats = solver.stats()
    vectors = {name: np.array(result[name], float).ravel() for name in ("x", "lam_x", "lam_g")}
    functions = sum(value for name, value in stats.items() if name.startswith("t_wall_"))
    facts = {"iterations": int(stats["iter_count"]), "success": bool(stats["success"]), "functions": float(functions)}
    return vectors | facts | {"seconds": seconds, "flag": int(stats["return_status"])}


def serve(questions: BinaryIO, answers: BinaryIO) -> None:
    """Answer until the other process closes the pipe."""
    solvers: OrderedDict[str, Any] = OrderedDict()
    while True:
        try:
            task = pickle.load(questions)[1]
        except EOFError:
            return
        try:
            solver = solvers.pop(task["key"], None)
            if solver is None:
                send(answers, "program?", None)
                program = pickle.load(questions)[1]
                started = time.perf_counter()
                solver = build(program, task["options"])
                send(answers, "built", time.perf_counter() - started)
            else:
                send(answers, "built", 0.0)
            solvers[task["key"]] = solver
            if len(solvers) > KEPT:
                solvers.popitem(last=False)
            answer = solve(solver, task["arguments"], answers)
        except RuntimeError as error:
            send(answers, "refused", str(error).strip().splitlines()[-1])
        else:
            send(answers, "done", answer)


def main() -> None:
    """Keep the pipe for messages; what compiled code prints goes nowhere."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    answers = os.fdopen(os.dup(1), "wb")
    with open(os.devnull, "wb") as nowhere:
        os.dup2(nowhere.fileno(), 1)
    serve(sys.stdin.buffer, answers)


if __name__ == "__main__":
    main()
