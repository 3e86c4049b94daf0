"""The baked garments: sizes, topology, UV charts, and that they are put on without touching."""

import numpy as np
import pytest
import trimesh
from scipy.spatial import cKDTree

from garmentbench.errors import UsageError
from garmentbench.geometry.cloth_rest import cloth_at_rest, rest_areas
from garmentbench.geometry.crossing import crossing_faces
from garmentbench.geometry.mesh import edge_lengths, unique_edges
from garmentbench.geometry.signed_distance import signed_distances
from garmentbench.motion.stick import HEIGHT, RADIUS, stick
from garmentbench.paths import GARMENTS
from garmentbench.scenes.bodies import load_body
from garmentbench.scenes.garments import garment_names, load_garment
from garmentbench.scenes.presets import PRESETS
from garmentbench.sequence import Body, Garment

SIZES = list(PRESETS)
COUNTS = {  # at smoke, laptop, desktop and paper size; the paper's own for T-shirt, bodysuit and pleated skirt
    "bodysuit": (500, 1_500, 5_000, 21_904),
    "dress": (400, 1_500, 5_000, 18_000),
    "laid_sheet": (400, 1_500, 5_000, 5_000),
    "over_skirt": (400, 1_500, 5_000, 18_000),
    "pleated_skirt": (400, 1_500, 5_000, 17_678),
    "sheet": (400, 1_500, 5_000, 5_000),
    "tshirt": (400, 1_500, 5_000, 18_902),
}
BORDERS = {"bodysuit": 5, "dress": 4, "laid_sheet": 1, "over_skirt": 2, "pleated_skirt": 2, "sheet": 1, "tshirt": 4}
CHARTS = {"bodysuit": 2, "dress": 2, "laid_sheet": 1, "over_skirt": 1, "pleated_skirt": 1, "sheet": 1, "tshirt": 4}
WAIST_HELD = {"over_skirt": 1.185, "pleated_skirt": 1.165}  # height of the upper edge [m]
BAKED = {name: [size for size in SIZES if (GARMENTS / f"{name}-{size}.npz").is_file()] for name in COUNTS}
EVERY = [(name, size) for name in COUNTS for size in BAKED[name]]
WORN = [(name, size) for name, size in EVERY if "sheet" not in name]
SHEETS = [(name, size) for name, size in EVERY if "sheet" in name]
PLEATS = {"dress": 12, "over_skirt": 14, "pleated_skirt": 18}


def sewn(garment: Garment) -> np.ndarray:
    """Faces with both copies of a seam point as one vertex."""
    number = np.arange(len(garment.rest))
    number[garment.seams[:, 1]] = garment.seams[:, 0]
    return number[garment.faces]


def directed_edges(faces: np.ndarray) -> np.ndarray:
    return faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)


def border_loops(faces: np.ndarray) -> list[np.ndarray]:
    """Vertices of each border loop; asserts that every border vertex has one edge in and one out."""
    pairs = directed_edges(faces)
    back = set(map(tuple, pairs[:, ::-1].tolist()))
    border = np.array([pair for pair in pairs.tolist() if tuple(pair) not in back])
    assert (np.unique(border[:, 0], return_counts=True)[1] == 1).all()
    return trimesh.graph.connected_components(border)


def twice_uv_area(garment: Garment) -> np.ndarray:
    a, b, c = garment.uv[garment.faces].astype(np.float64).transpose(1, 2, 0)
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def distances(garment: Garment, body: Body) -> np.ndarray:
    """Signed distances of all vertices to the surface [m], negative inside."""
    return signed_distances(garment.rest[None], body.rest[None], body.faces)[0]


def test_names():
    assert garment_names() == sorted(COUNTS)


@pytest.mark.parametrize(("name", "size"), [("tshrt", "laptop"), ("tshirt", "lapdog")])
def test_unknown_name_or_size_tells_the_nearest(name, size):
    with pytest.raises(UsageError, match="did you mean '(tshirt|laptop)'"):
        load_garment(name, size)


