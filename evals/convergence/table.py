"""The convergence study's tables: how far the reference moves when nothing that should matter is changed.

Is the reference good enough to measure a method against? Its spread (what another run of the simulator errs by) should
be at most a third of the full model's error; the second table says where it is not.
"""

import math
from dataclasses import dataclass

from garmentbench.metrics.spread import SPREAD
from garmentbench.report.cells import ABSENT, number, status_cell, value_cell
from garmentbench.report.lines import REFERENCE, Frame, Line, Results
from garmentbench.report.table import Cell, Table

CONVERGENCE, TRUST, SENSITIVITY = "convergence", "trust", "sensitivity"
CHOSEN, FINEST, ROUNDING = "substeps_x1", "substeps_x8", "start_1um"
SUBSTEPS = {CHOSEN: 1, "substeps_x2": 2, "substeps_x4": 4, FINEST: 8}
CHANGES = {
    CHOSEN: "the chosen setting",
    "substeps_x2": "twice the substeps",
    "substeps_x4": "4 times the substeps",
    FINEST: "8 times the substeps, the finest",
    "queries_x8": "8 times the queries",
    ROUNDING: "start pushed by a micrometre",
    "start_1mm": "start pushed by 1 mm",
    "start_1cm": "start pushed by 1 cm",
    "mesh_fine": "mesh twice as fine",
}
OTHER_CLOTH = {
    "drag_half": "half the drag",
    "drag_double": "twice the drag",
    "friction_half": "half the friction",
    "compression_third": "0.3 of the stiffness when shortened",
    "bending_half": "half the bending",
    "bending_double": "twice the bending",
    "body_full": "the body's full mesh",
}
ABOVE_ROUNDING = 2.0  # differences in the step below this many times what rounding changes say nothing about it
PART_OF_ERROR = 1 / 3  # the spread may be so much of the full model's error
NOTHING = 0.005  # [cm] what the step changes below it has no order that means anything


@dataclass(frozen=True)
class SceneStudy:
    """What was measured on one scene.

    Attributes:
        scene, garment: What was simulated.
        lines: One a variant, by the variant's name.
        model_error: The full model's roll-out error [cm] on that garment, or NaN where it was not run.
        model_scene: The scene of that error.
        spread: What another run of the whole scene errs by [cm], or NaN where it was not measured.
    """

    scene: str
    garment: str
    lines: dict[str, Line]
    model_error: float
    model_scene: str
    spread: float = math.nan

    def mean(self, variant: str, metric: str = "difference") -> float:
        """A variant's value; NaN where there is none."""
        value = self.lines[variant].value(metric) if variant in self.lines else None
        return math.nan if value is None else value.mean

    @property
    def noise(self) -> float:
        """The largest of what a finer step, more queries and a start pushed by 1 mm change over the study's frames
        [cm]; NaN if one isn't known."""
        all_of_them = self.mean(CHOSEN), self.mean("queries_x8"), self.mean("start_1mm")
        return math.nan if any(map(math.isnan, all_of_them)) else max(all_of_them)

    @property
    def order(self) -> float:
        """The observed order of convergence in the step (see `observed_order`); NaN where rounding or the motion's own
        sensitivity hides it, so that differences do not fall as those of a power."""
        coarse, fine = self.mean(CHOSEN), self.mean("substeps_x4")
        order = observed_order(coarse, fine) if fine > ABOVE_ROUNDING * self.mean(ROUNDING) else math.nan
        return order if order > 0 else math.nan


def observed_order(error_1: float, error_4: float) -> float:
    """Order p of errors against a run of 8 times the substeps, at 1 and 4 times: C (1 - 8^-p) and C (4^-p - 8^-p).

    With w = 2^p their ratio is 1 + w + w^2. NaN where the errors don't fall.
    """
    if not (error_4 > 0 and error_1 > error_4):
        return math.nan
    return math.log2((math.sqrt(4 * error_1 / error_4 - 3) - 1) / 2)


def studies(results: Results) -> list[SceneStudy]:
    """The study of each scene, with the full model's error on that scene, or else its smallest on that garment."""
    found = results.lines(CONVERGENCE)
    made = []
    for scene in dict.fromkeys(line.scene for line in found):
        by_variant = {line.variant: line for line in found if line.scene == scene}
        garment = next(iter(by_variant.values())).garment
        error = _model_error(results.table, scene, garment)
        made.append(SceneStudy(scene, garment, by_variant, *error, _spread(results.table, scene)))
    return made


def _spread(results: Frame, scene: str) -> float:
    """What the scene's data card says of its runs [cm]; NaN where it has none, or says nothing."""
    rows = results[(results.method == REFERENCE) & (results.metric == SPREAD.name) & (results.scene == scene)]
    return float(rows.value.iloc[0]) if len(rows) else math.nan


