"""The table "what a scene asks for"."""

import math

from garmentbench.evals.difficulty.headline import COUNT, FORETOLD, FRAMES, LEFT, PAYS, Demand, headline, verdict
from garmentbench.report.cells import ABSENT, number, value_cell
from garmentbench.report.lines import REFERENCE, Line
from garmentbench.report.table import Cell, Table
from garmentbench.scenes.training_sets import MARK, what_is_new

STATIC, DYNAMIC = "static_ridge", ("linear_subspace", "linear_memory", "subspace_network", "pose_gru")
METHODS = ("skinning", STATIC, *DYNAMIC, "tuned")  # the last is seen beside them, and says nothing of a scene


def difficulty_table(lines: list[Line], title: str) -> Table:
    """A row a scene: what was measured of it, how simple methods and `tuned` do, and what it is good for."""
    scenes = _by_scene(lines)
    demands = {scene: demand(scene, found) for scene, found in scenes.items()}
    chosen, qualify = headline(list(demands.values()))
    rows = []
    for scene in sorted(scenes, key=lambda s: (demands[s].what_is_new != "new phrase", demands[s].what_is_new, s)):
        found, asked = scenes[scene], demands[scene]
        errors = [value_cell(found[m].value("rollout_l2")) if m in found else Cell(ABSENT) for m in METHODS]
        rows.append([
            Cell(scene, bold=scene in chosen), Cell(asked.what_is_new), Cell(str(asked.frames)),
            _cell(of(found, REFERENCE, "variation")), _cell(asked.spread), *errors, _cell(asked.floor),
            *map(_cell, asked.ratios), Cell(verdict(asked, chosen)),
        ])  # fmt: skip
    header = [
        "scene", "what is new", "frames", "variation [cm]", "spread [cm]",
        *(f"{m.replace('_', ' ')} [cm]" for m in METHODS),
        "PCA floor [cm]", "static / dynamic", "dynamic / floor", "spread / dynamic", "good for",
    ]  # fmt: skip
    return Table("difficulty", title, _caption(chosen, qualify), header, rows, frozenset({0, 1, len(header) - 1}))


def headline_scenes(lines: list[Line]) -> list[str]:
    """The headline scenes, best first, of the lines that results.csv has of the experiment."""
    return headline([demand(scene, found) for scene, found in _by_scene(lines).items()])[0]


def demand(scene: str, found: dict[str, Line]) -> Demand:
    """What a scene's lines, by method, say of it."""
    learnt = next((line.train_scenes for line in found.values() if MARK in line.train_scenes), "")
    errors = {method: of(found, method, "rollout_l2") for method in (STATIC, *DYNAMIC)}
    dynamic = [errors[m] for m in DYNAMIC if not math.isnan(errors[m])]
    frames = max((int(h) for line in found.values() for h in line.rows.horizon.dropna()), default=0)
    return Demand(
        scene,
        what_is_new(scene, learnt.partition(MARK)[2]),
        frames,
        errors[STATIC],
        min(dynamic, default=math.nan),
        of(found, REFERENCE, "pca_floor"),
        of(found, REFERENCE, "spread"),
    )


def of(found: dict[str, Line], method: str, metric: str) -> float:
    """A method's value on a scene; NaN where it has none, or not from every seed."""
    value = found[method].value(metric) if method in found else None
    return math.nan if value is None or value.endings else value.mean


def _by_scene(lines: list[Line]) -> dict[str, dict[str, Line]]:
    """Each scene's lines, by method."""
    names = dict.fromkeys(line.scene for line in lines)
    return {scene: {line.method: line for line in lines if line.scene == scene} for scene in names}


def _cell(value: float) -> Cell:
    return Cell(ABSENT if math.isnan(value) else number(value))


def _caption(chosen: list[str], qualify: int) -> str:
    rule = (
        f"A scene of new phrases with {FRAMES} frames or more is a headline (bold) if the static ridge (half a second "
        f"of poses, no garment state) errs at least {PAYS:g} times the best baseline that has one, that at least "
        f"{LEFT:g} times the floor of the codes, and the spread is at most {FORETOLD:g} of it"
    )
    if qualify >= COUNT:
        met = f"{qualify} scenes meet that: {', '.join(chosen)}"
    elif chosen:
        met = f"{qualify} meet that, fewer than {COUNT}: the headline is what comes nearest, {', '.join(chosen)}"
    else:
        met = "no scene here is long enough"
    return (
        "How much the garment moves in the body's own frame, what another run of the simulator errs by, errors of free "
        "roll-outs of simple methods, and of tuned, that were trained on one set of scenes, and the error of the best "
        "codes in the same subspace; errors are distances to the reference's first run, from which the roll-outs "
        f"begin. {rule}; {met}. Scenes of a new kind of motion, or on a new body, test generalisation: there "
        "extrapolation of the pose decides."
    )