@pytest.mark.parametrize(("name", "size"), EVERY)
def test_counts_types_and_file_size(name, size):
    garment = load_garment(name, size)
    share = 0.05 if size == "smoke" else 0.03  # a row more or less of pleats is 6 % of a smoke mesh
    assert len(garment.rest) == pytest.approx(COUNTS[name][SIZES.index(size)], rel=share)
    assert (garment.rest.dtype, garment.uv.dtype) == (np.float32, np.float32)
    assert {a.dtype for a in (garment.faces, garment.seams, garment.pins)} == {np.dtype(np.int32)}
    np.testing.assert_array_equal(np.unique(garment.faces), np.arange(len(garment.rest)))
    path = GARMENTS / f"{name}-{size}.npz"
    assert path.stat().st_size < 1.5e6
    with np.load(path) as file:
        assert str(file["licence"]) == "CC0-1.0"


@pytest.mark.parametrize(("name", "size"), EVERY)
def test_manifold_oriented_and_in_one_piece(name, size):
    faces = sewn(load_garment(name, size))
    pairs = directed_edges(faces)
    assert len(np.unique(pairs, axis=0)) == len(pairs)  # each direction once: manifold and consistently oriented
    assert len(trimesh.graph.connected_components(pairs)) == 1
    assert len(border_loops(faces)) == BORDERS[name]


@pytest.mark.parametrize("size", BAKED["tshirt"])
def test_tshirt_openings_lie_where_they_should(size):
    garment = load_garment("tshirt", size)
    middles = np.array([garment.rest[loop].mean(axis=0) for loop in border_loops(sewn(garment))])
    order = np.argsort(middles[:, 0])
    right, left = middles[order[[0, 3]]]
    hem, collar = sorted(middles[order[1:3]], key=lambda middle: middle[2])
    np.testing.assert_allclose(right * [-1, 1, 1], left, atol=0.01)
    assert 0.25 < left[0] < 0.40 and hem[2] < 1.0 < left[2] < collar[2]
    np.testing.assert_allclose([hem[0], collar[0]], 0, atol=0.01)


@pytest.mark.parametrize(("name", "size"), WORN)
def test_seam_copies_coincide_in_space_and_not_in_uv(name, size):
    garment = load_garment(name, size)
    a, b = garment.seams.T
    np.testing.assert_array_equal(garment.rest[a], garment.rest[b])
    assert np.linalg.norm(garment.uv[a] - garment.uv[b], axis=1).min() > 0.025
    assert len(np.unique(b)) == len(b) and not np.isin(a, b).any()  # the first copy with each of the others
    apart = np.delete(garment.rest, garment.seams[:, 1], axis=0)
    assert cKDTree(apart).query(apart, k=2)[0][:, 1].min() > 0  # no seam is left unsewn


@pytest.mark.parametrize(("name", "size"), EVERY)
def test_no_slivers(name, size):
    garment = load_garment(name, size)
    corners = cloth_at_rest(garment)[garment.faces]
    lengths = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
    assert lengths.min() > 0.3 * np.median(lengths)
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    assert (2 * area / lengths.max(axis=1)).min() > 0.12 * np.median(lengths)


@pytest.mark.parametrize(("name", "size"), EVERY)
def test_uv_charts_fill_the_square_without_flips(name, size):
    garment = load_garment(name, size)
    assert garment.uv.min() > 0.02 and garment.uv.max() < 0.98
    np.testing.assert_allclose(np.ptp(garment.uv, axis=0), 0.94, atol=1e-5)
    area = twice_uv_area(garment)
    assert area.min() > 0
    charts = trimesh.graph.connected_components(directed_edges(garment.faces))
    assert len(charts) == CHARTS[name]
    cloth = rest_areas(garment)
    stretch = area / cloth / (area.sum() / cloth.sum())
    assert stretch.min() > 0.1 and stretch.max() < 2.0
    low, high = np.percentile(stretch, [1, 99])
    assert low > 0.4 and high < 1.6


@pytest.mark.parametrize(("name", "size"), EVERY)
def test_uv_triangles_do_not_overlap(name, size):
    """Rastered: no texel's centre lies in two triangles."""
    garment = load_garment(name, size)
    texels = int(4 * np.sqrt(len(garment.faces)))
    corners = garment.uv[garment.faces].astype(np.float64) * texels - 0.5
    low = np.ceil(corners.min(axis=1))
    reach = np.floor((corners.max(axis=1) - low).max(axis=0)).astype(int)
    hits = np.zeros((texels, texels), int)
    for step in np.ndindex(*reach + 1):
        texel = low + step
        inside = np.ones(len(low), bool)
        for a, b in zip(corners.transpose(1, 2, 0), np.roll(corners, -1, axis=1).transpose(1, 2, 0), strict=True):
            inside &= (b[0] - a[0]) * (texel[:, 1] - a[1]) - (b[1] - a[1]) * (texel[:, 0] - a[0]) > 1e-9
        np.add.at(hits, tuple(texel[inside].astype(int).T), 1)
    assert hits.max() == 1
    assert hits.mean() == pytest.approx(twice_uv_area(garment).sum() / 2, abs=0.02)


