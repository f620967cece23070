"""The size of a nonlinear program as the paper's Table II counts it."""

from __future__ import annotations

from typing import NamedTuple

from tightspot.solvers.nlp import Nlp


class Counts(NamedTuple):
    """Sizes of a built program.

    Attributes:
        VN: Variables: states, inputs, auxiliary variables, t_f.
        CN: The paper's number of constraints, ``VN + rows + auxiliary``: each variable's bounds as one constraint, each
            row of g as one, and each auxiliary variable once more.
        rows: Rows of g.
        auxiliary: Auxiliary variables of the formulation.
    """

    VN: int
    CN: int
    rows: int
    auxiliary: int


def counts(nlp: Nlp) -> Counts:
    """VN and CN of a program.

    The rule for CN is not the paper's, which gives none; it is the one that yields the six numbers of Table II from
    the programs themselves.

    Reference: paper, Table II; NOTES.md, "Counts".
    """
    auxiliary = sum(stage.auxiliary.stop - stage.auxiliary.start for stage in nlp.stages)
    return Counts(nlp.n_variables, nlp.n_variables + nlp.n_rows + auxiliary, nlp.n_rows, auxiliary)
