import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from rerun.chunk import RrdReader

from garmentbench.errors import UserError
from garmentbench.evaluation.rollout import ROLL_OUT, RollOut
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.viewing import recording as writing
from garmentbench.viewing.recording import ROUNDING, recorded_frames, write_recording
from garmentbench.viewing.viewer import check_recording

START = 3


def wobbly(sequence, bad=None) -> RollOut:
    """A roll-out that is off by up to 2 cm, and ends before frame `bad`."""
    garment = sequence.garment.copy()
    garment[START:] += np.random.default_rng(0).uniform(-0.02, 0.02, garment[START:].shape).astype(np.float32)
    ms = np.arange(3 * len(sequence), dtype=float).reshape(-1, 3)
    if bad is None:
        return RollOut(ROLL_OUT, START, garment, None, ms)
    garment[bad:], ms[bad:] = np.nan, np.nan
    return RollOut(ROLL_OUT, START, garment, None, ms, "diverged", bad, "12 vertices are not finite")


def columns(path, entity: str, component: str) -> dict[int, np.ndarray]:
    """What a recording holds of one component: frame -> values."""
    found = {}
    for chunk in RrdReader(path).stream().filter(content=entity, is_static=False).to_chunks():
        batch = chunk.to_record_batch()
        if component not in batch.schema.names:
            continue
        for frame, value in zip(batch["frame"].to_pylist(), batch[component].to_pylist(), strict=True):
            found[frame] = np.array(value)
    return found


def meshes(path, name: str) -> dict[int, np.ndarray]:
    return columns(path, f"/scene/{name}", "Mesh3D:vertex_positions")


@pytest.fixture
def sequence():
    return tiny_sequence(70)


@pytest.fixture
def path(tmp_path):
    return tmp_path / "recording.rrd"


def test_positions_read_back_to_the_stated_rounding(path, sequence):
    roll_out = wobbly(sequence)
    write_recording(path, sequence, roll_out, "test")
    wanted = {"reference": sequence.garment, "prediction": roll_out.garment, "body": sequence.body}
    for name, positions in wanted.items():
        found = meshes(path, name)
        assert sorted(found) == list(range(START, 70))
        for frame, vertices in found.items():
            np.testing.assert_allclose(vertices, positions[frame], rtol=0, atol=0.5 * ROUNDING + 1e-7)


def test_the_curves_hold_error_time_and_penetration_of_every_frame(path, sequence):
    roll_out = wobbly(sequence)
    write_recording(path, sequence, roll_out, "test")
    error = columns(path, "/error/mean", "Scalars:scalars")
    by_hand = 100 * np.sqrt(((roll_out.garment[40].astype(float) - sequence.garment[40]) ** 2).sum(axis=1)).mean()
    assert error[40].item() == pytest.approx(by_hand, rel=1e-4)
    assert columns(path, "/ms/collide", "Scalars:scalars")[69].item() == roll_out.ms[69, 2]
    assert sorted(columns(path, "/penetration/prediction", "Scalars:scalars")) == list(range(START, 70))


def test_the_vertices_inside_the_body_are_marked(path, sequence):
    garment = sequence.garment.copy()
    garment[10, 7] = sequence.body[10].mean(axis=0)  # one vertex, in one frame, in the middle of the body
    write_recording(path, sequence, replace(wobbly(sequence), garment=garment), "test")
    points = columns(path, "/scene/prediction/inside", "Points3D:positions")
    before, after = len(points[9]), len(points[10])
    assert before == 0 and after == 1
    np.testing.assert_allclose(points[10][0], garment[10, 7], atol=1e-6)
    share = columns(path, "/penetration/prediction", "Scalars:scalars")[10].item()
    assert share == pytest.approx(100 / garment.shape[1])


def test_nothing_is_drawn_of_a_diverged_roll_out_from_its_first_bad_frame_on(path, sequence):
    write_recording(path, sequence, wobbly(sequence, bad=20), "test")
    assert sorted(meshes(path, "prediction")) == list(range(START, 20))
    assert sorted(meshes(path, "reference")) == list(range(START, 70))
    cleared = columns(path, "/scene/prediction", "Clear:is_recursive")
    assert list(cleared) == [20]
    text = (
        RrdReader(path)
        .stream()
        .filter(content="/about")
        .to_chunks()[0]
        .to_record_batch()["TextDocument:text"]
        .to_pylist()
    )
    assert "**diverged** at frame 20: 12 vertices are not finite" in text[0][0]


def test_a_method_that_failed_at_once_still_has_its_recording(path, sequence):
    write_recording(path, sequence, wobbly(sequence, bad=START), "test")
    assert meshes(path, "prediction") == {} and len(meshes(path, "reference")) == 67


@pytest.mark.parametrize("kind", ["object", None])
def test_no_interpenetration_without_a_human_body(path, kind):
    sequence = tiny_sequence(20, kind=kind)
    write_recording(path, sequence, wobbly(sequence), "test")
    entities = {c.entity_path for c in RrdReader(path).stream().to_chunks()}
    assert not any("inside" in e or "penetration" in e for e in entities)
    assert ("/scene/body" in entities) == (kind == "object")


def test_a_long_roll_out_is_thinned_then_cut(path, sequence, monkeypatch):
    assert recorded_frames(3, 303, 6500) == range(3, 303)
    assert recorded_frames(3, 1150, 6500) == range(3, 1150, 2)
    assert len(recorded_frames(3, 1150, 51_000)) == 78
    vertices = 2 * sequence.garment.shape[1] + sequence.body.shape[1]
    monkeypatch.setattr(writing, "COORDINATES", 3 * vertices * 20)
    write_recording(path, sequence, wobbly(sequence), "test")
    assert sorted(meshes(path, "prediction")) == list(range(START, START + 40, 2))
    assert len(columns(path, "/error/mean", "Scalars:scalars")) == 67


def test_a_truncated_recording_is_told_from_a_whole_one(path, sequence):
    write_recording(path, sequence, wobbly(sequence), "test")
    check_recording(path)
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    with pytest.raises(UserError, match="recording.rrd: cut short, or not a recording"):
        check_recording(path)
    with pytest.raises(UserError, match="no such recording"):
        check_recording(path.with_name("other.rrd"))


def test_a_disk_that_fills_leaves_the_old_recording(path, sequence):
    """In a process of its own, whose files can't grow beyond 100 kB."""
    path.write_text("the old one")
    script = f"""
import resource, sys
from pathlib import Path
import numpy as np
from garmentbench.errors import UserError
from garmentbench.viewing.recording import write_recording
from garmentbench.evaluation.rollout import ROLL_OUT, RollOut
from garmentbench.evaluation.toy import tiny_sequence
sequence = tiny_sequence(70)
roll = RollOut(ROLL_OUT, 3, sequence.garment, None, np.ones((70, 3)))
sys.dont_write_bytecode = True  # a module compiled now would be cut off, and stay so
resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, 100_000))
try:
    write_recording(Path({str(path)!r}), sequence, roll, "test")
except UserError as e:
    sys.exit(str(e))
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert done.returncode == 1 and "can't be written" in done.stderr
    assert [p.name for p in path.parent.iterdir()] == [path.name] and path.read_text() == "the old one"
