"""The shadow of a draped disc, and the table of fabrics."""

import math

import numpy as np
import pandas
import pytest

from garmentbench.evals.fabrics.table import METRICS, fabrics_table
from garmentbench.evals.validation.drape import DISC, TABLE, ring, shadow
from garmentbench.evaluation.results import COLUMNS, Row
from garmentbench.report.lines import Results, read_results


def test_a_flat_disc_covers_itself_and_a_limp_one_the_table():
    cloth = ring(0.0113)
    flat = cloth.rest.astype(np.float64)
    assert shadow(flat, cloth.faces) == pytest.approx(math.pi * DISC**2, rel=3e-3)
    away = np.maximum(np.linalg.norm(flat[:, :2], axis=1, keepdims=True), TABLE)
    limp = np.column_stack([TABLE * flat[:, :2] / away, -away])
    assert shadow(limp, cloth.faces) == pytest.approx(math.pi * TABLE**2, rel=5e-3)  # a pixel all round


def test_the_rings_clamp_acts_at_the_tables_border_and_nothing_else_is_held():
    cloth = ring(0.008)
    held = np.linalg.norm(cloth.rest[cloth.pins, :2], axis=1)
    assert (held.min() + held.max()) / 2 == pytest.approx(TABLE, rel=1e-3)
    free = np.delete(np.linalg.norm(cloth.rest[:, :2], axis=1), cloth.pins)
    assert free.min() > held.max() and free.max() == pytest.approx(DISC, rel=1e-3)


def test_a_fabric_out_of_its_band_or_unsure_of_its_mesh_is_red(tmp_path):
    rows = []
    for name, values in (("denim", (80.0, 81.0)), ("silk", (60.0, 66.0)), ("interlock", (60.0, 61.0))):
        rows += [
            Row(experiment="fabrics", scene=name, method="reference", metric=metric, value=value)
            for metric, value in zip(METRICS, (*values, 40.0, 100.0, 5.0), strict=True)
        ]
    pandas.DataFrame(map(vars, rows), columns=COLUMNS).to_csv(tmp_path / "results.csv", index=False)
    table = fabrics_table(Results(read_results(tmp_path / "results.csv"), tmp_path))
    verdict, fine = table.header.index("in its band"), table.header.index("drape, 8 mm [%]")
    by_name = {row[0].text: row for row in table.rows}
    assert [by_name[n][verdict].text for n in ("denim", "silk", "interlock")] == ["yes", "no: 26.0 above", "–"]
    assert [by_name[n][fine].bad for n in ("denim", "silk", "interlock")] == [False, True, False]