# [%] by which the T-shirt's pattern is wider than how it is put on, least and most
EASE = {"chest": (6, 12), "waist": (6, 12), "sleeve": (6, 14)}


def girths(garment: Garment, normal: list[float], at: float, panels: list[int]) -> tuple[float, float]:
    """Lengths [m], as it is put on and in the pattern, of the line where the plane normal . x = at cuts some panels."""
    number = np.zeros(len(garment.rest), int)
    for k, chart in enumerate(trimesh.graph.connected_components(directed_edges(garment.faces))):
        number[chart] = k
    rest, cut = garment.rest.astype(np.float64), cloth_at_rest(garment)
    level = rest @ np.array(normal) - at
    total = np.zeros(2)
    for face in garment.faces[np.isin(number[garment.faces[:, 0]], panels)]:
        ends = [
            [(level[a] * x[b] - level[b] * x[a]) / (level[a] - level[b]) for x in (rest, cut)]
            for a, b in zip(face, np.roll(face, 1), strict=True)
            if (level[a] > 0) != (level[b] > 0)
        ]
        if ends:
            total += [np.linalg.norm(one - other) for one, other in zip(*ends, strict=True)]
    return float(total[0]), float(total[1])


@pytest.mark.parametrize("size", SIZES)
def test_the_tshirt_is_cut_with_ease(size):
    """Round the chest, the waist and the left sleeve."""
    garment = load_garment("tshirt", size)
    middles = [garment.rest[c].mean(axis=0) for c in trimesh.graph.connected_components(directed_edges(garment.faces))]
    torso = [k for k, middle in enumerate(middles) if np.abs(middle[0]) < 0.05]
    planes = {
        "chest": ([0, 0, 1], 1.26, torso),
        "waist": ([0, 0, 1], 1.10, torso),
        "sleeve": ([0.66, 0, -0.75], -0.83, [k for k, middle in enumerate(middles) if middle[0] > 0.15]),
    }
    for place, (low, high) in EASE.items():
        worn, laid = girths(garment, *planes[place])
        assert low <= 100 * (laid / worn - 1) <= high, (place, worn, laid)


@pytest.mark.parametrize("body_size", ["small", "full"])
@pytest.mark.parametrize(("name", "size"), WORN)
def test_is_off_the_skin(name, size, body_size):
    assert distances(load_garment(name, size), load_body("base", body_size).body).min() > 0.004


@pytest.mark.parametrize("size", SIZES)
def test_over_skirt_is_off_the_dress(size):
    dress = load_garment("dress", size)
    beneath = Body("dress", dress.rest, sewn(dress), kind="garment")
    assert distances(load_garment("over_skirt", size), beneath).min() > 0.004


@pytest.mark.parametrize(("name", "size"), WORN)
def test_faces_outwards(name, size):
    """Away from the nearest point of the body, on almost every face: a pleat's sides may turn a little inwards."""
    garment, body = load_garment(name, size), load_body("base", "small").body
    corners = garment.rest[garment.faces].astype(np.float64)
    middles, normals = corners.mean(axis=1), np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    away = middles - body.rest[cKDTree(body.rest).query(middles)[1]]
    assert (np.einsum("fc,fc->f", normals, away) > 0).mean() > 0.97


@pytest.mark.parametrize("size", BAKED["tshirt"])
def test_tshirt_is_loose_round_the_hips(size):
    garment = load_garment("tshirt", size)
    off = distances(garment, load_body("base", "small").body)
    assert np.median(off[garment.rest[:, 2] < 1.05]) > 0.015


