"""The paper's own numbers, for the columns "paper".

Source: Zhang, Ceylan, Mitra: Motion Guided Deep Dynamic 3D Garments, ACM Transactions on Graphics 41 (6), 2022.
The paper gives L2 "x 10^-2" without a unit; its constants are in metres, so that this is read as centimetres. How its
L2 is averaged isn't said. Its garments have 18k to 22k vertices, its motions are Mixamo's, its reference is another
simulator's: the column is there for orientation.
"""

from dataclasses import dataclass

from garmentbench.report.cells import number
from garmentbench.report.lines import Line
from garmentbench.report.table import Cell

TABLE_2 = (
    "Table 2. To quantitatively evaluate the generalization ability, we show the average percentage of garment "
    "vertices inter-penetrating the body meshes across different testing motions [trained with walking]"
)
TABLE_3 = (
    "Table 3. To evaluate the stability of our network, we report the L2 error when predicting long motion sequences "
    "at test time by iterative roll-out prediction for more than a thousand frames"
)
TABLE_4 = (
    "Table 4. To evaluate the effect of data length [...], we report the L2 error of roll-out prediction at the long "
    "sequence of an unseen motion (armspace-90) by running the network trained with different length of the training "
    "data"
)
LONG, SHORT = 1150, 50  # the paper's horizons [frames]


@dataclass(frozen=True)
class PaperNumber:
    """One number of the paper, of its full model on its own scene.

    Attributes:
        garment, motion, train_frames: The row of the table.
        metric, horizon: As in results.csv.
        value: In the unit of results.csv (cm or %).
        source: The table's number and caption.
    """

    garment: str
    motion: str
    train_frames: int
    metric: str
    horizon: int
    value: float
    source: str


def _errors(source: str, garment: str, motion: str, train_frames: int, one_step: float, short: float, long: float):
    columns = (("one_step_l2", 1, one_step), ("rollout_l2", SHORT, short), ("rollout_l2", LONG, long))
    return [PaperNumber(garment, motion, train_frames, *column, source) for column in columns]


def _inside(motion: str, percent: float) -> PaperNumber:
    """Table 2 names neither garment nor length: taken for the T-shirt's long roll-out."""
    return PaperNumber("tshirt", motion, 300, "interpenetration", LONG, percent, TABLE_2)


PAPER_NUMBERS: list[PaperNumber] = [
    *_errors(TABLE_3, "tshirt", "armspace-90", 300, 0.59, 0.83, 0.82),
    *_errors(TABLE_3, "pleated_skirt", "armspace-75", 300, 1.03, 1.01, 1.09),
    *_errors(TABLE_3, "bodysuit", "armspace-90", 300, 0.89, 1.08, 1.06),
    *_errors(TABLE_4, "tshirt", "armspace-90", 50, 0.63, 1.10, 1.84),
    *_errors(TABLE_4, "tshirt", "armspace-90", 150, 0.55, 0.81, 0.84),
    *_errors(TABLE_4, "tshirt", "armspace-90", 900, 0.75, 0.92, 0.72),
    _inside("armspace-60", 0.15),
    _inside("armspace-90", 0.01),
    _inside("catwalk", 0.19),
]


def paper_number(
    garment: str, motion: str, train_frames: int | None, metric: str, horizon: int | None
) -> PaperNumber | None:
    """The paper's number of its full model, or None where it has none."""
    wanted = (garment, motion, train_frames, metric, horizon)
    return next(
        (n for n in PAPER_NUMBERS if (n.garment, n.motion, n.train_frames, n.metric, n.horizon) == wanted), None
    )


def paper_cell(line: Line, metric: str, horizon: int | None) -> Cell:
    """The paper's number beside ours, where it has one: for the full model, by its training length."""
    if line.method != "motion_guided" or not (line.variant == "full" or line.variant.startswith("train_")):
        return Cell(note=True)
    horizons = line.rows.horizon[line.rows.metric == metric]
    at = horizon if horizon is not None or len(horizons) == 0 else int(horizons.max())
    found = paper_number(line.garment, line.motion, line.train_frames, metric, at)
    return Cell(number(found.value) if found else "", note=True)
