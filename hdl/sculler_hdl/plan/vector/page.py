"""Third and fourth order in the pipelined core: the page's letters as sums of products of vectors.

The page is `algorithms.higher_order`.  The vector engine multiplies a wide left factor by a narrow
right one.  So every cross product has the letter that grows on its left and theta, alpha, the slope
l or a whole number on its right, which turns some of them round.  The pipeline's own sums bring P:

    P = between - before,      kappa = within - before

Third order scales b and k by f, c and m by t, and so has no X and no tau:

    third  += (c × theta) × theta + (m × theta) × l + b × theta - k × alpha

Fourth order has them, and one product of two wide letters, b × k, for which k is cut into digits:

    tau     = (c × theta) × theta + (m × theta) × l        X = b × theta - k × alpha
    third  += t tau + f X
    p = P × theta             g = 6 third + 2 f X - 2 f Dc p + f Dc q        third before it grows
    q = -(P × alpha)          h = 6 t tau + 2 f X + f Dc p - 2 f Dc q
    fourth += (-u (f × theta) × theta) × theta + (y g) × theta - (y h) × alpha + (e b) × k

Each letter is a dual vector: an angle and a velocity, of three components each.
"""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum, auto
from functools import reduce
from typing import NamedTuple

from sculler_model.design import ZERO_RANGE, Design, DualRange, Interval

HALVES = ("angle", "velocity")
"""Of a dual vector."""


class Form(Enum):
    """Which components a step multiplies, for the component of axis i."""

    STRAIGHT = 0
    """Left i; the right factor is a whole number."""
    FORWARD = 1
    """Left i + 1 and right i + 2."""
    BACKWARD = 2
    """Left i + 2 and right i + 1."""


class Place(Enum):
    """A memory that a vector stands in."""

    LEFT = auto()
    RIGHT = auto()
    SUM = auto()
    """The running sums that are results."""


class Step(NamedTuple):
    """A product that is added to a vector.

    Attributes:
        left: a vector, or a sample.
        right: a vector, or a whole number.
        form: of which components.
        subtract: it is taken away.
        old: left is what the minor interval before has left; 0 in a major interval's first.
        digit: the product weighs 2^(digit * digit_bits).
    """

    left: str
    right: str | int
    form: Form = Form.STRAIGHT
    subtract: bool = False
    old: bool = False
    digit: int = 0


class Task(NamedTuple):
    """A vector: the sum of its steps.

    Attributes:
        target: its name.
        steps: what is added up.
        places: where it is stored.
        digit: which of its digits is stored; None: all of it.
        grows: it starts from what is stored, which is 0 in a major interval's first minor interval.
    """

    target: str
    steps: tuple[Step, ...]
    places: tuple[Place, ...]
    digit: int | None = None
    grows: bool = False


Steps = tuple[list[Step], list[Step]]
"""Those of a dual vector's halves."""


