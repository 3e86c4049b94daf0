"""Each fault is found on a mesh that has that fault and no other, and nothing is found on clean meshes."""

from dataclasses import replace

import numpy as np
import pytest
from faulty_meshes import COLUMNS, at, ball, more, moved, parted, tube, with_uv

from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.importing.mesh_doctor.body import of_body
from garmentbench.importing.mesh_doctor.examine import examine, examine_template, summary
from garmentbench.importing.mesh_doctor.files import mesh_of, read_mesh, read_wearer
from garmentbench.importing.mesh_doctor.mesh import Mesh
from garmentbench.importing.mesh_doctor.substeps import cost
from garmentbench.paths import GARMENTS
from garmentbench.scenes.garments import load_garment
from garmentbench.scenes.material import Material, Settings
from garmentbench.simulation.assembly import assemble
from garmentbench.simulation.time_step import substeps

CLEAN = tube()
INNER = at(10, 10)  # an inner vertex
FREE_UV = np.array([[0.95, 0.95], [0.99, 0.95], [0.95, 0.99]])  # where the tube's chart is not


def told(mesh: Mesh, body=None) -> list[str]:
    """Findings as the command prints them."""
    found = examine(mesh, None if body is None else of_body(body))
    return [f"{'warning' if f.problem.warning else 'error'}: {f.problem}" for f in found]


def turned(mesh: Mesh, faces) -> Mesh:
    turned = mesh.faces.copy()
    turned[faces] = turned[faces][..., ::-1]
    return replace(mesh, faces=turned)


def fin() -> Mesh:
    """A third face on the edge between two inner vertices, its UV in a free place."""
    a, b = at(10, 10), at(10, 11)
    ends = CLEAN.vertices[[a, b]]
    return more(CLEAN, [*ends, ends.mean(axis=0) * [1.2, 1.2, 1]], [[-3, -2, -1]], FREE_UV, [[a, -3], [b, -2]])


def scrap(near: int) -> Mesh:
    """A triangle of its own, with a corner at a vertex of the tube."""
    corner = CLEAN.vertices[near]
    return more(CLEAN, [corner, corner * [1.3, 1.3, 1], corner * [1.3, 1.3, 1] + [0, 0, 0.02]], [[-3, -2, -1]], FREE_UV)


def flap() -> Mesh:
    """A triangle that shares one border vertex with the tube and no edge."""
    corner = CLEAN.vertices[at(0, 5)]
    more_vertices = [corner, corner + [0, 0, -0.02], corner + [0.02, 0, -0.02]]
    return more(CLEAN, more_vertices, [[-3, -2, -1]], FREE_UV, [[at(0, 5), -3]])


def moebius() -> Mesh:
    """A closed strip with half a twist, 0.6 m across."""
    count = 80
    turn = 2 * np.pi * np.arange(count) / count
    out = np.stack([np.cos(turn) * np.cos(turn / 2), np.sin(turn) * np.cos(turn / 2), np.sin(turn / 2)], axis=1)
    middle = 0.3 * np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=1)
    vertices = np.concatenate([middle - 0.03 * out, middle + 0.03 * out])
    low, high = np.arange(count), np.arange(count) + count
    next_low, next_high = np.roll(low, -1), np.roll(high, -1)
    next_low[-1], next_high[-1] = count, 0
    faces = np.concatenate([np.stack([low, next_low, high], 1), np.stack([next_low, next_high, high], 1)])
    return Mesh("strip", vertices[:, [0, 2, 1]], faces, None, np.arange(2 * count))


def overlapping() -> Mesh:
    """Two charts, the upper one laid onto the lower one's upper part."""
    mesh = parted(CLEAN, 15, sewn=True)
    upper = np.unique(mesh.faces[2 * COLUMNS * 15 :])
    return with_uv(mesh, upper, mesh.uv[upper] - [0, 0.225])


def folded() -> Mesh:
    """One UV coordinate moved across its neighbours."""
    return with_uv(CLEAN, INNER, CLEAN.uv[at(10, 12)])


def not_quite_on(vertex: int, target: int, share: float) -> Mesh:
    way = CLEAN.vertices[target] - CLEAN.vertices[vertex]
    return moved(CLEAN, vertex, CLEAN.vertices[vertex] + share * way)


def lying(mesh: Mesh, lift: float) -> Mesh:
    """Brought to y up, its middle `lift` over the floor."""
    return replace(mesh, vertices=(mesh.vertices + [0, 0, lift]) @ np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]]))


