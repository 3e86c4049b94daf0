"""Sheets: wrinkles, and drape."""

import math
from dataclasses import replace

import numpy as np

from garmentbench.evals.crosscheck.match_material import equilateral
from garmentbench.evals.validation import exact
from garmentbench.evals.validation.case import Case
from garmentbench.evals.validation.drape import drape
from garmentbench.evals.validation.strips import HEIGHT, run, vacuum
from garmentbench.scenes.fabrics import fabric
from garmentbench.scenes.material import Material

LENGTH, WIDTH = 0.25, 0.4  # [m] along and across the tension
YOUNG, STRAIN = 200.0, 0.05  # E t [N/m]; how far it is stretched
RIGIDITY = 2e-5  # [N m] so that about six wrinkles fit
NARROWER = 0.03  # the ends are pushed together across by so much
DRAPED = "wool"
PLEATS, PLEATED, FLAT = 6, 0.12, 0.19  # how many, length at rest and of the cloth [m]
FINE = 16  # part of a spectrum's step that its peak is found to


def wrinkles(edge: float) -> float:
    """Wavelength [cm] of the wrinkles of a sheet that is stretched along one way and made narrower the other.

    What a free sheet would contract by itself depends on Poisson's ratio; here its ends do it, and the wavelength is
    that of the least energy of bending and of the tension's lines that are lifted.
    """
    columns, rows = round(LENGTH / edge), 2 * round(WIDTH / edge / HEIGHT / 2)
    count = columns + 1
    cloth = equilateral(columns, rows, LENGTH / columns, [j * count + i for j in range(rows + 1) for i in (0, columns)])
    x, y = cloth.rest[:, 0].astype(np.float64), cloth.rest[:, 1].astype(np.float64)
    push = 1e-4 * np.random.default_rng(0).standard_normal(len(x))
    push[cloth.pins] = 0
    start = np.column_stack([(1 + STRAIN) * x, (1 - NARROWER) * y, push])
    material = vacuum(RIGIDITY * 8 / 9, YOUNG, stretch_damping=1e-4)  # a wide sheet bends as its modulus says
    last = run(cloth, 2.0, material, start, settle=4.0, gravity=0.0).positions[-1]
    middle = np.abs(x - x.mean()) < 0.6 * LENGTH / columns
    across = np.argsort(last[middle, 1])
    place, lifted = last[middle, 1][across], last[middle, 2][across]
    even = np.linspace(place[0], place[-1], 512)
    wave = np.interp(even, place, lifted)
    wave = (wave - wave.mean()) * np.hanning(512)
    power = np.abs(np.fft.rfft(wave, 512 * FINE))
    return 100 * (even[-1] - even[0]) / (512 / 511) * FINE / int(np.argmax(power))


def unfolded(lines: float) -> float:
    """Length [mm] to which a pleated strip comes back after it was drawn nearly flat; lines: of the mesh, a pleat."""
    count, across = round(lines) * PLEATS, 4
    spacing = FLAT / count
    flat = equilateral(across, count, spacing / HEIGHT)  # its rows lie across the strip
    row = np.repeat(np.arange(count + 1), across + 1)
    y = flat.rest[:, 0].astype(np.float64)

    def folded(length: float) -> np.ndarray:
        cosine = length / FLAT
        turn = np.abs((row + round(lines)) % (2 * round(lines)) - round(lines))
        return np.column_stack([spacing * cosine * row, y, spacing * math.sqrt(1 - cosine**2) * turn])

    cloth = replace(flat, rest=folded(PLEATED).astype(np.float32))
    material = vacuum(1e-4, 1000.0, stretch_damping=1e-4)
    last = run(cloth, 2.0, material, folded(0.97 * FLAT), settle=10.0, gravity=0.0).positions[-1]
    return 1e3 * float(np.linalg.norm(last[row == count].mean(axis=0) - last[row == 0].mean(axis=0)))


def draped(edge: float) -> float:
    """Cusick's coefficient [%] of the fabric `DRAPED`; `make fabrics` has all of them."""
    return drape(Material(**fabric(DRAPED).material), edge).coefficient


CASES = (
    Case(
        name="drape",
        title=f"disc of {DRAPED}, 30 cm, over a table of 18 cm: drape coefficient",
        unit="%",
        wanted=lambda: fabric(DRAPED).drape or (0.0, 0.0),
        simulate=draped,
        sizes={"16 mm": 0.016, "11 mm": 0.0113, "8 mm": 0.008},
        source=f"band of {fabric(DRAPED).drape_source}",
        fast=False,
        cost=10.0,
    ),
    Case(
        name="pleats",
        title="strip of six pleats, 12 cm, drawn out to 18.4 cm: length to which it comes back",
        unit="mm",
        wanted=lambda: 1e3 * PLEATED,
        simulate=unfolded,
        sizes={"2 a pleat": 2, "4 a pleat": 4},
        tolerance=0.005,
        relative=True,
        source="a crease keeps the angle of the rest shape",
    ),
    Case(
        name="wrinkles",
        title="sheet under 10 N/m, 25 cm long, made 3 % narrower: wavelength of its wrinkles",
        unit="cm",
        wanted=lambda: 100 * exact.wrinkle_length(RIGIDITY, YOUNG * STRAIN, LENGTH),
        simulate=wrinkles,
        sizes={"2.5 cm": 0.025, "1.8 cm": 0.018, "1.25 cm": 0.0125},
        tolerance=0.15,
        relative=True,
        source="Cerda and Mahadevan 2003",
        fast=False,
    ),
)
