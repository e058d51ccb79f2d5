"""Third and fourth order in the compact core: the page's letters as numbers in its memories.

The page is `algorithms.higher_order`.  Its products stand in the order that needs no number on both
sides of the multiplier, for a left factor stands in the left memory and a right one in the right:

    kappa    = A × s, of this minor interval alone            as coming samples have work
    P        = alpha × theta                                  alpha before it takes theta
    b        = 6 within + 3 Dc between + Dc P                 k = 6 kappa + Dc P
    X        = b × theta + alpha × k
    tau      = (c × theta) × theta + (m × theta) × l
    p        = P × theta                                      q = alpha × P
    g        = 6 third + 2 f X - 2 f Dc p + f Dc q
    h        = 6 t tau + 2 f X + f Dc p - 2 f Dc q
    sigma    = -((f × theta) × theta) × theta
    fourth  += u sigma + y (g × theta + alpha × h) + e b × k
    third   += t tau + f X
    within  += kappa       between += P

Each letter is a dual vector.  In a major interval's first minor interval all that came before
counts as 0.  Only P is wanted on both sides and stands in both memories.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple

from sculler_hdl.plan.compact.instructions import (
    Block,
    Memory,
    Number,
    ProductTerm,
    When,
    digits_reached,
)
from sculler_model.design import AXES, Design, DualRange

if TYPE_CHECKING:
    from sculler_hdl.plan.compact.compiler import Compiler


class Letter(NamedTuple):
    """A dual vector: its components' numbers."""

    angle: list[Number]
    velocity: list[Number]


Cross = tuple[Letter, Letter, When]
"""left × right, whose left counts as 0 unless `When`."""

Scaled = tuple[int, Letter, When]
"""A factor and what it multiplies."""