def test_clean_meshes_have_no_findings():
    assert told(CLEAN) == [] and told(CLEAN, ball()) == []
    assert told(parted(CLEAN, 15, sewn=True)) == []
    assert told(mesh_of(tiny_sequence(1).template.garment)) == []


@pytest.mark.parametrize("file", sorted(GARMENTS.glob("*.npz")), ids=lambda path: path.stem)
def test_baked_garments_have_no_errors(file):
    worn = None if "sheet" in file.stem else read_wearer("base")  # a sheet is nobody's
    found = examine(read_mesh(file), worn)
    assert not [str(f.problem) for f in found if not f.problem.warning]


def hole() -> Mesh:
    return replace(CLEAN, faces=np.delete(CLEAN.faces, 900, axis=0))


FAULTS = {
    "three faces at an edge": (fin, [
        f"error: edges: 1 edge with more than two faces (not manifold), at {at(10, 10)}-{at(10, 11)};"]),
    "flipped faces": (lambda: turned(CLEAN, [7, 500, 501]), [
        "error: winding: 3 flipped faces (run against their neighbours), at face 7, 500, 501;"]),
    "inside out": (lambda: turned(CLEAN, slice(None)), [
        "warning: winding: the whole garment (3600 faces) inside out: its normals point towards the inside of the "
        "volume"]),
    "a piece inside out": (lambda: turned(replace(CLEAN, faces=np.delete(CLEAN.faces, slice(1200, 1320), axis=0)), slice(1200)), [
        "warning: winding: 1 patch of the garment (1200 faces) inside out", "warning: pieces: 2 pieces"]),
    "one-sided": (moebius, [
        "error: winding: 1 piece with only one side (a Moebius strip), at face 0, 1, 2, 3, 4 ...;",
        "error: uv: the mesh has no UV map; unwrap"]),
    "no area": (lambda: moved(CLEAN, at(0, 5), CLEAN.vertices[[at(0, 4), at(1, 4)]].mean(axis=0)), [
        "error: faces: 1 face without area, at face 8;"]),
    "no length": (lambda: not_quite_on(INNER, INNER + 1, 1.0), [
        "error: faces: 2 faces without area, at face 1101, 1220", f"error: edges: 1 edge without length, at {INNER}-{INNER + 1};"]),
    "a short edge": (lambda: not_quite_on(INNER, INNER + 1, 0.89), [
        "warning: edges: 1 edge shorter than a tenth of the median, the shortest 1.7 mm of 20 mm, at "]),
    "slivers": (lambda: moved(CLEAN, at(0, 5), 0.501 * CLEAN.vertices[at(0, 4)] + 0.499 * CLEAN.vertices[at(1, 4)] + [0, 2e-4, 0]), [
        "warning: faces: 1 sliver (height below 0.05 of the longest edge"]),
    "faces twice": (lambda: replace(CLEAN, faces=np.concatenate([CLEAN.faces, CLEAN.faces[[30, 4]][:, ::-1]])), [
        "error: faces: 2 faces with the same corners as another, at face 3600, 3601; delete"]),
    "unused vertices": (lambda: more(CLEAN, [[0, 0, 0], [9, 9, 9]], [], [[0, 0], [3, 3]]), [
        "error: vertices: 2 vertices without a face, at vertex 1891, 1892;"]),
    "a piece of its own, touching": (lambda: scrap(INNER), [
        "warning: pieces: 2 pieces that nothing joins, of 3600, 1 faces, the first faces 0, 3600;",
        f"warning: vertices: 2 vertices on top of another, along no common border, at vertex {INNER}, 1891;"]),
    "pieces that share a vertex": (flap, [
        "warning: edges: 1 point where pieces touch and share no edge, at vertex 5;"]),
    "a hole": (hole, [
        "warning: openings: 1 hole of less than a tenth of the cloth's size around (3 openings in all), at vertex "]),
    "a crack": (lambda: parted(CLEAN, 15, sewn=False), [
        "warning: pieces: 2 pieces", "error: cracks: 60 edges where borders coincide and are not joined"]),
    "a seam left out": (lambda: replace(CLEAN, seams=CLEAN.seams[:0]), [
        "error: seams: 30 edges of UV seams that the file's seams leave out, at"]),
    "a seam of a file without seams": (lambda: replace(CLEAN, seams=CLEAN.seams[:0], says_seams=False), [
        "warning: seams: 30 edges of UV seams whose two sides are joined by position only, at"]),
    "a seam apart": (lambda: moved(CLEAN, at(7, 0), CLEAN.vertices[at(7, 0)] + [0.002, 0, 0]), [
        f"warning: seams: 1 seam pair apart at rest, by up to 2 mm, at {at(7, 0)}-{at(7, COLUMNS)};"]),
    "no UV": (lambda: replace(CLEAN, uv=None), ["error: uv: the mesh has no UV map; unwrap"]),
    "UV for some": (lambda: with_uv(CLEAN, INNER, np.nan), ["error: uv: 6 faces without UV coordinates, at face"]),
    "UV on a line": (lambda: replace(CLEAN, uv=CLEAN.uv * [1, 0]), ["error: uv: the UV map has no area"]),
    "UV outside": (lambda: replace(CLEAN, uv=CLEAN.uv * 1.2 - [0.5, 0]), [
        "error: uv: 967 vertices outside [0, 1] (UV reach from (-0.5, 0) to (0.58, 1.08)), at vertex 0, 1, 2, 3, 4 "
        "...;"]),
    "UV without area": (lambda: with_uv(CLEAN, at(0, 0), CLEAN.uv[[at(1, 0), at(0, 1)]].mean(axis=0)), [
        "warning: uv: 1 face without area in UV, at face 0;"]),
    "a fold in UV": (folded, [
        "warning: uv: 2 faces flipped in UV against the rest of the chart, at face", " faces overlap in UV (within 1 chart), by "]),
    "overlapping charts": (overlapping, ["error: uv: 1920 faces overlap in UV (1 pair of charts), by 25 % of the map, most of all"]),
    "centimetres": (lambda: CLEAN.scaled(180.0), [
        "error: scale: measures 132 across, wanted 0.05 to 8 m: in cm; multiply all positions by 0.01"]),
    "centimetres or inches": (lambda: CLEAN.scaled(40.0), [
        "the unit can't be told from that: cm (0.29 m) or in (0.75 m)?; say which with --fix and --units"]),
    "millimetres": (lambda: CLEAN.scaled(1000.0), [": in mm; multiply all positions by 0.001"]),
    "some unit": (lambda: CLEAN.scaled(400.0), ["the unit can't be told from that: cm (2.9 m) or mm (0.29 m)?; say which with --fix and --units"]),
    "y up, by place": (lambda: lying(CLEAN, 1.0), [
        "warning: axes: y looks like up, wanted z: its middle lies 1 m along y and 0 m along z; turn it"]),
    "y up, by shape": (lambda: replace(CLEAN, vertices=lying(CLEAN, 0).vertices * [3, 1, 0.5]), [
        "warning: axes: y looks like up, wanted z: it measures 0.9 x 0.6 x 0.15 m, and is thin along z;"]),
    "NaN": (lambda: moved(CLEAN, 9, np.nan), ["error: vertices: 1 vertex with NaN or infinite positions, at vertex 9;"]),
    "infinite": (lambda: moved(CLEAN, 9, np.inf), ["error: vertices: 1 vertex with NaN"]),
}  # fmt: skip


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_is_found_and_nothing_else(fault):
    make, expected = FAULTS[fault]
    lines = told(make())
    assert len(lines) == len(expected) and all(e in line for e, line in zip(expected, lines, strict=True)), lines
    assert all(line.count("\n") == 0 and "; " in line for line in lines)