class Page:
    """The tasks of a minor interval, in the page's order.

    Args:
        design: of third or fourth order.

    Attributes:
        tasks: all of them.
        ranges: of the components of every vector, loaded ones and samples included.
        left_loads, right_loads: the vectors that the pipeline gives.
        digit_bits, digit_count: of the digits of k.
        left_range, right_range: of all left factors, all right ones.
        total_range: of everything that is added up.
    """

    def __init__(self, design: Design) -> None:
        words = design.words.higher
        assert words is not None
        self.design, self._words = design, words
        self._factors, self._taps = design.composition, design.composition.taps
        self._later = design.algorithm.minors > 1
        self.tasks: list[Task] = []
        self.ranges: dict[str, Interval] = {}
        self.left_loads: list[str] = []
        self.right_loads: list[str] = []
        self.digit_bits = self.digit_count = 1
        plain = design.words
        theta = DualRange(plain.theta, plain.v)
        self._given("theta", theta, self.right_loads)
        if self._later:
            self._given("alpha", theta.repeated(design.algorithm.minors - 1), self.right_loads)
            within = DualRange(plain.coning_within, plain.sculling_within)
            between = DualRange(plain.coning_between, plain.sculling_between)
            for name, each in (("within", within), ("between", between)):
                self._given(name, each, self.left_loads)
                self._ranges(f"{name}_before", each)
        for d in range(design.algorithm.samples):
            self._ranges(f"sample{d}", DualRange(plain.gyro, plain.accel))
        if design.order == 3:
            self._third()
        else:
            self._fourth()
        if self._later:
            for name in ("within", "between"):
                self._add(f"{name}_before", None, _scaled((1, name)))
        self._find_ranges()

    def _given(self, name: str, words: DualRange, loads: list[str]) -> None:
        self._ranges(name, words)
        loads += [f"{name}.{half}" for half in HALVES]

    def _ranges(self, name: str, words: DualRange) -> None:
        for half, each in zip(HALVES, words, strict=True):
            self.ranges[f"{name}.{half}"] = each

    def _add(
        self,
        name: str,
        words: DualRange | None,
        *parts: Steps,
        places: tuple[Place, ...] = (Place.LEFT,),
        digit: int | None = None,
        grows: bool = False,
    ) -> str:
        """A letter: the sum of parts; its ranges are `words`, unless they are known."""
        if words is not None:
            self._ranges(name, words)
        for i, half in enumerate(HALVES):
            steps = tuple(step for part in parts for step in part[i])
            self.tasks.append(Task(f"{name}.{half}", steps, places, digit, grows))
        return name

    def _weighted(
        self, name: str, words: DualRange, weights: Sequence[int], place: Place = Place.LEFT
    ) -> str:
        """A sum of weight d times the sample d samples back."""
        terms = [(w, f"sample{d}") for d, w in enumerate(weights) if w]
        return self._add(name, words, _scaled(*terms), places=(place,))

    def _triple(self, scale: int) -> list[Steps]:
        """scale times tau; nothing of a single sample."""
        taps, words = self._taps, self._words
        if taps.third_is_zero:
            return []
        parts = []
        slope = self._weighted("slope", words.slope, taps.slope, Place.RIGHT)
        for name, weights, plain, crossed, right in (
            ("c", taps.curvature, words.c, words.theta_c, "theta"),
            ("m", taps.partner, words.m, words.theta_m, slope),
        ):
            if any(weights):
                scaled = [scale * w for w in weights]
                left = self._weighted(name, plain.scaled(scale), scaled)
                inner = self._add(f"{name}_theta", crossed.scaled(-scale), _cross(left, "theta"))
                parts.append(_cross(inner, right))
        return parts

    def _pair(self, scale: int) -> Steps:
        """Scale times X, and b and k for it."""
        words, Dc = self._words, self._factors.within
        b = self._add(
            "b",
            words.b.scaled(scale),
            _scaled((6 * scale, "within_before"), (2 * Dc * scale, "between_before"), old=True),
            _scaled((Dc * scale, "between")),
        )
        k = self._add(
            "k",
            words.k.scaled(scale),
            _scaled((6 * scale, "within"), (Dc * scale, "between")),
            _scaled((-6 * scale, "within_before"), (-Dc * scale, "between_before"), old=True),
        )
        return _joined(_cross(b, "theta"), _cross(k, "alpha", subtract=True))

    def _third(self) -> None:
        """All of third order."""
        c = self._factors
        parts = self._triple(c.third_triple)
        if self._later:
            parts.append(self._pair(c.third_composed))
        self._add("third", self._words.third, *parts, places=(Place.SUM,), grows=True)

    def _fourth(self) -> None:
        """All of third and fourth order."""
        c, words = self._factors, self._words
        third: list[Steps] = []
        fourth: list[Steps] = []
        triple = self._triple(1)
        if triple:
            tau = self._add("tau", words.tau, *triple)
            third.append(_scaled((c.third_triple, tau)))
            fourth.append(_cross(self._inner(), "theta"))
        if self._later:
            third.append(_scaled((c.third_composed, self._add("X", words.X, self._pair(1)))))
            fourth += self._outer(bool(triple))
            fourth += self._digits()
        places = (Place.SUM, Place.LEFT) if self._later else (Place.SUM,)
        self._add("third", words.third, *third, places=places, grows=True)
        self._add("fourth", words.fourth, *fourth, places=(Place.SUM,), grows=True)

    def _inner(self) -> str:
        """-u (f × theta) × theta."""
        words, u = self._words, self._factors.fourth_inner
        f = self._weighted("f", words.f, self._taps.fourth)
        once = self._add("f_theta", words.theta_f.scaled(-1), _cross(f, "theta"))
        twice = self._add("f_theta_theta", words.theta_theta_f, _cross(once, "theta"))
        return self._times(-u, twice, words.theta_theta_f)

    def _outer(self, with_tau: bool) -> list[Steps]:
        """(y g) × theta - (y h) × alpha."""
        words, c = self._words, self._factors
        f, Dc, t, y = c.third_composed, c.within, c.third_triple, c.fourth_outer
        P = self._add(
            "P", words.P, _scaled((1, "between")), _scaled((-1, "between_before"), old=True)
        )
        p = self._add("p", words.p, _cross(P, "theta"))
        q = self._add("q", words.q, _cross(P, "alpha", subtract=True))
        shared = _scaled((2 * f, "X"))
        g = self._add(
            "g",
            words.g,
            _scaled((6, "third"), old=True),
            shared,
            _scaled((-2 * f * Dc, p), (f * Dc, q)),
        )
        tau = [_scaled((6 * t, "tau"))] if with_tau else []
        h = self._add("h", words.h, *tau, shared, _scaled((f * Dc, p), (-2 * f * Dc, q)))
        g, h = self._times(y, g, words.g), self._times(y, h, words.h)
        return [_cross(g, "theta"), _cross(h, "alpha", subtract=True)]

    def _digits(self) -> list[Steps]:
        """(e b) × k, digit by digit of k."""
        words = self._words
        left = self._times(self._factors.fourth_pairs, "b", words.b)
        bits = self._right_bits()
        self.digit_bits = bits - 1
        whole = max(each.bits for each in words.k)
        self.digit_count = 1 + max(0, -(-(whole - bits) // self.digit_bits))
        parts = []
        for digit in range(self.digit_count):
            digits = DualRange(*(self._digit(each, digit) for each in words.k))
            name = self._add(
                f"k{digit}", digits, _scaled((1, "k")), places=(Place.RIGHT,), digit=digit
            )
            parts.append(_cross(left, name, digit=digit))
        return parts

    def _digit(self, number: Interval, digit: int) -> Interval:
        """The top digit is signed, the others are not."""
        low = digit * self.digit_bits
        if digit + 1 < self.digit_count:
            return Interval(0, (1 << self.digit_bits) - 1)
        return Interval(number.lo >> low, number.hi >> low)

    def _times(self, factor: int, name: str, words: DualRange) -> str:
        """A multiple of a letter; the letter itself if the factor is 1."""
        if factor == 1:
            return name
        return self._add(f"{name}_times", words.scaled(factor), _scaled((factor, name)))

    @property
    def constants(self) -> list[int]:
        """The whole numbers that stand on the right."""
        rights = {step.right for task in self.tasks for step in task.steps}
        return sorted(right for right in rights if isinstance(right, int))

    def _rights(self) -> list[Interval]:
        names = {step.right for task in self.tasks for step in task.steps}
        return [
            ZERO_RANGE | Interval(name, name) if isinstance(name, int) else self.ranges[name]
            for name in names
        ]

    def _right_bits(self) -> int:
        """Of the right factors so far, and of those that the page still adds."""
        c = self._factors
        further = [1, c.third_triple, c.third_composed]
        return max(*(each.bits for each in self._rights()), *(x.bit_length() + 1 for x in further))

    def _find_ranges(self) -> None:
        """Of all factors and sums."""
        lefts = {step.left for task in self.tasks for step in task.steps}
        totals = (self.ranges[task.target] for task in self.tasks)
        self.left_range, self.right_range, self.total_range = (
            reduce(Interval.__or__, ranges, ZERO_RANGE)
            for ranges in ((self.ranges[name] for name in lefts), self._rights(), totals)
        )


def _cross(left: str, right: str, *, subtract: bool = False, digit: int = 0) -> Steps:
    """left × right, of dual vectors."""

    def of(a: str, b: str) -> list[Step]:
        return [
            Step(f"{left}.{a}", f"{right}.{b}", form, away, digit=digit)
            for form, away in ((Form.FORWARD, subtract), (Form.BACKWARD, not subtract))
        ]

    angle, velocity = HALVES
    return of(angle, angle), of(angle, velocity) + of(velocity, angle)


def _scaled(*terms: tuple[int, str], old: bool = False) -> Steps:
    """Multiples of dual vectors."""
    angle, velocity = (
        [Step(f"{name}.{half}", factor, old=old) for factor, name in terms] for half in HALVES
    )
    return angle, velocity


def _joined(*parts: Steps) -> Steps:
    """The sum."""
    angle, velocity = ([step for part in parts for step in part[i]] for i in range(2))
    return angle, velocity
