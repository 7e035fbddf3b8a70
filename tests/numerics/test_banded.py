"""Banded factors against a dense solution."""

import numpy as np
import pytest

from eventpound.numerics.banded import factor_banded, solve_banded

pytestmark = pytest.mark.usefixtures("interpreted")
EPS = np.finfo(float).eps


def _stiffness_matrix(rng: np.random.Generator, n: int, width: int) -> np.ndarray:
    """Masses on the diagonal and springs between those not further apart than `width`."""
    A = np.diag(10.0 ** rng.uniform(-2, 2, n))
    for i in range(n):
        for j in range(max(0, i - width), i):
            k = 10.0 ** rng.uniform(-3, 3) * (rng.random() < 0.8)
            A[np.ix_([i, j], [i, j])] += k * np.array([[1.0, -1.0], [-1.0, 1.0]])
    return A


def _band(A: np.ndarray, width: int) -> np.ndarray:
    band = np.zeros((len(A), width + 1))
    for i in range(len(A)):
        for d in range(min(width, i) + 1):
            band[i, d] = A[i, i - d]
    return band


@pytest.mark.parametrize(("n", "width"), [(1, 0), (2, 1), (7, 1), (9, 3), (6, 5), (40, 2)])
def test_solves_what_a_dense_solver_solves(n, width):
    rng = np.random.default_rng(10 * n + width)
    for _ in range(10):
        A, x = _stiffness_matrix(rng, n, width), rng.normal(size=n)
        band, solution = _band(A, width), A @ x
        assert factor_banded(band)
        solve_banded(band, solution)
        # Backward stable for a positive definite matrix: the residual is rounding.
        size = np.abs(A).sum(axis=1).max() * max(np.abs(solution).max(), np.abs(x).max())
        assert np.abs(A @ solution - A @ x).max() <= 10 * n * EPS * size


def test_factors_are_those_of_the_matrix():
    rng = np.random.default_rng(3)
    A = _stiffness_matrix(rng, 8, 2)
    band = _band(A, 2)
    assert factor_banded(band)
    L = np.eye(8)
    for i in range(8):
        for d in range(1, min(2, i) + 1):
            L[i, i - d] = band[i, d]
    np.testing.assert_allclose(L @ np.diag(band[:, 0]) @ L.T, A, rtol=0, atol=1e-13 * A.max())


def test_what_is_not_positive_definite_is_said():
    A = np.array([[1.0, 2.0], [2.0, 1.0]])
    assert not factor_banded(_band(A, 1))
    assert not factor_banded(np.array([[np.nan]]))
