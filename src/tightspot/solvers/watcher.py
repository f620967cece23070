"""CasADi's iteration callback, for the backends that call one."""

from __future__ import annotations

import time
from typing import Any

import casadi as ca
import numpy as np

from tightspot.solvers.base import Iteration, IterationCallback, asks_to_stop
from tightspot.solvers.interrupts import Interrupts
from tightspot.solvers.nlp import Nlp


class Watcher(ca.Callback):
    """Passes progress on, stops at Ctrl-C and when the time is up, keeps exceptions for after the solve.

    One watcher belongs to one built solver; :meth:`begin` comes before each solve.

    Attributes:
        raised: What the callback or the interrupt raised, to be raised again outside the compiled code.
        stopped: True once it has told the backend to stop.
        late: True if that was because the time was up.
    """

    def __init__(self, nlp: Nlp, n_variables: int | None = None) -> None:
        super().__init__()
        self._nlp = nlp
        self._callback: IterationCallback | None = None
        self._interrupts = Interrupts()
        self._deadline = np.inf
        self._n_variables = nlp.n_variables if n_variables is None else n_variables
        self._count = 0
        self.raised: BaseException | None = None
        self.stopped = self.late = False
        self.construct("watcher", {})

    def begin(
        self, nlp: Nlp, callback: IterationCallback | None, interrupts: Interrupts, seconds: float = np.inf
    ) -> None:
        """Watch a solve of ``nlp``, which has the watcher's symbols, for at most ``seconds``."""
        self._nlp, self._callback, self._interrupts = nlp, callback, interrupts
        self._deadline = time.perf_counter() + seconds
        self._count, self.raised = 0, None
        self.stopped = self.late = False

    def get_n_in(self) -> int:
        return int(ca.nlpsol_n_out())

    def get_n_out(self) -> int:
        return 1

    def get_name_in(self, i: int) -> str:
        return str(ca.nlpsol_out(i))

    def get_name_out(self, i: int) -> str:
        return "stop"

    def get_sparsity_in(self, i: int) -> Any:
        name = ca.nlpsol_out(i)
        n, m = self._n_variables, self._nlp.n_rows
        sizes = {"f": 1, "x": n, "lam_x": n, "g": m, "lam_g": m}
        return ca.Sparsity.dense(sizes[name], 1) if name in sizes else ca.Sparsity(0, 0)

    def eval(self, arguments: Any) -> list[float]:
        try:
            stop = self._interrupts.pending or asks_to_stop(self._report(arguments)) or self._interrupts.pending
        except BaseException as error:
            self.raised, stop = error, True
        if not stop and time.perf_counter() > self._deadline:
            self.late = stop = True
        self.stopped = self.stopped or stop
        return [1.0 if stop else 0.0]

    def _report(self, arguments: Any) -> bool | None:
        if self._callback is None:
            return None
        values = dict(zip(ca.nlpsol_out(), arguments, strict=True))
        violation = float(self._nlp.violation(np.array(values["g"], float).ravel()).max(initial=0.0))
        iteration = Iteration(self._count, float(values["f"]), violation)
        self._count += 1
        return self._callback(iteration)