def test_closed_surfaces_have_no_opening():
    body = ball()
    mesh = Mesh("ball", body.rest.astype(np.float64), body.faces.astype(np.int64), None, np.arange(len(body.rest)))
    assert told(mesh) == [
        "warning: openings: no opening at all: a closed surface, as cloth with a thickness has; keep one sheet of it, "
        "the simulator gives it its thickness",
        "error: uv: the mesh has no UV map; unwrap the garment (--fix OUT does, by xatlas)",
    ]


def test_penetration_says_how_many_how_deep_and_where():
    inside = moved(CLEAN, at(20, 0), [0.1, 0, 0.1])  # the ball's radius there is 0.144
    inside = moved(inside, at(20, COLUMNS), [0.1, 0, 0.1])
    (line,) = told(inside, ball())
    assert line.startswith("error: body: 2 vertices (0.1 %) inside 'ball', ") and "near upper (2)" in line
    assert f"vertex {at(20, 0)} at (0.100, 0.000, 0.100)" in line
    depth = float(line.split(" mm deep")[0].rsplit(" ", 1)[1])
    assert depth == pytest.approx(44, abs=1)
    assert (
        told(more(CLEAN, [[0, 0, 0]], [], [[0, 0]]), ball())[1:] == []
    )  # what no face uses is told of, but not as inside
    shallow = told(moved(CLEAN, at(20, 7), 0.94 * CLEAN.vertices[at(20, 7)]), ball())
    assert (
        len(shallow) == 1 and shallow[0].startswith("warning: body: 1 vertex (0.1 %)") and "push them out" in shallow[0]
    )


