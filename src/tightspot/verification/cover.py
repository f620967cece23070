"""Covering the horizon with lines: branch and bound over time, for all pairs at once.

Every interval of every pair is one row of an array; a level of the search evaluates all open rows together.
First the intervals run from knot to knot, from the whole horizon down to single ones, so that a pair that
stays apart needs few lines; then single intervals are bisected in time.

An interval is closed as soon as the lemma of :mod:`tightspot.verification.motion` bounds its clearance by the
pair's target from below. The target is the demanded clearance or, to make the proved number a good one, what
has been seen minus a tolerance. For a pair already seen below the demand, the same search finds its worst
moment instead.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tightspot.verification import compiled
from tightspot.verification.barriers import Pairs
from tightspot.verification.motion import Motion

if TYPE_CHECKING:
    from tightspot.verification.compiled import Body

Array = NDArray[np.float64]
Index = NDArray[np.intp]

# A clearance this much below the demand is a witness; less is rounding.
TOLERANCE = 1e-9
# The worst clearance of a pair without proof is found to this accuracy, m.
WORST_RESOLUTION = 1e-5
# More open intervals than this mean that bisecting leads nowhere.
MAX_OPEN = 300_000
_BLOCK = 20_000


@dataclass(frozen=True, eq=False)
class Cover:
    """Lines for all pairs and times, and the smallest clearances seen on the way.

    Attributes:
        pair: Index of the pair of each row, sorted, shape (M,).
        start: Beginnings of the intervals, s, ascending within a pair, shape (M,).
        end: Their ends, s, shape (M,).
        normal: Unit normals towards the body, shape (M, 2).
        support: Largest n.o over the barrier, m, shape (M,).
        proved: Lower bound of the clearance on the interval, m, integration error and rounding deducted,
            shape (M,).
        holds: Whether each pair is proved to keep the demanded clearance for all times, shape (P,).
        seen: Smallest clearance of each pair at any time looked at, m, shape (P,). Pairs that are farther apart than
            others and than demanded need not have been looked at often.
        seen_at: The time of it, s, shape (P,).
    """

    pair: Index
    start: Array
    end: Array
    normal: Array
    support: Array
    proved: Array
    holds: NDArray[np.bool_]
    seen: Array
    seen_at: Array

    @property
    def clearance(self) -> float:
        """Proved lower bound over all pairs and times, m; infinite without pairs."""
        return float(self.proved.min(initial=np.inf))

    @cached_property
    def first(self) -> Index:
        """Each pair's rows begin here and end where the next one's begin, shape (P+1,)."""
        return np.searchsorted(self.pair, np.arange(self.holds.size + 1))

    @cached_property
    def cuts(self) -> Array:
        """Of each pair the beginnings of its intervals and the end of the last, s, one pair after the other, (M+P,).

        Those of pair p are ``cuts[first[p] + p : first[p + 1] + p + 1]``; every pair has an interval.
        """
        return np.insert(self.start, self.first[1:], self.end[self.first[1:] - 1])


def cover(motion: Motion, pairs: Pairs, demand: float, *, resolution: float, floor: float) -> Cover:
    """Cover [0, t_f] for every pair.

    Args:
        motion: Of the body.
        pairs: What must stay apart.
        demand: Clearance to prove, m.
        resolution: The proved clearance is raised to within this of the smallest one there is, m, if it is
            cheap.
        floor: Intervals shorter than this are given up, s.
    """
    if motion.body is not None:
        return _compiled(motion.body, pairs, demand, resolution=resolution, floor=floor)
    search = _Search(motion, pairs, demand, resolution, floor)
    if pairs.part.size:
        search.between_knots()
        search.bisect()
    return search.result()


def _compiled(body: Body, pairs: Pairs, demand: float, **work: float) -> Cover:
    limits = {"tolerance": TOLERANCE, "worst": WORST_RESOLUTION, "most_open": MAX_OPEN}
    found = compiled.covered(body, pairs.core, demand=demand, **work, **limits)
    return Cover(**found | {"pair": found["pair"].astype(np.intp, copy=False), "holds": found["holds"].view(bool)})


@dataclass(eq=False)
class _Search:
    motion: Motion
    pairs: Pairs
    demand: float
    resolution: float
    floor: float
    closed: list[tuple[Array | Index, ...]] = field(default_factory=list)
    single: list[tuple[Index, Index]] = field(default_factory=list)

    def __post_init__(self) -> None:
        count = self.pairs.part.size
        self.seen, self.seen_at = np.full(count, np.inf), np.zeros(count)
        self.pad = self.motion.pad[self.pairs.part]

    def target(self) -> Array:
        """The bound at which an interval of each pair is closed, m, shape (P,)."""
        violated = self.seen < self.demand - TOLERANCE
        common = self.demand
        if not violated.any():
            common = max(self.demand, float((self.seen - self.pad).min()) - self.resolution)
        return np.where(violated, self.seen - self.pad - WORST_RESOLUTION, common)

    def look(self, pair: Index, times: Array, clearance: Array) -> None:
        """Remember the smallest clearance of each pair."""
        order = np.argsort(clearance)[::-1]
        pair, times, clearance = pair[order], times[order], clearance[order]
        lowest, at = np.full_like(self.seen, np.inf), np.zeros_like(self.seen)
        lowest[pair], at[pair] = clearance, times
        lower = lowest < self.seen
        self.seen, self.seen_at = np.where(lower, lowest, self.seen), np.where(lower, at, self.seen_at)

    def close(self, rows: NDArray[np.bool_], *columns: Array | Index) -> None:
        """Keep the chosen rows of (pair, start, end, normal, support, bound)."""
        self.closed.append(tuple(column[rows] for column in columns))

    def between_knots(self) -> None:
        """Intervals [t_a, t_b], halved until single; what is left goes to ``single``."""
        t, knots = self.motion.t, self.motion.knots
        N, P = t.size - 1, self.pairs.part.size
        pair, knot = np.divmod(np.arange(P * (N + 1)), N + 1)
        normal, support, clearance = self.lines(pair, knots[knot])
        self.look(pair, t[knot], clearance)
        normal, support = normal.reshape(P, N + 1, 2), support.reshape(P, N + 1)
        loss = self._knot_losses()
        pair, a, b = np.arange(P), np.zeros(P, dtype=np.intp), np.full(P, N, dtype=np.intp)
        while pair.size:
            middle = (a + b) // 2
            n, s = normal[pair, middle], support[pair, middle]
            bound = self._chain(pair, a, b, n, loss) - s - self.pad[pair]
            done = bound >= self.target()[pair]
            self.close(done, pair, t[a], t[b], n, s, bound)
            alone = ~done & (b - a == 1)
            self.single.append((pair[alone], a[alone]))
            split = ~done & ~alone
            pair, a, middle, b = pair[split], a[split], middle[split], b[split]
            pair, a, b = np.tile(pair, 2), np.concatenate([a, middle]), np.concatenate([middle, b])

    def bisect(self) -> None:
        """Single intervals, bisected in time until each is closed or given up."""
        t, knots = self.motion.t, self.motion.knots
        pair, k = (np.concatenate(column) for column in zip(*self.single, strict=True))
        start, end, before, after = t[k], t[k + 1], knots[k], knots[k + 1]
        while pair.size:
            part, middle = self.pairs.part[pair], 0.5 * (start + end)
            between = self.motion.at(middle)
            normal, support, clearance = self.lines(pair, between)
            self.look(pair, middle, clearance)
            low = np.minimum(self.motion.lowest(part, before, normal), self.motion.lowest(part, after, normal))
            loss = self.motion.loss(part, k, before, after, end - start)
            bound = low - loss - support - self.pad[pair]
            done = (bound >= self.target()[pair]) | self._hopeless(pair, clearance, loss, end - start)
            self.close(done, pair, start, end, normal, support, bound)
            halves = np.concatenate([np.flatnonzero(~done)] * 2)
            first = np.arange(halves.size) < halves.size // 2
            start = np.where(first, start[halves], middle[halves])
            end = np.where(first, middle[halves], end[halves])
            before = np.where(first[:, None], before[halves], between[halves])
            after = np.where(first[:, None], between[halves], after[halves])
            pair, k = pair[halves], k[halves]

    def lines(self, pair: Index, states: Array) -> tuple[Array, Array, Array]:
        """The pairs' lines at the states (B, n_x), in blocks that keep memory small."""
        blocks = [slice(i, i + _BLOCK) for i in range(0, pair.size, _BLOCK)] or [slice(0)]
        found = [
            self.pairs.lines(pair[block], self.motion.vertices(self.pairs.part[pair[block]], states[block]))
            for block in blocks
        ]
        normal, support, clearance = (np.concatenate(column) for column in zip(*found, strict=True))
        return normal, support, clearance

    def result(self) -> Cover:
        none = np.zeros(0)
        nothing = (np.zeros(0, dtype=np.intp), none, none, np.zeros((0, 2)), none, none)
        columns = [np.concatenate(column) for column in zip(nothing, *self.closed, strict=True)]
        order = np.lexsort((columns[1], columns[0]))
        pair, start, end, normal, support, proved = (column[order] for column in columns)
        worst = np.full_like(self.seen, np.inf)
        np.minimum.at(worst, pair, proved)
        return Cover(pair, start, end, normal, support, proved, worst >= self.demand, self.seen, self.seen_at)

    def _hopeless(self, pair: Index, clearance: Array, loss: Array, duration: Array) -> NDArray[np.bool_]:
        """Intervals on which no bisecting can reach the demand, or none that would end soon enough."""
        undecided = (clearance < self.demand + self.pad[pair]) & (clearance >= self.demand - TOLERANCE)
        too_many = np.full(pair.size, pair.size > MAX_OPEN)
        return np.asarray(undecided | too_many | ~np.isfinite(loss) | (duration < self.floor))

    def _knot_losses(self) -> Array:
        """``P h^2 / 8`` of every body part on every interval, m, shape (n_B, N)."""
        durations, knots = np.diff(self.motion.t), self.motion.knots
        N, n_B = durations.size, len(self.motion.names)
        part, k = np.divmod(np.arange(n_B * N), N)
        return self.motion.loss(part, k, knots[k], knots[k + 1], durations[k]).reshape(n_B, N)

    def _chain(self, pair: Index, a: Index, b: Index, normal: Array, loss: Array) -> Array:
        """The lemma's lower bound of n.p over [t_a, t_b], one normal for all its intervals, m, shape (B,)."""
        knots, part = self.motion.knots, self.pairs.part[pair]
        length = int((b - a).max())
        bound = np.empty(pair.size)
        size = max(1, _BLOCK // (length + 1))
        for block in (slice(i, i + size) for i in range(0, pair.size, size)):
            k = np.minimum(a[block, None] + np.arange(length + 1), b[block, None])
            rows = k.shape
            n = np.repeat(normal[block], rows[1], axis=0)
            low = self.motion.lowest(np.repeat(part[block], rows[1]), knots[k.ravel()], n).reshape(rows)
            piece = np.minimum(k[:, :-1], b[block, None] - 1)
            bound[block] = (np.minimum(low[:, :-1], low[:, 1:]) - loss[part[block, None], piece]).min(axis=1)
        return bound
