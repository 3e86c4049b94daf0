"""Everything that is wrong with a sequence file, in one go, and a picture of its first frame."""

from pathlib import Path

from garmentbench import sequence_file
from garmentbench.errors import Problem, ProblemError, errors
from garmentbench.sequence_file.array_checks import through_itself
from garmentbench.sequence_file.checks import hash_problems, value_problems
from garmentbench.storage.atomic import written_whole


def check_sequence(path: Path) -> list[Problem]:
    """All problems of a sequence file, warnings among them; an empty list for a good one."""
    try:
        contents, problems = sequence_file.read(path)
    except ProblemError as e:
        return [e.problem]
    unusable = frozenset(p.where for p in problems)
    problems += value_problems(contents, unusable) + ([] if unusable else hash_problems(contents))
    return problems if errors(problems) else problems + through_itself(contents.arrays)


def picture(path: Path, png: Path) -> None:
    """Draw frame 0 from the front and the side into a PNG file. Raises `UserError` as `sequence_file.load`."""
    import numpy as np
    from matplotlib.image import imsave

    from garmentbench.viewing.render import CLOTH, RenderMesh, render

    sequence = sequence_file.load(path, frames=1)
    template = sequence.template
    meshes = [RenderMesh(sequence.garment[0], template.garment.faces, CLOTH, cloth=True)]
    if sequence.body is not None:
        meshes.append(RenderMesh(sequence.body[0], template.required_body.faces))
    image = np.concatenate([render(meshes, view, size=(450, 600)) for view in ("three-quarter", "back")], axis=1)
    with written_whole(png) as partial:
        imsave(partial, image, format="png")
