"""Matrices of three rows of exact rationals."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import TypeAlias

Row: TypeAlias = tuple[Fraction, Fraction, Fraction]
Matrix: TypeAlias = tuple[Row, Row, Row]


def inverse(m: Sequence[Sequence[Fraction]]) -> Matrix:
    """The inverse, by its cofactors.

    Raises:
        ZeroDivisionError: there is none.
    """

    def cofactor(i: int, j: int) -> Fraction:
        a, b = (i + 1) % 3, (i + 2) % 3
        c, d = (j + 1) % 3, (j + 2) % 3
        return m[a][c] * m[b][d] - m[a][d] * m[b][c]

    determinant = sum((m[0][j] * cofactor(0, j) for j in range(3)), Fraction(0))
    x, y, z = (
        (cofactor(0, i) / determinant, cofactor(1, i) / determinant, cofactor(2, i) / determinant)
        for i in range(3)
    )
    return x, y, z


def scaled(matrix: Matrix, factors: Sequence[Fraction]) -> Matrix:
    """Each row by a factor of its own."""
    x, y, z = (
        (factor * row[0], factor * row[1], factor * row[2])
        for factor, row in zip(factors, matrix, strict=True)
    )
    return x, y, z


def transposed(matrix: Matrix) -> Matrix:
    """Rows for columns."""
    x, y, z = ((row[0], row[1], row[2]) for row in zip(*matrix, strict=True))
    return x, y, z


def product(left: Matrix, right: Matrix) -> Matrix:
    """left right."""
    columns = transposed(right)
    x, y, z = ((dot(r, columns[0]), dot(r, columns[1]), dot(r, columns[2])) for r in left)
    return x, y, z


def dot(left: Sequence[Fraction], right: Sequence[Fraction]) -> Fraction:
    """The scalar product."""
    return sum((a * b for a, b in zip(left, right, strict=True)), Fraction(0))
