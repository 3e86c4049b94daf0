"""The table of fabrics: what was measured of the cloth, and what the simulator makes of it."""

import math

import numpy as np

from garmentbench.errors import UserError
from garmentbench.evals.validation.exact import GRAVITY, elastica_chord
from garmentbench.report.cells import ABSENT, number
from garmentbench.report.lines import Results
from garmentbench.report.table import Cell, Table
from garmentbench.scenes.fabrics import Fabric, fabrics

FABRICS = "fabrics"
METRICS = ("drape_coarse", "drape_fine", "droop", "substeps", "ms_per_frame")
SHAPE = "drape.npz"  # in a run's folder: the draped disc's positions [m] (V, 3) and faces (F, 3)
OVERHANG = 0.1  # [m] of the cantilever
MESHES_APART = 3.0  # the drape's two mesh sizes may differ by so much [points]


def fabrics_table(results: Results) -> Table:
    """A row a fabric. One that misses its band, or whose two meshes differ, stays, red."""
    table = results.table[results.table.experiment == FABRICS]
    rows = []
    for name, cloth in fabrics().items():
        found = table[table.scene == name]
        if len(found) == 0:
            continue
        values = {row.metric: row.value for row in found.itertuples()}
        rows.append(_row(name, cloth, [values.get(m, math.nan) for m in METRICS]))
    return Table(
        FABRICS,
        "Fabrics",
        "Named fabrics, from measurements of the cloth (datasets/fabrics.toml; nothing is fitted to a drape). Drape: "
        "Cusick's coefficient, a disc of 30 cm over a table of 18 cm, at two mesh sizes that may differ by 3 points, "
        "means of three starts, beside the band in which such cloth was measured. Bending length: (B / w)^1/3, which "
        "ASTM D1388 measures. "
        "Droop: angle of the chord of 10 cm that hang over an edge, simulated and of the heavy elastica. E t is what "
        "the isotropic sheet has in place of warp, weft and shear. Cost: of the T-shirt at laptop size, without "
        "what it touches.",
        ["fabric", "g/m²", "warp, weft, shear [N/m]", "E t [N/m]", "bending [µN m]", "bending length [cm]",
         "drape, 11 mm [%]", "drape, 8 mm [%]", "measured [%]", "in its band", "droop [deg]", "elastica [deg]",
         "substeps", "ms a frame", "basis"],
        rows,
        frozenset({0, 2, 9, 14}),
    )  # fmt: skip


def _row(name: str, cloth: Fabric, values: list[float]) -> list[Cell]:
    coarse, fine, droop, substeps, ms = values
    weight = cloth.density * GRAVITY
    verdict = _verdict(cloth, fine)
    warp, weft = cloth.tension
    shear = ABSENT if cloth.shear is None else number(cloth.shear)
    apart = abs(fine - coarse)
    return [
        Cell(name),
        number_cell(1e3 * cloth.density),
        Cell(f"{warp:.0f}, {weft:.0f}, {shear}"),
        number_cell(cloth.young),
        number_cell(1e6 * cloth.material["bending"]),
        number_cell(100 * (cloth.rigidity / weight) ** (1 / 3)),
        Cell(number(coarse) if math.isfinite(coarse) else "not at rest", bad=not apart <= MESHES_APART),
        Cell(number(fine) if math.isfinite(fine) else "not at rest", bad=not apart <= MESHES_APART),
        Cell(ABSENT if cloth.drape is None else "{:g} to {:g}".format(*cloth.drape)),
        Cell(verdict, bad=verdict.startswith("no")),
        number_cell(droop),
        number_cell(elastica_chord(weight * OVERHANG**3 / cloth.rigidity)),
        number_cell(substeps, whole=True),
        number_cell(ms),
        Cell(cloth.basis),
    ]


def _verdict(cloth: Fabric, fine: float) -> str:
    if cloth.drape is None:
        return ABSENT
    low, high = cloth.drape
    if not math.isfinite(fine):
        return "no: not at rest"
    if low <= fine <= high:
        return "yes"
    return f"no: {number(fine - high)} above" if fine > high else f"no: {number(low - fine)} below"


def number_cell(value: float, whole: bool = False) -> Cell:
    """A number, or a dash where there is none."""
    return Cell(number(value, whole) if math.isfinite(value) else ABSENT)


def shapes(results: Results) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Each fabric's draped disc: positions [m], shape (V, 3), and faces, (F, 3). Raises `UserError` where one is
    missing."""
    table = results.table[(results.table.experiment == FABRICS) & (results.table.status == "ok")]
    found = {}
    for name in fabrics():
        runs = table.run_id[table.scene == name]
        if len(runs) == 0:
            continue
        path = results.runs_root / runs.iloc[0] / SHAPE
        if not path.is_file():
            raise UserError(f"{path}: named in results.csv, but missing; `garmentbench evals {FABRICS}` makes it")
        with np.load(path) as file:
            found[name] = file["positions"], file["faces"]
    return found