def _model_error(results: Frame, scene: str, garment: str) -> tuple[float, str]:
    """The full model's error [cm] over the whole roll-out, mean over the seeds, and its scene."""
    rows = results[(results.method == "motion_guided") & (results.variant == "full") & (results.metric == "rollout_l2")]
    rows = rows[(rows.garment == garment) & (rows.split == "test") & rows.value.notna()]
    if len(rows) == 0:
        return math.nan, ""
    rows = rows[rows.scene == scene] if scene in set(rows.scene) else rows
    whole = rows[rows.horizon == rows.groupby("scene").horizon.transform("max")]
    error = whole.groupby("scene").value.mean()
    return float(error.min()), str(error.idxmin())


def convergence_table(found: list[SceneStudy]) -> Table:
    """Every run of the study: how far it is from what it is compared with, and what it cost."""
    rows = []
    for study in found:
        for variant in [v for v in CHANGES if v in study.lines]:
            line = study.lines[variant]
            chosen = variant == CHOSEN
            rows.append(
                [
                    Cell(study.scene),
                    Cell(CHANGES[variant], bold=chosen),
                    value_cell(line.value("substeps"), chosen, whole=True),
                    centimetres(study.mean(variant), chosen),
                    centimetres(study.mean(variant, "difference_p95"), chosen),
                    value_cell(line.value("ms_per_frame"), chosen),
                    status_cell(line),
                ]
            )
    return Table(
        CONVERGENCE,
        "Convergence of the reference",
        "How far the simulated garment moves when nothing that should matter is changed, over the scene's first frames "
        "after the whole warm-up. Finer steps are compared with the finest; other starts and the finer mesh (every "
        "triangle cut in four, compared at the vertices that both have) with the chosen setting, which is bold. Time "
        "is the processor's, of one thread; on a CUDA device it is wall time.",
        ["scene", "run", "substeps a frame", "difference [cm]", "95th percentile [cm]", "time a frame [ms]", "status"],
        rows,
        frozenset({0, 1, 6}),
    )


def trust_table(found: list[SceneStudy]) -> Table:
    """Is what nobody can foretell of the reference at most a third of the full model's error, garment by garment?"""
    rows = []
    for study in found:
        order = Cell("none" if math.isnan(study.order) else number(study.order))
        if study.mean(CHOSEN) < NOTHING:
            order = Cell(f"below {NOTHING:g} cm")
        cells = [centimetres(v) for v in (study.noise, study.spread, study.mean("mesh_fine"), study.model_error)]
        rows.append([Cell(study.scene), order, *cells, Cell(study.model_scene or ABSENT), _verdict(study)])
    return Table(
        TRUST,
        "Can the reference be trusted?",
        "The spread is what another run of the simulator errs by, over the whole scene. It should be at most a third "
        "of the full model's roll-out error, and so should the largest of what the finest step, 8 times the queries "
        "and a start pushed by 1 mm change over the study's frames. What a finer mesh changes is no error of the "
        "simulation of this mesh, but says how far the mesh stands for the cloth. Order: of the error in the step, by "
        "its fall from 1 to 4 times the substeps; the integrator's own is 1. Where the step changes less than 0.005 cm "
        "an order would mean nothing. There is none where the differences do not fall: the step's error is then "
        "hidden by rounding, or by folds that fall one way or the other for any reason (see the start pushed by a "
        "micrometre).",
        [
            "scene",
            "order",
            "step, queries, push [cm]",
            "spread [cm]",
            "finer mesh [cm]",
            "full model's error [cm]",
            "measured on",
            "at most a third",
        ],
        rows,
        frozenset({0, 6, 7}),
    )


def sensitivity_table(found: list[SceneStudy]) -> Table:
    """How far the reference moves when the cloth, the air or the body is another, beside what changes nothing."""
    rows = [
        [Cell(study.scene), centimetres(study.noise), *(centimetres(study.mean(v)) for v in OTHER_CLOTH)]
        for study in found
    ]
    return Table(
        SENSITIVITY,
        "What the reference depends on",
        "Mean distance [cm] from the chosen setting, over the scene's first frames, of a run with one quantity "
        "changed. What is below the first column can't be told from another start.",
        ["scene", "step, queries, push [cm]", *OTHER_CLOTH.values()],
        rows,
        frozenset({0}),
    )


def centimetres(value: float, bold: bool = False) -> Cell:
    """Two significant digits, since differences of the reference may be far below 0.01 cm."""
    return Cell(ABSENT) if math.isnan(value) else Cell(f"{value:.2g}", bold=bold)


def _verdict(study: SceneStudy) -> Cell:
    both = study.spread, study.noise
    share = math.nan if any(map(math.isnan, both)) else max(both) / study.model_error
    if math.isnan(share):
        return Cell("full model not run on it" if math.isnan(study.model_error) else "spread not known", bad=True)
    holds = share <= PART_OF_ERROR
    return Cell(f"{'yes' if holds else 'no'}: {number(100 * share)} %", bad=not holds)
