"""Frames belong to their template and to each other: order of vertices, unit, mirror image, scale."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from cache_example import FORMATS, STATE_RATE, alembic, hdf5, mdd, moving, npz, pc2, run, usd
from exchange_example import typed

from garmentbench.errors import UserError
from garmentbench.importing.meshes.frame_check import check_frames, check_rest
from garmentbench.importing.meshes.mesh_sequence import MeshSequence
from garmentbench.motion.gait import GAITS
from garmentbench.motion.walk import walk
from garmentbench.scenes.bodies import load_body, pose

ANY = np.random.default_rng(0)


def template_of(mesh: MeshSequence, rest: np.ndarray) -> MeshSequence:
    return replace(mesh, rest=rest, files=(Path("cache.pc2"), Path("template.obj")))


def some_permuted(mesh: MeshSequence, count: int) -> np.ndarray:
    """Numbers of the vertices, `count` of them in each other's places, which are far apart."""
    order = np.arange(len(mesh.still))
    chosen = order[:: len(order) // count][:count]
    order[chosen] = np.roll(chosen, 1)
    return order


@pytest.mark.parametrize("name", ["garment", "body"])
def test_a_template_that_is_not_the_frames_is_named_with_its_likely_cause(name):
    mesh = moving(name)
    order = ANY.permutation(len(mesh.still))
    assert check_rest(template_of(mesh, mesh.still)) == []
    with pytest.raises(
        UserError, match="cache.pc2: template.obj has other proportions .*another order of vertices.*--other-template"
    ):
        check_rest(template_of(mesh, mesh.still[order]))
    with pytest.raises(UserError, match="template.obj is 100 times as large as frame 0: another unit"):
        check_rest(template_of(mesh, 100 * mesh.still))
    with pytest.raises(UserError, match="mirror image of frame 0"):
        check_rest(template_of(mesh, mesh.still * np.float32([-1, 1, 1])))
    assert check_rest(template_of(mesh, mesh.still[:, [1, 2, 0]])) == []  # a turn is placed later
    frames = mesh.frames.copy()
    frames[5] = frames[5][order]
    check_frames(replace(mesh, frames=frames), 5)
    with pytest.raises(UserError, match="frame 5 has other proportions than frame 0.*--frames 5"):
        check_frames(replace(mesh, frames=frames), 8)


@pytest.mark.parametrize("count", [2, 24])
@pytest.mark.parametrize("name", ["garment", "body"])
def test_a_few_vertices_in_each_others_places_are_seen(name, count):
    """Which no median shows; each way round, and from frame 6 on only."""
    mesh = moving(name)
    order = some_permuted(mesh, count)
    wrong = set(np.flatnonzero(order != np.arange(len(order))).tolist())
    for skin in (False, True):
        for spoilt in (
            template_of(mesh, mesh.still[order]),
            replace(mesh, frames=mesh.frames[:, order], rest=mesh.still),
        ):
            with pytest.raises(UserError, match="are elsewhere in frame 0: another order of some vertices") as e:
                check_rest(spoilt, skin)
            first = str(e.value).split("vertices ")[1].split()[0].rstrip(",")
            assert int(first) in wrong
        frames = mesh.frames.copy()
        frames[6:] = frames[6:][:, order]
        check_frames(replace(mesh, frames=frames), 6, skin)
        with pytest.raises(UserError, match=r"of frame 0 are elsewhere in frame 6: .* cut it there \(--frames 6\)"):
            check_frames(replace(mesh, frames=frames), 8, skin)


def test_a_template_that_lacks_a_scale_is_refused_or_warned_of():
    """Nothing but a scale between both is no stretching of cloth; with wrinkles on top it may be one."""
    mesh = moving("garment")
    for scales, said in (
        ([1, 1, 0.8], "1.25 along z"),
        ([0.9, 0.9, 0.9], "1.11"),
        ([0.9, 1, 1.1], "0.909 along z and"),
    ):
        with pytest.raises(UserError, match=f"frame 0 is template.obj scaled by {said}"):
            check_rest(template_of(mesh, mesh.frames[0] * np.float32(scales)))
    crumpled = mesh.frames[0] + ANY.normal(0, 0.003, mesh.still.shape).astype(np.float32)
    assert check_rest(template_of(mesh, crumpled)) == []
    squashed = template_of(mesh, crumpled * np.float32([1, 1, 0.75]))
    (line,) = check_rest(squashed)
    assert line.startswith("warning: a tenth of the edges of template.obj is off") and "scaled by 1.3" in line
    assert "along z: cloth stretches by 10 to 20 %" in line and check_rest(squashed, skin=True) == []


def test_a_mirror_image_is_known_in_any_pose_by_which_way_edges_bend():
    """A body in a walk against its rest pose, arms up to the sides; fine wrinkles and flat patterns tell nothing."""
    baked = load_body("base", "small")
    steps = walk(baked, GAITS["armspace-75"], np.linspace(0, 1, 5), np.ones(5))
    frames = pose(baked, steps.rotations, steps.root)
    body = MeshSequence("body", frames, baked.body.faces, rest=baked.body.rest, files=(Path("a.pc2"), Path("a.obj")))
    for t in range(5):
        check_rest(replace(body, frames=frames[t:]), skin=True)
        with pytest.raises(UserError, match="a.pc2: a.obj is the mirror image of frame 0; export both with the same"):
            check_rest(replace(body, frames=frames[t:] * np.float32([1, -1, 1])), skin=True)
        with pytest.raises(UserError, match="mirror image"):
            check_rest(replace(body, rest=baked.body.rest[:, [0, 2, 1]], frames=frames[t:]), skin=True)
    check_frames(body, 5, skin=True)
    cloth = moving("garment")
    noise = ANY.normal(0, 0.002, cloth.frames.shape).astype(np.float32)
    check_rest(replace(cloth, frames=cloth.frames + noise, rest=cloth.still))


@pytest.mark.parametrize("write", [pc2, mdd, usd, alembic])
def test_the_check_is_made_in_every_format_and_can_be_waived(tmp_path, capsys, write):
    """Frames in another order than the template, in which only 2 vertices are in each other's places."""

    def spoilt(mesh):
        return replace(mesh, rest=mesh.still[some_permuted(mesh, 2)])

    more = () if write in STATE_RATE else ("--fps", "25")
    code, _, err = run(tmp_path, capsys, write, (0.0, 1.0), (0.0, 1.0), *more, spoil=spoilt)
    assert code == 1 and len(err) == 1 and "of garment.obj are elsewhere in frame 0" in err[0]
    (tmp_path / "again").mkdir()
    more = ("--other-template", *more)
    assert run(tmp_path / "again", capsys, write, (0.0, 1.0), (0.0, 1.0), *more, spoil=spoilt)[0] == 0


@pytest.mark.parametrize("write", [*FORMATS, hdf5])
def test_frames_in_another_order_from_one_on_are_refused_in_every_format(tmp_path, capsys, write):
    def spoilt(mesh):
        frames = mesh.frames.copy()
        frames[4:] = frames[4:][:, some_permuted(mesh, 2)]
        return replace(mesh, frames=frames)

    more = () if write in STATE_RATE else ("--fps", "25")
    code, _, err = run(tmp_path, capsys, write, (0.0, 1.0), (0.0, 1.0), *more, spoil=spoilt)
    assert code == 1 and len(err) == 1 and "elsewhere in frame 4" in err[0] and "--frames 4" in err[0]
    if write is pc2:
        (tmp_path / "again").mkdir()
        call = (tmp_path / "again", capsys, write, (0.0, 1.0), (0.0, 1.0), *more, "--frames", "4")
        assert run(*call, spoil=spoilt)[0] == 0


@pytest.mark.parametrize("write", [npz, hdf5])
def test_a_rest_shape_within_the_file_is_judged_too(tmp_path, capsys, write):
    mesh = moving("garment")
    file, _ = write(tmp_path, "garment", replace(mesh, rest=mesh.still[some_permuted(mesh, 2)]), 0.0, 1.0)
    code, _, err = typed(capsys, "import", file, "--out", tmp_path / "x.h5")
    assert code == 1 and len(err) == 1 and "of its rest shape are elsewhere in frame 0" in err[0]
