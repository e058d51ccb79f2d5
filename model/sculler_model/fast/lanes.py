"""Six integers side by side, in registers: what `kernel` computes with, compiled by Numba.

A `Six` is what the page writes as a pair of vectors: gyro x, y, z and accelerometer x, y, z, or
alpha and nu.  Its numbers have one or several limbs of 64 bits, the lowest first, and each limb of
all six is one vector of the processor (LLVM's <6 x i64>).  Numbers wrap modulo 2^64 a limb, as
the processor's do.

Where totals have one limb, products are the processor's, modulo 2^64.  Else the left factor is
taken in digits of 30 bits and the right one too, unless it is a count; a sum of four products of a
digit with a count or a digit then fits 63 bits and a sign, and such sums are put together with
carries.  That is quicker than the processor's products of 128 bits, one pair of numbers at a time.

The functions here are Numba *intrinsics*: each is told the types and gives the LLVM instructions.
`weighted` is made of them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any

from llvmlite import ir
from numba import njit, types
from numba.extending import intrinsic, models, register_model

DIGIT_BITS = 30
"""Of a digit: four products of a digit and a count of 32 bits stay below 2^63."""

LIMB_DIGITS = 2
"""Digits taken of a limb: a factor may have 60 bits a limb (`factor_limbs`)."""

TAP_BITS = 26
"""Of a digit of coefficients of several limbs: 32 products with counts stay below 2^63."""

_I64, _I32 = ir.IntType(64), ir.IntType(32)
_LANES = ir.VectorType(_I64, 6)

YZX, ZXY = (1, 2, 0, 4, 5, 3), (2, 0, 1, 5, 3, 4)
"""Orders of both vectors' components."""

Vector = Any
"""An LLVM value of type <6 x i64>."""

Builder = Any
"""What writes LLVM instructions."""


