"""The two steps of a Kalman filter whose readings are some of its states, compiled."""

import math
from typing import Any

import numpy as np

from swamp_rl.physics.compile import compiled


@compiled
def propagated(P: Any, F: Any, walk: Any, dt: float) -> Any:
    """Covariance (n, n) after a step of Jacobian F (n, n): F P Fᵀ + diag(walk²) dt."""
    n = P.shape[0]
    moved, out = np.empty((n, n)), np.empty((n, n))
    for i in range(n):
        for j in range(n):
            total = 0.0
            for k in range(n):
                total += F[i, k] * P[k, j]
            moved[i, j] = total
    for i in range(n):
        for j in range(i + 1):
            total = walk[i] * walk[i] * dt if i == j else 0.0
            for k in range(n):
                total += moved[i, k] * F[j, k]
            out[i, j] = total
            out[j, i] = total
    return out


@compiled
def updated(P: Any, places: Any, deviations: Any) -> Any:
    """Covariance S (m, m) of the innovation of the states `places` (m,), read with `deviations`
    (m,); its whitener W (m, m), W S Wᵀ = 1; the gain P Hᵀ S⁻¹ (n, m); P (n, n) afterwards, in Joseph's form.
    """
    n, m = P.shape[0], places.shape[0]
    S, W, gain = np.empty((m, m)), np.zeros((m, m)), np.empty((n, m))
    lower = np.zeros((m, m))
    for i in range(m):
        for j in range(m):
            S[i, j] = P[places[i], places[j]]
        S[i, i] += deviations[i] * deviations[i]
    for i in range(m):
        for j in range(i + 1):
            total = S[i, j]
            for k in range(j):
                total -= lower[i, k] * lower[j, k]
            lower[i, j] = math.sqrt(total) if i == j else total / lower[j, j]
    for j in range(m):
        for i in range(j, m):
            total = 1.0 if i == j else 0.0
            for k in range(j, i):
                total -= lower[i, k] * W[k, j]
            W[i, j] = total / lower[i, i]
    half = np.empty(m)
    for row in range(n):
        for i in range(m):
            half[i] = 0.0
            for k in range(i + 1):
                half[i] += W[i, k] * P[row, places[k]]
        for j in range(m):
            gain[row, j] = 0.0
            for i in range(j, m):
                gain[row, j] += half[i] * W[i, j]
    return S, W, gain, joseph(P, places, deviations, gain)


@compiled
def joseph(P: Any, places: Any, deviations: Any, gain: Any) -> Any:
    """(1 − K H) P (1 − K H)ᵀ + K R Kᵀ: symmetric and positive whatever the gain K (n, m)."""
    n, m = P.shape[0], places.shape[0]
    kept, out = np.empty((n, n)), np.empty((n, n))
    for i in range(n):
        for j in range(n):
            kept[i, j] = P[i, j]
            for k in range(m):
                kept[i, j] -= gain[i, k] * P[places[k], j]
    for i in range(n):
        for j in range(i + 1):
            total = kept[i, j]
            for k in range(m):
                noise = deviations[k] * deviations[k] * gain[i, k]
                total += (noise - kept[i, places[k]]) * gain[j, k]
            out[i, j] = total
            out[j, i] = total
    return out