def test_an_open_body_is_told():
    body = ball()
    (line,) = told(CLEAN, replace(body, faces=body.faces[1:]))
    assert line.startswith("warning: body: 'ball' is not closed (3 border edges)")


def test_the_body_decides_which_side_is_out():
    half = CLEAN.faces[CLEAN.vertices[CLEAN.faces][..., 1].min(axis=1) > 0.05]  # an open sheet in front of the ball
    apron = replace(CLEAN, faces=half)
    assert not any("inside out" in line for line in told(apron, ball()))
    assert any(
        "inside out: its normals point towards 'ball'" in line for line in told(turned(apron, slice(None)), ball())
    )


def test_a_flat_sheet_has_no_inside():
    flat = replace(
        CLEAN, vertices=np.column_stack([CLEAN.uv[:, 0], 0 * CLEAN.uv[:, 0], CLEAN.uv[:, 1]]), seams=CLEAN.seams[:0]
    )
    assert told(flat) == [] and told(turned(flat, slice(None))) == []


def test_baked_parts_are_called_by_their_bones():
    shirt = mesh_of(load_garment("tshirt", "smoke"))
    sleeve = np.argmax(shirt.vertices[:, 0])
    line = [
        x.problem for x in examine(moved(shirt, sleeve, shirt.vertices[sleeve] - [0, 0, 0.05]), read_wearer("base"))
    ][-1]
    assert line.where == "body" and "near upper_arm.L (1)" in line.what


def test_a_few_places_that_set_the_time_step_are_told():
    """Squeezed to a fifth, nine vertices of 1891 cost everybody nearly half as many substeps again."""
    patch = [at(10 + i, 10 + k) for i in (-1, 0, 1) for k in (-1, 0, 1)]
    squeezed = moved(CLEAN, patch, CLEAN.vertices[INNER] + 0.2 * (CLEAN.vertices[patch] - CLEAN.vertices[INNER]))
    before, after = cost(CLEAN), cost(squeezed)
    assert after.substeps > 1.4 * before.substeps and after.vertex == INNER
    assert after.even == pytest.approx(before.substeps, rel=0.3)
    (line,) = told(squeezed)
    assert (
        line.startswith(f"warning: substeps: a frame takes {after.substeps} substeps")
        and f"vertex {INNER} at (" in line
    )


def test_cost_is_the_simulator_s():
    garment = load_garment("tshirt", "smoke")
    fabric = assemble(garment, Material(), Settings())
    assert cost(mesh_of(garment)).substeps == substeps(fabric, Material(), Settings(), 1 / 30)


def test_summary_says_what_there_is():
    assert summary(CLEAN).startswith("1891 vertices, 3600 faces, 1 piece, 2 openings, 0.3 x 0.3 x 0.6, 1 UV chart, ")
    assert summary(CLEAN).endswith(" substeps a frame with the default material")
    assert "substeps" not in summary(CLEAN.scaled(100.0))


def test_a_sequence_s_garment_is_checked_for_what_its_own_checks_leave_out():
    faulty = turned(overlapping(), [7])
    inside_out = replace(CLEAN, faces=CLEAN.faces[:, ::-1])
    assert examine_template(CLEAN, CLEAN, None) == []
    assert [f.problem.where for f in examine_template(faulty, faulty, None)] == ["winding", "uv"]
    (found,) = examine_template(CLEAN, inside_out, None)  # sides are judged as it is worn
    assert found.problem.where == "winding" and "inside out" in found.problem.what


@pytest.mark.parametrize("seed", [0, 1])
def test_the_order_of_vertices_and_faces_and_the_place_do_not_matter(seed):
    random = np.random.default_rng(seed)
    mesh = turned(overlapping(), [7, 500])
    order, faces = random.permutation(len(mesh.vertices)), random.permutation(len(mesh.faces))
    place = np.argsort(order)
    other = replace(
        mesh,
        vertices=mesh.vertices[order] + [0.3, -0.2, 0],
        uv=mesh.uv[order],
        faces=np.roll(place[mesh.faces[faces]], seed, axis=1),
        seams=place[mesh.seams],
    )
    for a, b in zip(examine(mesh), examine(other), strict=True):
        assert (a.problem.where, len(a.faces), len(a.edges)) == (b.problem.where, len(b.faces), len(b.edges))


def test_twenty_thousand_vertices_take_less_than_five_seconds():
    import time

    garment, body = mesh_of(load_garment("tshirt", "paper")), read_wearer("base")
    start = time.process_time()
    examine(garment, body)
    assert time.process_time() - start < 5
