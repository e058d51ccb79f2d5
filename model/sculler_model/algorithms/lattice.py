"""The best integers near real ones: the closest vector of a lattice.

Rounding each coefficient to the nearest integer ignores that their errors add up in the residual,
where they can be made to cancel.  With the fit's quadratic form G, the loss of an integer vector k
is (k - x)ᵀ G (k - x), so the best one is the lattice point closest to x in the norm of G.  The
basis is reduced (Lenstra, Lenstra, Lovász), then all points inside the ball of the best one so far
are searched (Schnorr, Euchner), which ends with the closest.
"""

from __future__ import annotations

from decimal import ROUND_HALF_EVEN, Decimal

Matrix = list[list[Decimal]]

LOVASZ = Decimal("0.99")


def nearest(value: Decimal) -> int:
    """Nearest integer, ties to even."""
    return int(value.to_integral_value(ROUND_HALF_EVEN))


def closest_integers(form: Matrix, target: list[Decimal]) -> list[int]:
    """Integers k with the least (k - target)ᵀ form (k - target).

    Args:
        form: m × m, symmetric, positive definite within the current decimal precision.
        target: m reals.
    """
    size = len(target)
    basis, gram = _reduce(form)
    # target in the reduced basis: its integer part first, so that the search works near zero
    mu, lengths = _orthogonal(gram)
    offset = [nearest(x) for x in target]
    rest = [x - k for x, k in zip(target, offset, strict=True)]
    projected = [
        sum(
            (b * form[i][j] * rest[j] for i, b in enumerate(row) if b for j in range(size)),
            Decimal(0),
        )
        for row in basis
    ]
    # solve gram y = projected, by gram = L diag(lengths) Lᵀ with L = mu
    forward: list[Decimal] = []
    for i in range(size):
        forward.append(projected[i] - sum((mu[i][j] * forward[j] for j in range(i)), Decimal(0)))
    y = [value / length for value, length in zip(forward, lengths, strict=True)]
    for i in reversed(range(size)):
        y[i] -= sum((mu[j][i] * y[j] for j in range(i + 1, size)), Decimal(0))
    point = search(mu, lengths, y)
    return [
        offset[i] + sum(c * row[i] for c, row in zip(point, basis, strict=True))
        for i in range(size)
    ]


def _orthogonal(gram: Matrix) -> tuple[Matrix, list[Decimal]]:
    """gram = mu diag(lengths) muᵀ, mu lower triangular with ones."""
    size = len(gram)
    mu = [[Decimal(0)] * size for _ in range(size)]
    lengths: list[Decimal] = []
    for k in range(size):
        _orthogonal_row(gram, mu, lengths, k)
    return mu, lengths


def _orthogonal_row(gram: Matrix, mu: Matrix, lengths: list[Decimal], k: int) -> None:
    """Row k of `_orthogonal`, the rows before it known."""
    inner: list[Decimal] = []
    for j in range(k + 1):
        value = gram[k][j] - sum((mu[j][i] * inner[i] for i in range(j)), Decimal(0))
        inner.append(value)
        mu[k][j] = value / lengths[j] if j < k else Decimal(1)
    # lengths[k] = inner_k with mu_kj inner_j taken off, which the loop's last value lacks
    length = gram[k][k] - sum((mu[k][j] * inner[j] for j in range(k)), Decimal(0))
    lengths[k:] = [length]


def _reduce(form: Matrix) -> tuple[list[list[int]], Matrix]:
    """A reduced basis of the integers, and its Gram matrix in the form."""
    size = len(form)
    basis = [[int(i == j) for j in range(size)] for i in range(size)]
    gram = [list(row) for row in form]
    mu = [[Decimal(0)] * size for _ in range(size)]
    lengths: list[Decimal] = []
    _orthogonal_row(gram, mu, lengths, 0)
    k = 1
    while k < size:
        _orthogonal_row(gram, mu, lengths, k)
        for j in reversed(range(k)):
            q = nearest(mu[k][j])
            if q:
                basis[k] = [x - q * y for x, y in zip(basis[k], basis[j], strict=True)]
                gram[k] = [x - q * y for x, y in zip(gram[k], gram[j], strict=True)]
                for row in gram:
                    row[k] -= q * row[j]
                mu[k] = [x - q * y for x, y in zip(mu[k], mu[j], strict=True)]
        if lengths[k] >= (LOVASZ - mu[k][k - 1] ** 2) * lengths[k - 1]:
            k += 1
            continue
        basis[k - 1], basis[k] = basis[k], basis[k - 1]
        gram[k - 1], gram[k] = gram[k], gram[k - 1]
        for row in gram:
            row[k - 1], row[k] = row[k], row[k - 1]
        k -= 1
        if k == 0:
            _orthogonal_row(gram, mu, lengths, 0)
            k = 1
    return basis, gram


def search(mu: Matrix, lengths: list[Decimal], y: list[Decimal]) -> list[int]:
    """Integers c with the least Σ_j lengths_j (c_j - y_j + Σ_{i>j} mu_ij (c_i - y_i))²."""
    size = len(y)
    best: list[int] = []
    least = Decimal("Infinity")
    chosen = [0] * size

    def descend(j: int, spent: Decimal) -> None:
        nonlocal best, least
        if j < 0:
            best, least = list(chosen), spent
            return
        center = y[j] - sum((mu[i][j] * (chosen[i] - y[i]) for i in range(j + 1, size)), Decimal(0))
        first = nearest(center)
        side = 1 if center >= first else -1
        for step in range(1 << 30):  # first, then outwards on both sides in turn
            away = (step + 1) // 2 * (side if step % 2 else -side)
            cost = spent + lengths[j] * (first + away - center) ** 2
            if cost >= least:
                return
            chosen[j] = first + away
            descend(j - 1, cost)

    descend(size - 1, Decimal(0))
    return best