@pytest.mark.parametrize(("name", "size"), WORN)
def test_only_waistbands_are_held_by_pins(name, size):
    garment = load_garment(name, size)
    if name not in WAIST_HELD:
        assert len(garment.pins) == 0
        return
    rest = garment.rest.astype(np.float64)
    assert len(np.unique(garment.pins)) == len(garment.pins)
    ring = max(border_loops(sewn(garment)), key=lambda loop: rest[loop, 2].mean())
    assert set(ring) <= set(garment.pins)  # the whole upper edge ...
    np.testing.assert_allclose(rest[ring, 2], WAIST_HELD[name], atol=0.003)
    assert rest[garment.pins, 2].min() > WAIST_HELD[name] - 0.03  # ... and nothing below the waistband
    copies = np.isin(garment.seams, garment.pins)
    np.testing.assert_array_equal(copies[:, 0], copies[:, 1])


@pytest.mark.parametrize(("name", "size"), EVERY)
def test_does_not_cross_itself_at_rest(name, size):
    garment = load_garment(name, size)
    assert not crossing_faces(garment.rest[None], garment.faces, garment.seams).any()


@pytest.mark.parametrize("size", SIZES)
def test_waistband_of_the_pleated_skirt_lies_on_the_skin(size):
    garment = load_garment("pleated_skirt", size)
    for body_size in ("small", "full"):
        off = distances(garment, load_body("base", body_size).body)[garment.pins]
        assert off.min() > 0.004 and off.max() < 0.008


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("name", PLEATS)
def test_hem_is_pleated(name, size):
    """Round the hem the distance from the axis rises and falls once a pleat, by centimetres."""
    garment = load_garment(name, size)
    rest = garment.rest.astype(np.float64)
    loops = border_loops(sewn(garment))
    hem = min(loops, key=lambda loop: rest[loop, 2].mean())
    around = rest[hem] - rest[hem].mean(axis=0)
    order = np.argsort(np.arctan2(around[:, 1], around[:, 0]))
    reach = np.linalg.norm(around[order, :2], axis=1)
    ridges = (reach > np.roll(reach, 1)) & (reach > np.roll(reach, -1))
    assert ridges.sum() == PLEATS[name]
    assert reach[ridges].mean() - reach[(reach < np.roll(reach, 1)) & (reach < np.roll(reach, -1))].mean() > 0.03


@pytest.mark.parametrize(("name", "size"), SHEETS)
def test_sheets_are_off_the_stick_and_their_pattern_is_a_square(name, size):
    garment = load_garment(name, size)
    assert distances(garment, stick()).min() > 0.003
    assert garment.cut is not None
    np.testing.assert_allclose(np.ptp(garment.cut, axis=0), 0.9 if name == "laid_sheet" else 0.6, rtol=1e-5)
    edges = unique_edges(garment.faces)
    strain = edge_lengths(garment.rest, edges) / edge_lengths(cloth_at_rest(garment), edges) - 1
    assert np.abs(strain).max() < 0.06  # put on nearly without strain


@pytest.mark.parametrize("size", SIZES)
def test_sheet_is_held_at_seven_points_on_the_stick(size):
    garment = load_garment("sheet", size)
    pins = garment.rest[garment.pins].astype(np.float64)
    assert len(pins) == 7 and np.ptp(np.diff(np.sort(pins[:, 0]))) < 1e-4
    assert (np.linalg.norm(pins[:, 1:] - [0, HEIGHT], axis=1) < RADIUS + 0.01).all()


@pytest.mark.parametrize("size", SIZES)
def test_laid_sheet_hangs_on_both_sides_and_is_held_by_nothing(size):
    garment = load_garment("laid_sheet", size)
    assert len(garment.pins) == 0
    front, behind = (garment.rest[side, 2].min() for side in (garment.rest[:, 1] < 0, garment.rest[:, 1] > 0))
    assert HEIGHT - 0.5 < behind < front - 0.05 and front < HEIGHT - 0.2


@pytest.mark.parametrize("name", COUNTS)
def test_card_says_what_the_files_hold(name):
    card = (GARMENTS / "README.md").read_text().split(f"## {name}\n")[1].split("\n## ")[0]
    for size in BAKED[name]:
        garment = load_garment(name, size)
        mm = edge_lengths(garment.rest, unique_edges(sewn(garment))) * 1e3
        edges = f"{mm.min():.0f} / {np.median(mm):.0f} / {mm.max():.0f}"
        assert f"| {size} | {len(garment.rest):,} | {len(garment.faces):,} | {edges} |" in card
    picture = f"cards/{name}.png"
    assert picture in card and 0 < (GARMENTS / picture).stat().st_size < 100_000
