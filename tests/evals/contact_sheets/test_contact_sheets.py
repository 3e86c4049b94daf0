"""Contact sheets: the frame shown, what is found in it, and the way into a report, the same bytes every time."""

from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from garmentbench import sequence_file
from garmentbench.errors import UserError
from garmentbench.evals.contact_sheets.draw import SIDES, SIZE, faults, lively_frame
from garmentbench.evals.contact_sheets.sheets import ROWS
from garmentbench.evals.contact_sheets.study import SHEETS, draw
from garmentbench.evals.report import make_report
from garmentbench.evals.run import write_results
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.reference import SequenceFile
from garmentbench.scenes.presets import preset
from garmentbench.scenes.wardrobe import load_scene
from garmentbench.storage.jobs import Failure

SMOKE = preset("smoke")


def test_the_frame_shown_is_the_one_in_which_cloth_moves_most_against_its_middle():
    garment = np.random.default_rng(0).normal(size=(1, 30, 3)) + np.zeros((12, 1, 1))
    garment[3:] += 5.0  # it is carried far away, which is no life
    garment[7, 0] += 0.5
    assert lively_frame(garment) in (6, 8)
    garment[5:] = np.nan
    assert lively_frame(garment) < 4
    assert lively_frame(garment[:2]) == 0


def test_faults_are_those_of_the_frame():
    sequence = tiny_sequence(6)
    sequence.garment[4, 20] = sequence.body_positions[4].mean(axis=0)  # a vertex through the body's other side, no less
    clean, pushed = faults(sequence, 2), faults(sequence, 4)
    assert clean == {"crossing_faces": 0, "skin_through": 0}
    assert pushed["skin_through"] > 3
    assert "skin_through" not in faults(tiny_sequence(6, "object"), 2)


@pytest.fixture(scope="module")
def report(tmp_path_factory):
    """Two garments of a made-up report, the second in more motions than a sheet holds: root, and the runs by name."""
    with pytest.MonkeyPatch.context() as patch:
        root = tmp_path_factory.mktemp("sheets")
        patch.chdir(root)
        files, results = [], {}
        for name in ("cape-walk", *(f"tube-walk{i}" for i in range(ROWS + 1))):
            tiny = tiny_sequence(6, phase=len(files))
            garment = replace(tiny.template.garment, name=name.partition("-")[0])
            tiny = replace(tiny, template=replace(tiny.template, garment=garment), info={"scene": name})
            files.append(SequenceFile(root / f"{name}.h5"))
            sequence_file.save(tiny, files[-1].path)
            results["sequence", name] = files[-1].path
        work = SHEETS.beside([*files, load_scene("dress-armspace-75")], SMOKE)
        assert ("contact_sheets", "dress-armspace-75") not in work.jobs  # it isn't tested on
        made = {key: draw(results[job.needs[0]]) for key, job in work.jobs.items()}
        results |= made | {("contact_sheets", "tube-walk0"): Failure("draw", "no memory")}
        write_results(root / "reports" / "smoke" / "results.csv", work.rows(results))
        make_report("smoke", root / "reports", root / "runs")
        yield root, made


def test_a_garment_has_as_many_sheets_as_it_takes(report):
    root, made = report
    folder = root / "reports" / "smoke" / "contact_sheets"
    assert sorted(path.name for path in folder.iterdir()) == ["cape-ellipsoid.webp", "tube-ellipsoid.webp"]
    heights = [Image.open(folder / f"{name}-ellipsoid.webp").size for name in ("cape", "tube")]
    assert heights[0][0] == heights[1][0] == len(SIDES) * SIZE[0]
    assert heights[1][1] == ROWS * heights[0][1]  # one of the nine failed
    assert 'src="contact_sheets/tube-ellipsoid.webp"' in (root / "reports" / "smoke" / "index.html").read_text()
    assert "| tube-walk0 | failed |" in (root / "reports" / "smoke" / "tables" / "contact_sheets.md").read_text()


def test_it_is_drawn_once_and_remade_byte_for_byte(report, monkeypatch):
    root, made = report
    monkeypatch.chdir(root)
    assert draw(root / "cape-walk.h5") == made["contact_sheets", "cape-walk"]
    folder = root / "reports" / "smoke"
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    make_report("smoke", root / "reports", root / "runs")
    assert before == {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_a_missing_row_is_named(report, tmp_path):
    with pytest.raises(UserError, match="row.png: named in results.csv, but missing; `garmentbench evals contact-sh"):
        make_report("smoke", report[0] / "reports", tmp_path)