def factor_limbs(bits: int) -> int:
    """Limbs of a factor that has so many bits, where totals have several limbs."""
    return -(-bits // (LIMB_DIGITS * DIGIT_BITS))


class Six(types.Type):
    """Numba's type of six integers.

    Attributes:
        limbs: how many each has.
        count: whether they are counts, which fit 32 bits.
    """

    def __init__(self, limbs: int, count: bool = False) -> None:
        self.limbs, self.count = limbs, count
        super().__init__(name=f"Six({limbs}, {count})")


@register_model(Six)
class _SixModel(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: Six) -> None:
        super().__init__(manager, kind, ir.ArrayType(_LANES, kind.limbs))  # type: ignore[no-untyped-call]


def _same(number: int) -> Vector:
    return ir.Constant(_LANES, [ir.Constant(_I64, number)] * 6)


def _limbs(builder: Builder, six: Any) -> list[Vector]:
    return [builder.extract_value(six, i) for i in range(six.type.count)]


def _six(builder: Builder, limbs: Sequence[Vector]) -> Any:
    six = ir.Constant(ir.ArrayType(_LANES, len(limbs)), ir.Undefined)
    for i, limb in enumerate(limbs):
        six = builder.insert_value(six, limb, i)
    return six


def _picked(builder: Builder, x: Vector, *lanes: int, other: Vector = None) -> Vector:
    """Lanes of x, those from 6 on of `other`."""
    mask = ir.Constant(ir.VectorType(_I32, len(lanes)), [ir.Constant(_I32, i) for i in lanes])
    other = ir.Constant(x.type, ir.Undefined) if other is None else other
    return builder.shuffle_vector(x, other, mask)


def _extended(builder: Builder, limbs: Sequence[Vector], count: int) -> list[Vector]:
    """The same numbers in so many limbs."""
    if len(limbs) >= count:
        return [*limbs[:count]]
    sign = builder.ashr(limbs[-1], _same(63))
    return [*limbs, *[sign] * (count - len(limbs))]


def _sum(builder: Builder, a: Sequence[Vector], b: Sequence[Vector]) -> list[Vector]:
    """a + b, in as many limbs as a has."""
    found: list[Vector] = []
    over = None
    for x, y in zip(a, _extended(builder, b, len(a)), strict=True):
        total = builder.add(x, y)
        wrapped = builder.icmp_unsigned("<", total, x)
        if over is not None:
            carry = builder.zext(over, _LANES)
            total = builder.add(total, carry)
            wrapped = builder.or_(wrapped, builder.icmp_unsigned("<", total, carry))
        found.append(total)
        over = wrapped
    return found


def _shifted(builder: Builder, a: Sequence[Vector], bits: int) -> list[Vector]:
    """a 2^bits, for bits below 64."""
    found = [builder.shl(a[0], _same(bits))]
    for low, high in pairwise(a):
        moved = builder.lshr(low, _same(64 - bits))
        found.append(builder.or_(builder.shl(high, _same(bits)), moved))
    return found


def _digits(builder: Builder, limbs: Sequence[Vector], count: bool) -> list[Vector]:
    """Numbers in digits, the lowest first; the highest has the sign.  A count is one digit."""
    if count:
        # the compiler is told that it fits 32 bits, and takes the quicker product
        return [builder.ashr(builder.shl(limbs[0], _same(32)), _same(32))]
    found = []
    for i in range(LIMB_DIGITS * len(limbs)):
        limb, start = divmod(DIGIT_BITS * i, 64)
        last, highest = limb == len(limbs) - 1, i == LIMB_DIGITS * len(limbs) - 1
        digit = limbs[limb]
        if start:
            digit = (builder.ashr if last else builder.lshr)(digit, _same(start))
        if start > 64 - DIGIT_BITS and not last:
            digit = builder.or_(digit, builder.shl(limbs[limb + 1], _same(64 - start)))
        found.append(digit if highest else builder.and_(digit, _same((1 << DIGIT_BITS) - 1)))
    return found


def _joined(builder: Builder, places: Sequence[Sequence[Vector]], limbs: int) -> list[Vector]:
    """Numbers of their digits: the sum of those at each place, the lowest place first."""
    total: list[Vector] | None = None
    for digits in reversed(places):
        if total is not None:
            total = _shifted(builder, total, DIGIT_BITS)
        for digit in digits:
            number = _extended(builder, [digit], limbs)
            total = number if total is None else _sum(builder, total, number)
    assert total is not None
    return total


Multiply = Callable[[Builder, Vector, Vector], Vector]


def _multiplied(
    builder: Builder, kinds: tuple[Six, Six], a: Any, b: Any, limbs: int, multiply: Multiply
) -> list[Vector]:
    """What `multiply`, a sum of at most four products, makes of a and b, in so many limbs."""
    a, b = _limbs(builder, a), _limbs(builder, b)
    if limbs == 1:
        return [multiply(builder, a[0], b[0])]
    left, right = (_digits(builder, x, k.count) for x, k in zip((a, b), kinds, strict=True))
    places: list[list[Vector]] = [[] for _ in range(len(left) + len(right) - 1)]
    for i, x in enumerate(left):
        for j, y in enumerate(right):
            places[i + j].append(multiply(builder, x, y))
    return _joined(builder, places, limbs)


def _times(builder: Builder, left: Vector, right: Vector) -> Vector:
    return builder.mul(left, right)


def _crossed(builder: Builder, left: Vector, right: Vector) -> Vector:
    """[A x s | A x r + B x s] of [A | B] and [s | r]."""
    yzx_twice, zxy_twice = (1, 2, 0, 1, 2, 0), (2, 0, 1, 2, 0, 1)
    pair = builder.sub(
        builder.mul(_picked(builder, left, *YZX), _picked(builder, right, *zxy_twice)),
        builder.mul(_picked(builder, left, *ZXY), _picked(builder, right, *yzx_twice)),
    )
    # the two products of each component of A x r
    mixed = builder.mul(
        _picked(builder, left, 1, 2, 0, 2, 0, 1), _picked(builder, right, 5, 3, 4, 4, 5, 3)
    )
    first = _picked(builder, _same(0), 0, 1, 2, 6, 7, 8, other=mixed)
    second = _picked(builder, _same(0), 0, 1, 2, 9, 10, 11, other=mixed)
    return builder.sub(builder.add(pair, first), second)


def _crossed_over(builder: Builder, left: Vector, right: Vector) -> Vector:
    """[P x r | Q x s] of [P | Q] and [s | r]."""
    over = _picked(builder, right, 3, 4, 5, 0, 1, 2)
    return builder.sub(
        builder.mul(_picked(builder, left, *YZX), _picked(builder, over, *ZXY)),
        builder.mul(_picked(builder, left, *ZXY), _picked(builder, over, *YZX)),
    )


def _instructions(typed: Callable[..., Any]) -> Any:
    """A Numba intrinsic: `typed` takes types and gives the signature and what writes the code."""
    return intrinsic(typed)


def _adding(multiply: Multiply) -> Any:
    def add(_typing: Any, total: Six, a: Six, b: Six) -> Any:
        def code(_context: Any, builder: Builder, _signature: Any, args: Any) -> Any:
            found = _multiplied(builder, (a, b), args[1], args[2], total.limbs, multiply)
            return _six(builder, _sum(builder, _limbs(builder, args[0]), found))

        return total(total, a, b), code

    return add


add_crossed = _instructions(_adding(_crossed))
"""(total, [A | B], [s | r]): total + [A x s | A x r + B x s]."""

add_crossed_over = _instructions(_adding(_crossed_over))
"""(total, [P | Q], [s | r]): total + [P x r | Q x s]."""


@_instructions
def zero(_typing: Any, like: Any) -> Any:
    """Zeros of as many limbs as the tuple `like` has."""
    kind = Six(like.count)

    def code(_context: Any, builder: Builder, _signature: Any, _args: Any) -> Any:
        return _six(builder, [_same(0)] * kind.limbs)

    return kind(like), code


def _row(context: Any, builder: Builder, kind: Any, table: Any, t: Any) -> Vector:
    """Row t of an array (N, 6) of 32 or 64 bits."""
    start = builder.mul(t, ir.Constant(t.type, 6))
    at = builder.gep(context.make_array(kind)(context, builder, value=table).data, [start])
    item = ir.VectorType(context.get_data_type(kind.dtype), 6)
    row = builder.load(builder.bitcast(at, item.as_pointer()), align=kind.dtype.bitwidth // 8)
    return row if kind.dtype.bitwidth == 64 else builder.sext(row, _LANES)


@_instructions
def row(_typing: Any, counts: Any, t: Any) -> Any:
    """Row t of an array (N, 6) of counts."""

    def code(context: Any, builder: Builder, signature: Any, args: Any) -> Any:
        return _six(builder, [_row(context, builder, signature.args[0], *args)])

    return Six(1, count=True)(counts, t), code


@_instructions
def add_weighted(_typing: Any, total: Six, terms: Any, i: Any, counts: Any, t: Any) -> Any:
    """total + c s[t - d] with d, c of row i of an array (T, 2)."""

    def code(context: Any, builder: Builder, signature: Any, args: Any) -> Any:
        total, terms, i, counts, t = args
        data = context.make_array(signature.args[1])(context, builder, value=terms).data
        at = builder.gep(data, [builder.mul(i, ir.Constant(i.type, 2))])
        d, c = (builder.load(builder.gep(at, [ir.Constant(_I64, j)])) for j in (0, 1))
        samples = _row(context, builder, signature.args[3], counts, builder.sub(t, d))
        first = builder.insert_element(ir.Constant(_LANES, ir.Undefined), c, ir.Constant(_I32, 0))
        product = builder.mul(_picked(builder, first, *[0] * 6), samples)
        return _six(builder, _sum(builder, _limbs(builder, total), [product]))

    return total(total, terms, i, counts, t), code


@_instructions
def append_digit(_typing: Any, number: Six, digit: Six) -> Any:
    """number 2^TAP_BITS + digit; with one limb the digit, which is the number."""

    def code(_context: Any, builder: Builder, _signature: Any, args: Any) -> Any:
        limbs, digit = (_limbs(builder, each) for each in args)
        if len(limbs) == 1:
            return _six(builder, digit)
        return _six(builder, _sum(builder, _shifted(builder, limbs, TAP_BITS), digit))

    return number(number, digit), code


@_instructions
def plus(_typing: Any, total: Six, x: Six) -> Any:
    """total + x."""

    def code(_context: Any, builder: Builder, _signature: Any, args: Any) -> Any:
        return _six(builder, _sum(builder, *(_limbs(builder, each) for each in args)))

    return total(total, x), code


@_instructions
def add_scaled(_typing: Any, total: Six, x: Six, gyro: Any, accel: Any) -> Any:
    """total + [gyro | accel] x, with factors of less than DIGIT_BITS bits and a sign."""

    def code(_context: Any, builder: Builder, _signature: Any, args: Any) -> Any:
        factors = ir.Constant(_LANES, ir.Undefined)
        for lane in range(6):
            at = ir.Constant(_I32, lane)
            factors = builder.insert_element(factors, args[2 + lane // 3], at)
        kinds = (x, Six(1, count=True))
        found = _multiplied(builder, kinds, args[1], _six(builder, [factors]), total.limbs, _times)
        return _six(builder, _sum(builder, _limbs(builder, args[0]), found))

    return total(total, x, gyro, accel), code


@_instructions
def halves_added(_typing: Any, x: Six) -> Any:
    """[a + b | a + b] of [a | b]."""

    def code(_context: Any, builder: Builder, _signature: Any, args: Any) -> Any:
        limbs = _limbs(builder, args[0])
        other = [_picked(builder, limb, 3, 4, 5, 0, 1, 2) for limb in limbs]
        return _six(builder, _sum(builder, limbs, other))

    return x(x), code


@_instructions
def outside(_typing: Any, flags: Six, x: Six, low: Six, high: Six) -> Any:
    """flags, made negative where x < low or x > high."""

    def code(_context: Any, builder: Builder, _signature: Any, args: Any) -> Any:
        (flags,), (x,), (low,), (high,) = (_limbs(builder, each) for each in args)
        beyond = builder.or_(builder.sub(x, low), builder.sub(high, x))
        return _six(builder, [builder.or_(flags, beyond)])

    return flags(flags, x, low, high), code


@_instructions
def any_negative(_typing: Any, flags: Six) -> Any:
    """Whether one of the six is below 0."""

    def code(_context: Any, builder: Builder, _signature: Any, args: Any) -> Any:
        negative = builder.icmp_signed("<", _limbs(builder, args[0])[0], _same(0))
        bits = builder.bitcast(negative, ir.IntType(6))
        return builder.icmp_unsigned("!=", bits, ir.Constant(bits.type, 0))

    return types.boolean(flags), code


def _store(builder: Builder, vector: Any, at: Any) -> None:
    builder.store(vector, builder.bitcast(at, vector.type.as_pointer()), align=8)


def _putting(first: int) -> Any:
    def put(_typing: Any, results: Any, r: Any, column: Any, x: Six, like: Any) -> Any:
        def code(context: Any, builder: Builder, signature: Any, args: Any) -> Any:
            results, r, column, x, _ = args
            array = context.make_array(signature.args[0])(context, builder, value=results)
            columns, words = builder.extract_value(array.shape, 1), like.count
            place = builder.add(builder.mul(r, columns), column)
            at = builder.gep(array.data, [builder.mul(place, ir.Constant(_I64, words))])
            limbs = _extended(builder, _limbs(builder, x), words)
            lanes = range(first, first + 3)
            if words == 1:
                _store(builder, _picked(builder, limbs[0], *lanes), at)
            elif words == 2:
                both = [lane + 6 * word for lane in lanes for word in (0, 1)]
                _store(builder, _picked(builder, limbs[0], *both, other=limbs[1]), at)
            else:
                for i, lane in enumerate(lanes):
                    for word, limb in enumerate(limbs):
                        number = builder.extract_element(limb, ir.Constant(_I32, lane))
                        to = ir.Constant(_I64, i * words + word)
                        builder.store(number, builder.gep(at, [to]))
            return context.get_dummy_value()

        return types.void(results, r, column, x, like), code

    return put


put_left = _instructions(_putting(0))
"""(results, r, column, [a | b], like): a into results[r, column:column + 3], in like's limbs."""

put_right = _instructions(_putting(3))
"""The same with b."""


@njit(inline="always")
def weighted(like, terms, digits, start, stop, counts, t):  # type: ignore[no-untyped-def]
    """The sum of the terms start..stop-1 of every digit, at sample t: a row of a table."""
    each = len(terms) // digits
    total = zero(like)
    for digit in range(digits):
        part = zero((0,))
        for i in range(digit * each + start, digit * each + stop):
            part = add_weighted(part, terms, i, counts, t)
        total = append_digit(total, part)
    return total
