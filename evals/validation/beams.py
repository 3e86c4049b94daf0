"""Bending: strips that droop, buckle and swing like beams. All are 1 m long."""

import math

import numpy as np

from garmentbench.evals.validation import exact
from garmentbench.evals.validation.case import Case
from garmentbench.evals.validation.strips import DENSITY, balanced, run, squared_frequency, strip, vacuum

WEIGHT = DENSITY * exact.GRAVITY  # [N/m^2]
POISSON = 1 / 3  # of equilateral triangles in their plane
BALANCED = {"1/5": 5.0, "1/10": 10.0, "1/20": 20.0}  # edges, as parts of the length
CLAMPED = {"1/10": 10.0, "1/20": 20.0, "1/40": 40.0}
BELOW, ABOVE = 0.8, 1.2  # of the critical load: where the swing is measured to find it


def chord(weight: float, edges: float) -> float:
    """Angle [degrees] below level of the chord of a strip that droops by its own weight, w L^3 / B."""
    cloth, end = balanced(round(edges))
    material = vacuum(WEIGHT / weight, young=2000.0, stretch_damping=1e-4)
    last = run(cloth, 4.0, material, settle=6.0).positions[-1]
    tip, middle = end @ last, last[cloth.pins].mean(axis=0)
    return math.degrees(math.atan2(middle[2] - tip[2], tip[0]))


def cantilever(edges: float) -> float:
    """First frequency [Hz] of a clamped strip without gravity."""
    cloth, _ = balanced(round(edges))
    shape = exact.cantilever_shape(np.abs(cloth.rest[:, 0].astype(np.float64)))
    start = cloth.rest + 1e-3 * shape[:, None] * np.array([0.0, 0.0, 1.0])
    out = run(cloth, 1.5, vacuum(RIGIDITY, young=100.0), start, gravity=0.0)
    return math.sqrt(squared_frequency(out, shape)) / (2 * math.pi)


RIGIDITY = 0.064  # [N m] of the strip that swings: about once a second


def self_buckling(edges: float) -> float:
    """Weight w L^3 / B at which a standing strip falls: where the square of its swing's frequency passes through 0."""
    columns, critical = round(edges), exact.self_buckling_weight()
    cloth, along = strip(columns + 1, 1 + 1 / columns, clamped=(0, 1))
    up, young = along - 1 / columns, 1000.0
    free = np.clip(up, 0, 1)
    shape = 1 - np.cos(np.pi / 2 * free)
    height = up - WEIGHT * (free - free**2 / 2) / young
    start = np.column_stack([1e-3 * shape, cloth.rest[:, 1], height])
    squares = [
        squared_frequency(run(cloth, 1.0, vacuum(WEIGHT / (critical * share), young), start), shape, axis=0)
        * share  # over the rigidity, which differs here in place of the weight
        for share in (BELOW, ABOVE)
    ]
    return critical * _zero(squares)


def euler(edges: float) -> float:
    """Load [N/m] at which a strip clamped at both ends buckles, found likewise."""
    columns, rigidity = round(edges), 0.0064
    cloth, along = strip(columns + 2, 1 + 2 / columns, clamped=(0, 1, -2, -1))
    place = along - 1 / columns
    shape = 1 - np.cos(2 * np.pi * np.clip(place, 0, 1))
    critical, short = exact.euler_load(rigidity, 1.0), 2e-3
    squares = []
    for share in (BELOW, ABOVE):
        strain = short * share
        start = cloth.rest * np.array([1 - strain, 1 + POISSON * strain, 0]) + 3e-4 * shape[:, None] * [0, 0, 1]
        out = run(cloth, 1.0, vacuum(rigidity, critical / short), start, gravity=0.0)
        squares.append(squared_frequency(out, shape))
    return critical * _zero(squares)


def _zero(squares: list[float]) -> float:
    """Where a straight line through the values at BELOW and ABOVE passes through 0."""
    return BELOW + (ABOVE - BELOW) * squares[0] / (squares[0] - squares[1])


def _elastica(weight: float) -> Case:
    return Case(
        name=f"elastica_{weight:g}",
        title=f"strip that droops by its own weight, w L³/B = {weight:g}: angle of its chord",
        unit="deg",
        wanted=lambda: exact.elastica_chord(weight),
        simulate=lambda edges: chord(weight, edges),
        sizes=BALANCED,
        tolerance=0.3,
        source="heavy elastica, Bickley 1934; at 8 the angle of the cantilever test, ASTM D1388",
        fast=weight == 8,
    )


CASES = (
    *map(_elastica, (2.0, 8.0, 20.0, 100.0)),
    Case(
        name="cantilever_frequency",
        title="clamped strip without gravity: first frequency",
        unit="Hz",
        wanted=lambda: exact.cantilever_frequency(RIGIDITY, DENSITY, 1.0),
        simulate=cantilever,
        sizes=BALANCED,
        tolerance=0.01,
        relative=True,
        source="Euler-Bernoulli beam",
    ),
    Case(
        name="self_buckling",
        title="standing strip: w L³/B at which it falls",
        unit="1",
        wanted=exact.self_buckling_weight,
        simulate=self_buckling,
        sizes=CLAMPED,
        tolerance=0.05,
        relative=True,
        source="Greenhill 1881",
    ),
    Case(
        name="euler_load",
        title="strip clamped at both ends, pushed together: load at which it buckles",
        unit="N/m",
        wanted=lambda: exact.euler_load(0.0064, 1.0),
        simulate=euler,
        sizes=CLAMPED,
        tolerance=0.05,
        relative=True,
        source="Euler 1744",
    ),
)
