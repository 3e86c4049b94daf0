"""What textbooks say: each value is computed from its equation, none is a number by hand.

Lengths in m, angles in degrees, B a flexural rigidity [N m], w a weight per area [N/m^2], rho a density [kg/m^2].
"""

import math
from collections.abc import Callable
from typing import cast

import numpy as np
from scipy.integrate import solve_bvp, solve_ivp
from scipy.optimize import brentq
from scipy.special import j0, j1, jn_zeros, jv

GRAVITY = 9.81  # [m/s^2]
AIR = 1.2  # [kg/m^3]


def _root(function: Callable[[float], float], low: float, high: float) -> float:
    """The zero between two values of other sign."""
    return cast(float, brentq(function, low, high))


def elastica_chord(weight: float) -> float:
    """Angle below level of the chord of a strip clamped level, bent by its own weight; weight = w L^3 / B.

    B theta'' = -w (L - s) cos theta, theta(0) = 0, theta'(L) = 0, theta downwards (Bickley 1934, "The heavy elastica").
    """
    s, theta = np.linspace(0, 1, 201), np.zeros((2, 201))
    reached = 0.5
    while True:  # by continuation, since the boundary value problem is stiff where the strip hangs
        reached = min(weight, 1.5 * reached)
        solution = solve_bvp(
            lambda x, y, g=reached: np.vstack([y[1], -g * (1 - x) * np.cos(y[0])]),
            lambda a, b: np.array([a[0], b[1]]),
            s,
            theta,
            tol=1e-8,
            max_nodes=100_000,
        )
        s, theta = solution.x, solution.y
        if reached == weight:
            break
    x = np.linspace(0, 1, 10_001)
    angle = solution.sol(x)[0]
    return math.degrees(math.atan2(np.trapezoid(np.sin(angle), x), np.trapezoid(np.cos(angle), x)))


def chain_frequency(mode: int, length: float) -> float:
    """Angular frequency of a hanging chain [rad/s], modes from 1: j0_k / 2 sqrt(g / L) (Bernoulli 1733)."""
    return jn_zeros(0, mode)[-1] / 2 * math.sqrt(GRAVITY / length)


def chain_shape(mode: int, above: np.ndarray) -> np.ndarray:
    """Deflection of that mode, 1 at the free end; above: height over it as a part of the length, 0 to 1."""
    return j0(jn_zeros(0, mode)[-1] * np.sqrt(np.clip(above, 0, 1)))


def self_buckling_weight() -> float:
    """w L^3 / B above which a standing strip, clamped at its foot, falls: 9/4 j^2, j the first zero of J_-1/3
    (Greenhill 1881)."""
    return 9 / 4 * _root(lambda x: jv(-1 / 3, x), 1.0, 2.5) ** 2


def catenary_sag(ratio: float, weight: float, young: float) -> float:
    """Sag over span of a strip 1 m long, `ratio` times the span of its ends, of that weight an area and E t [N/m].

    Elastic catenary (Irvine 1981, "Cable structures"), H its level tension:
    span = H L / E t + 2 H / w asinh(w L / 2 H), sag = w L^2 / (8 E t) + H / w (sqrt(1 + (w L / 2 H)^2) - 1).
    """
    span = 1 / ratio
    level = _root(lambda h: h / young + 2 * h / weight * math.asinh(weight / (2 * h)) - span, 1e-6, 1e4)
    sag = weight / (8 * young) + level / weight * (math.sqrt(1 + (weight / (2 * level)) ** 2) - 1)
    return sag / span


def hanging_extension(weight: float, length: float, young: float) -> float:
    """w L^2 / (2 E t)."""
    return weight * length**2 / (2 * young)


def euler_load(rigidity: float, length: float) -> float:
    """Load per width [N/m] at which a strip clamped at both ends buckles: 4 pi^2 B / L^2 (Euler 1744)."""
    return 4 * math.pi**2 * rigidity / length**2


def cantilever_frequency(rigidity: float, density: float, length: float) -> float:
    """First frequency of a clamped strip without gravity [Hz]: k^2 / (2 pi L^2) sqrt(B / rho), cos k cosh k = -1."""
    return cantilever_root() ** 2 / (2 * math.pi * length**2) * math.sqrt(rigidity / density)


def cantilever_root() -> float:
    """The first root of cos k cosh k = -1."""
    return _root(lambda k: math.cos(k) * math.cosh(k) + 1, 1.0, 3.0)


def cantilever_shape(x: np.ndarray) -> np.ndarray:
    """Its deflection, 1 at the free end; x: distance from the clamp as a part of the length."""
    k = cantilever_root()
    sigma = (math.cosh(k) + math.cos(k)) / (math.sinh(k) + math.sin(k))

    def shape(u: np.ndarray) -> np.ndarray:
        return np.cosh(u) - np.cos(u) - sigma * (np.sinh(u) - np.sin(u))

    return shape(k * x) / shape(np.array(k))


def sliding(degrees: float, friction: float) -> float:
    """Acceleration down a slope [m/s^2] (Coulomb); 0 where it sticks."""
    angle = math.radians(degrees)
    return max(0.0, GRAVITY * (math.sin(angle) - friction * math.cos(angle)))


def wrinkle_length(rigidity: float, tension: float, length: float) -> float:
    """Wavelength of a sheet's wrinkles along its tension: 2 sqrt(pi) (B / T)^1/4 sqrt(L) (Cerda, Mahadevan 2003)."""
    return 2 * math.sqrt(math.pi) * (rigidity / tension) ** 0.25 * math.sqrt(length)


def terminal_speed(density: float, drag: float) -> float:
    """Of a sheet that falls flat [m/s]: sqrt(2 rho g / (drag air))."""
    return math.sqrt(2 * density * GRAVITY / (drag * AIR))


def swing_left(density: float, drag: float, length: float, amplitude: float) -> float:
    """What is left of the first mode's amplitude [1] after half a swing of a hanging strip in air.

    rho y_tt = (w s y_s)_s - drag air |y_t| y_t / 2, s the height over the free end, in the modes of the chain (20 of
    them), from rest in the first at `amplitude` [m].
    """
    roots, count = jn_zeros(0, 20), 400
    nodes, weights = np.polynomial.legendre.leggauss(count)
    above, weights = (nodes + 1) / 2, weights / 2
    shapes = j0(roots[:, None] * np.sqrt(above))  # integral of shape^2 over the length: j1(root)^2
    squares, norm = (roots / 2) ** 2 * GRAVITY / length, j1(roots) ** 2

    def derivative(_: float, state: np.ndarray) -> np.ndarray:
        at, speed = np.split(state, 2)
        flow = speed @ shapes
        force = -drag * AIR / (2 * density) * (np.abs(flow) * flow * weights) @ shapes.T / norm
        return np.concatenate([speed, force - squares * at])

    def turning(_: float, state: np.ndarray) -> float:
        return state[len(roots)]

    turning.direction = 1.0  # type: ignore[attr-defined]  # as scipy wants it: the far end of the first half swing
    turning.terminal = True  # type: ignore[attr-defined]
    start = np.zeros(2 * len(roots))
    start[0] = amplitude
    solution = solve_ivp(derivative, (0, 2 * math.pi), start, events=turning, rtol=1e-8, atol=1e-10, max_step=0.01)
    return float(-solution.y_events[0][0][0] / amplitude)