class HigherOrderCompiler:
    """Writes the blocks of the terms of third and fourth order.

    Args:
        compiler: of the design.
    """

    def __init__(self, compiler: Compiler) -> None:
        self._compiler, self._map = compiler, compiler.map
        self.design: Design = compiler.design
        words = self.design.words.higher
        assert words is not None
        self._words = words
        memory = self._map
        self.theta = Letter(memory.theta, memory.v)
        self.alpha = self._state("alpha", "nu")
        self.within = self._state("coning_within", "sculling_within")
        self.between = self._state("coning_between", "sculling_between")
        self.third = self._state("coning_third", "sculling_third")
        # a sum of products of taps and samples, over several phases
        samples = Letter(memory.samples("s", 0), memory.samples("r", 0))
        tapped = Letter(memory.A, memory.B)
        self._tapped = (tapped, samples, When.ALWAYS)
        products = self._cross_terms([self._tapped])
        self.kappa = self._placed("kappa", words.kappa, memory.left, products)

    def within_products(self, first: bool) -> Iterator[Block]:
        """kappa += A × s, or = in the first phase that has work."""
        terms = self._cross_terms([self._tapped])
        for total, products in zip(_components(self.kappa), terms, strict=True):
            before = [] if first else [ProductTerm(total, self._map.unity)]
            yield self._compiler.sum_of(total, [*before, *products])

    def minor_end(self) -> Iterator[Block]:
        """All that a minor interval's end asks for, but theta, v, and what alpha and nu take."""
        later = self.design.algorithm.minors > 1
        c = self.design.composition
        third: list[Scaled] = []
        tau = yield from self._tau()
        if tau is not None:
            third.append((c.third_triple, tau, When.ALWAYS))
        if self.design.order > 3:
            yield from self._fourth(tau)
        elif later:
            yield from self._before()
        if later:
            third.append((c.third_composed, self.X, When.ALWAYS))
        yield from self._accumulated("coning_third", "sculling_third", third)
        for within, kappa in zip(_components(self.within), _components(self.kappa), strict=True):
            add = ProductTerm(kappa, self._map.unity)
            yield self._compiler.accumulated(within, [add], When.CONTINUED)
        if later:
            between = [(1, self.P, When.ALWAYS)]
            yield from self._accumulated("coning_between", "sculling_between", between)

    def _before(self) -> Iterator[Block]:
        """P, b, k and X, of minor intervals that follow others."""
        Dc, memory = self.design.composition.within, self._map
        continued, words = When.CONTINUED, self._words
        self.P = yield from self._product(
            "P", words.P, memory.right, [(self.alpha, self.theta, continued)]
        )
        self.b = yield from self._sum(
            "b",
            words.b,
            memory.left,
            [
                (6, self.within, continued),
                (3 * Dc, self.between, continued),
                (Dc, self.P, When.ALWAYS),
            ],
        )
        self.k = yield from self._sum(
            "k",
            words.k,
            memory.right,
            [(6, self.kappa, When.ALWAYS), (Dc, self.P, When.ALWAYS)],
        )
        # in a major interval's first minor interval b is 0 as all before it is
        self.X = yield from self._product(
            "X",
            words.X,
            memory.right,
            [(self.b, self.theta, When.ALWAYS), (self.alpha, self.k, continued)],
        )

    def _tau(self) -> Generator[Block, None, Letter | None]:
        """θ×(θ×c) + l×(θ×m); None of a single sample."""
        taps, words, memory = self.design.composition.taps, self._words, self._map
        if taps.third_is_zero:
            return None
        products: list[Cross] = []
        if any(taps.curvature):
            c = yield from self._weighted("c", words.c, memory.left, taps.curvature)
            inner = yield from self._product(
                "c_theta", words.theta_c, memory.left, [(c, self.theta, When.ALWAYS)]
            )
            products.append((inner, self.theta, When.ALWAYS))
        m = yield from self._weighted("m", words.m, memory.left, taps.partner)
        slope = yield from self._weighted("l", words.slope, memory.right, taps.slope)
        inner = yield from self._product(
            "m_theta", words.theta_m, memory.left, [(m, self.theta, When.ALWAYS)]
        )
        products.append((inner, slope, When.ALWAYS))
        tau = yield from self._product("tau", words.tau, memory.right, products)
        return tau

    def _fourth(self, tau: Letter | None) -> Iterator[Block]:
        """What `fourth` takes, g and h with `third` as it was before."""
        c, words, memory = self.design.composition, self._words, self._map
        fourth: list[Scaled] = []
        if tau is not None:
            f = yield from self._weighted("f", words.f, memory.left, c.taps.fourth)
            once = yield from self._product(
                "f_theta", words.theta_f, memory.left, [(f, self.theta, When.ALWAYS)]
            )
            twice = yield from self._product(
                "f_theta_theta", words.theta_theta_f, memory.left, [(once, self.theta, When.ALWAYS)]
            )
            minus_sigma = yield from self._product(
                "-sigma", _negative(words.sigma), memory.right, [(twice, self.theta, When.ALWAYS)]
            )
            fourth.append((-c.fourth_inner, minus_sigma, When.ALWAYS))
        if self.design.algorithm.minors > 1:
            yield from self._before()
            outer = yield from self._outer(tau)
            pairs = yield from self._product(
                "b_k", words.pairs, memory.right, [(self.b, self.k, When.ALWAYS)]
            )
            fourth.append((c.fourth_outer, outer, When.ALWAYS))
            fourth.append((c.fourth_pairs, pairs, When.ALWAYS))
        yield from self._accumulated("coning_fourth", "sculling_fourth", fourth)

    def _outer(self, tau: Letter | None) -> Generator[Block, None, Letter]:
        """g × theta + alpha × h."""
        c, words, memory = self.design.composition, self._words, self._map
        f, Dc, always = c.third_composed, c.within, When.ALWAYS
        left = yield from self._sum("P_left", words.P, memory.left, [(1, self.P, always)])
        p = yield from self._product("p", words.p, memory.right, [(left, self.theta, always)])
        q = yield from self._product(
            "q", words.q, memory.right, [(self.alpha, self.P, When.CONTINUED)]
        )
        shared: list[Scaled] = [(2 * f, self.X, always)]
        g = yield from self._sum(
            "g",
            words.g,
            memory.left,
            [
                (6, self.third, When.CONTINUED),
                *shared,
                (-2 * f * Dc, p, always),
                (f * Dc, q, always),
            ],
        )
        inside: list[Scaled] = [] if tau is None else [(6 * c.third_triple, tau, always)]
        h = yield from self._sum(
            "h",
            words.h,
            memory.right,
            [*inside, *shared, (f * Dc, p, always), (-2 * f * Dc, q, always)],
        )
        outer = yield from self._product(
            "outer",
            words.outer,
            memory.right,
            [(g, self.theta, always), (self.alpha, h, When.CONTINUED)],
        )
        return outer

    def _state(self, angle: str, velocity: str) -> Letter:
        return Letter(self._map.accumulator(angle), self._map.accumulator(velocity))

    def _placed(
        self, name: str, words: DualRange, memory: Memory, terms: Sequence[Sequence[ProductTerm]]
    ) -> Letter:
        """Memory for a letter, each component of as many digits as its terms reach, or more."""
        names = [f"{name}_{axis}" for axis in AXES] + [f"{name}v_{axis}" for axis in AXES]
        ranges = [words.angle] * 3 + [words.velocity] * 3
        numbers = [
            self._map.placed(each, number, memory, digits_reached(products))
            for each, number, products in zip(names, ranges, terms, strict=True)
        ]
        return Letter(numbers[:3], numbers[3:])

    def _cross_terms(self, products: Sequence[Cross]) -> list[list[ProductTerm]]:
        """The products of each component: angle x, y, z, velocity x, y, z."""
        angle: list[list[ProductTerm]] = [[], [], []]
        velocity: list[list[ProductTerm]] = [[], [], []]
        for a, b, when in products:
            for total, left, right in (
                (angle, a.angle, b.angle),
                (velocity, a.angle, b.velocity),
                (velocity, a.velocity, b.angle),
            ):
                for axis in range(3):
                    y, z = (axis + 1) % 3, (axis + 2) % 3
                    total[axis].append(ProductTerm(left[y], right[z], when=when))
                    total[axis].append(ProductTerm(left[z], right[y], subtract=True, when=when))
        return [*angle, *velocity]

    def _product(
        self, name: str, words: DualRange, memory: Memory, products: Sequence[Cross]
    ) -> Generator[Block, None, Letter]:
        """A new letter: the sum of cross products."""
        terms = self._cross_terms(products)
        letter = self._placed(name, words, memory, terms)
        for total, each in zip(_components(letter), terms, strict=True):
            yield self._compiler.sum_of(total, each)
        return letter

    def _sum(
        self, name: str, words: DualRange, memory: Memory, scaled: Sequence[Scaled]
    ) -> Generator[Block, None, Letter]:
        """A new letter: a weighted sum of others."""
        terms = self._scaled_terms(scaled)
        letter = self._placed(name, words, memory, terms)
        for total, each in zip(_components(letter), terms, strict=True):
            yield self._compiler.sum_of(total, each)
        return letter

    def _scaled_terms(self, scaled: Sequence[Scaled]) -> list[list[ProductTerm]]:
        """factor × component, the factor on the side where the letter is not."""
        terms: list[list[ProductTerm]] = [[] for _ in range(6)]
        for factor, letter, when in scaled:
            for each, number in zip(terms, _components(letter), strict=True):
                if self._map.is_left(number):
                    term = ProductTerm(number, self._map.right_factor(factor), when=when)
                else:
                    assert when is When.ALWAYS
                    term = ProductTerm(self._map.coefficient(factor), number)
                each.append(term)
        return terms

    def _weighted(
        self, name: str, words: DualRange, memory: Memory, weights: Sequence[int]
    ) -> Generator[Block, None, Letter]:
        """A new letter: a weighted sum of samples."""
        row = [(d, w) for d, w in enumerate(weights) if w]
        terms = [
            [
                ProductTerm(self._map.coefficient(w), self._map.sample(sensor, axis, d))
                for d, w in row
            ]
            for sensor in "sr"
            for axis in range(3)
        ]
        letter = self._placed(name, words, memory, terms)
        yield from self._compiler.weighted_sums(letter.angle, "s", row)
        yield from self._compiler.weighted_sums(letter.velocity, "r", row)
        return letter

    def _accumulated(self, angle: str, velocity: str, scaled: Sequence[Scaled]) -> Iterator[Block]:
        """A result += a weighted sum of letters."""
        terms = self._scaled_terms(scaled)
        states = _components(self._state(angle, velocity))
        for state, each in zip(states, terms, strict=True):
            yield self._compiler.accumulated(state, each, When.CONTINUED)


def _components(letter: Letter) -> list[Number]:
    return [*letter.angle, *letter.velocity]


def _negative(words: DualRange) -> DualRange:
    return DualRange(-words.angle, -words.velocity)
