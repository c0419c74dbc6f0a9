"""The RX60 paper's numbers: its tables of estimates, and what its text leaves to be reconstructed."""

import numpy as np

NAMES = (
    "Czz1", "Axx2", "Byy2", "Czz2", "D2", "E2", "F2", "Axx3", "Byy3", "Czz3", "D3", "E3", "F3",
)  # fmt: skip
TRUE = np.array(
    [5.0091, 1.279, 2.4129, 5.0991, -0.0405, -0.0498, 0.2143,
     0.2394, 1.3125, 0.5472, 0.0057, -0.0066, -0.4939]
)  # fmt: skip
NOISE = {"motion": 0.01, "torque": 0.1}  # standard deviations; rad, rad/s, rad/s^2 alike, and N m
CASES = (("gpso", "clean"), ("aelspso", "clean"), ("gpso", "noisy"), ("aelspso", "noisy"))

MEAN = {
    ("gpso", "noisy"): (4.95, 1.05, 2.11, 5.08, -0.04, -0.03, 0.2, 0.65, 1.74, 0.55, 0.004, -0.01, 0.5),
    ("gpso", "clean"): (5.05, 0.8, 1.87, 5.08, -0.04, -0.06, 0.22, 0.81, 1.9, 0.55, 0.01, -0.01, 0.49),
    ("aelspso", "noisy"): (4.94, 1.21, 2.32, 5.06, -0.03, -0.24, 0.15, 0.48, 1.49, 0.55, 0.01, 0.03, 0.46),
    ("aelspso", "clean"): (4.79, 1.0, 2.16, 5.14, -0.07, 0.08, 0.16, 0.86, 1.96, 0.54, 0.02, -0.03, 0.46),
}  # fmt: skip
STD = {
    ("gpso", "noisy"): (0.82, 0.51, 0.59, 0.03, 0.01, 0.06, 0.01, 0.45, 0.45, 0.002, 0.002, 0.01, 0.004),
    ("gpso", "clean"): (0.52, 0.59, 0.55, 0.05, 0.01, 0.14, 0.03, 0.53, 0.54, 0.005, 0.003, 0.03, 0.01),
    ("aelspso", "noisy"): (0.45, 0.54, 0.68, 0.2, 0.1, 0.35, 0.09, 0.36, 0.51, 0.03, 0.03, 0.07, 0.03),
    ("aelspso", "clean"): (0.45, 0.5, 0.43, 0.12, 0.07, 0.21, 0.13, 0.38, 0.4, 0.03, 0.04, 0.04, 0.08),
}  # fmt: skip
FBEST = {
    ("gpso", "noisy"): (0.2102, 0.0001),
    ("gpso", "clean"): (0.0161, 0.0075),
    ("aelspso", "noisy"): (0.2188, 0.007),
    ("aelspso", "clean"): (0.0657, 0.0179),
}
RAE = {
    ("gpso", "noisy"): (0.0434, 0.009, 0.0145),
    ("gpso", "clean"): (0.0275, 0.0066, 0.0062),
    ("aelspso", "noisy"): (0.3062, 0.0187, 0.0358),
    ("aelspso", "clean"): (0.2112, 0.0137, 0.0276),
}

RECONSTRUCTIONS = (
    "the DH table is read in the modified (Craig) convention; J = [[A, -F, -E], [-F, B, -D], "
    "[-E, -D, C]]; the paper prints F3 with both signs",
    "the reference trajectory lost symbols: read as q1 = c pi sin(pi t/4), q2 = c pi cos(pi t/4), "
    "q3 = r cos(pi t/4); two further readings are carried along",
    "the validation trajectory is the same with c = 0.4, r = 0.9",
    "the fitness is sqrt(sum over joints of the mean squared torque error): with it the noise floor "
    "lies at 0.199 to 0.217 for the three readings, and the paper's noisy fbest is 0.2102",
    "bounds are not printed: moments of inertia in [0, 6] kg m^2, products in [-1, 1] kg m^2",
    "24 particles and 2000 iterations, c1 = c2 = 2, velocity limit 20 % of the range, reflecting walls",
    "gravity is absent; one noise realization for all ten runs, as the printed spread of fbest suggests",
    "AELSPSO: no gate, a failed trial is discarded, distances in units of the ranges",
)
