"""The width of the smooth sign: where to start, and within what it moves."""

from dataclasses import replace

import numpy as np

from jaxswarm.identify.estimation.least_squares import fit, weighted_cost
from jaxswarm.identify.forward.measuring_chain import term_block
from jaxswarm.identify.forward.regression import build_regression

# Widths as parts of the typical speed: tried at the start, and the range for the refinement. A sharp
# sign is one that no sample sees.
_SHARP, _FROM, _TO, _COUNT = 1e-6, 1e-3, 0.2, 12
_RANGE = (3e-4, 0.4)


def typical_speed(motions) -> float:
    """Median RMS speed of the logs [rad/s or m/s]."""
    return float(np.median([np.sqrt(np.mean(m.dq**2)) for m in motions]))


def width_range(motions) -> tuple[float, float]:
    """Least and largest width of the refinement."""
    return tuple(part * typical_speed(motions) for part in _RANGE)


def best_width(robot, terms, motions, rigids, pi=None) -> float:
    """The width of the smooth sign with the smallest weighted residual, from sharp to a fifth of the speed."""
    speed = typical_speed(motions)
    if not any(t.law.uses_direction for t in terms):
        return max(0.01 * speed, 1e-6)
    speed_grid = speed * np.concatenate([[_SHARP], np.geomspace(_FROM, _TO, _COUNT)])
    pi = np.zeros(10 * robot.num_joints) if pi is None else pi
    regression = build_regression(robot, terms, motions, 0.01 * speed, pi, rigids)
    costs, sigma = [], None
    for width in speed_grid:
        columns = regression.columns.copy()
        k = 10 * robot.num_joints
        for term in terms:
            size = len(term.columns(robot.joints))
            if term.law.uses_direction:
                columns[:, :, k : k + size] = np.concatenate(
                    [
                        term_block(robot, terms, term, m, float(width), pi, r)
                        for m, r in zip(motions, rigids, strict=True)
                    ]
                )
            k += size
        solution = fit(replace(regression, columns=columns), sigma=sigma)
        sigma = solution.sigma if sigma is None else sigma
        costs.append(weighted_cost(solution.residual, sigma))
    grid = speed_grid
    best = int(np.argmin(costs))
    if 1 < best < len(grid) - 1:
        # Vertex of the parabola through the three best points, in the logarithm of the width.
        x, y = np.log(grid[best - 1 : best + 2]), np.array(costs[best - 1 : best + 2])
        a, b, _ = np.polyfit(x - x[1], y, 2)
        return float(np.exp(x[1] - b / (2 * a))) if a > 0 else float(grid[best])
    return float(grid[best])
