"""The command that looks for what is wrong with a garment's mesh or a sequence, and repairs meshes."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from tyro.conf import Positional

from garmentbench.errors import Problem, UsageError, UserError, errors

if TYPE_CHECKING:
    from garmentbench.importing.mesh_doctor.body import Wearer
    from garmentbench.importing.mesh_doctor.mesh import Mesh
    from garmentbench.sequence import Sequence


@dataclass(frozen=True)
class Check:
    """Say everything that is wrong with a garment's mesh or a sequence file; repair a mesh where that is safe.

    Example: garmentbench check shirt.obj --body base --fix shirt.npz --picture shirt.png

    Attributes:
        file: A mesh (.obj, .ply, or a garment's .npz), or a sequence (HDF5).
        picture: Also draw it into this PNG file: a mesh on its body, findings in red, or frame 0 of a sequence.
        body: Say where a mesh starts inside this body: a baked one (base, slim ...), a mesh, or a sequence's.
        body_units: The unit of a body's mesh: m, cm, mm, in or ft. Not needed for a person who stands.
        body_up: The axis that points up in a body's mesh: x, y, z, or the other way round, e.g. --body-up=-y.
        mesh: Which object of an OBJ file is the garment: a name, some with commas between, or all.
        fix: Write the garment, repaired where that is safe, to this .obj or .npz file, and check that.
        units: The mesh's unit, for --fix: m, cm, mm, in or ft. Not needed where its size tells.
        up: The axis that points up in the file, for --fix: x, y, z, or the other way round, e.g. --up=-y.
        shift: Move the mesh by this [m], for --fix: up, or x,y,z, e.g. --shift 0.9 or --shift=-2,0,0.
        make_uv: With --fix, make a UV map by xatlas where the mesh's overlaps or folds; a mesh without one gets one.
        weld: With --fix, weld borders that lie this near [m]. By default a hundred-thousandth of the garment's size.
    """

    file: Positional[Path]
    picture: Path | None = None
    body: str = ""
    body_units: str = ""
    body_up: str = ""
    mesh: str = ""
    fix: Path | None = None
    units: str = ""
    up: str = "z"
    shift: str = ""
    make_uv: bool = False
    weld: float | None = None

    def run(self) -> None:
        from garmentbench.device import quiet_warp
        from garmentbench.importing.mesh_doctor.files import is_mesh_file

        self._refuse_odd_calls()
        quiet_warp()
        if is_mesh_file(self.file) or self.fix is not None:
            self._check_mesh()
        else:
            self._check_sequence()

    def _refuse_odd_calls(self) -> None:
        from garmentbench.importing.mesh_doctor.files import writable
        from garmentbench.importing.meshes.conventions import AXES, UNITS

        for name, given in (("--units", self.units), ("--make-uv", self.make_uv), ("--weld", self.weld is not None)):
            if given and self.fix is None:
                raise UsageError(f"check: {name} says how to repair; give --fix OUT.obj or OUT.npz with it")
        for name, units in (("--units", self.units), ("--body-units", self.body_units)):
            if units and units not in UNITS:
                raise UsageError(f"{name} is '{units}'; wanted {', '.join(UNITS)}")
        for name, up in (("--up", self.up), ("--body-up", self.body_up or "z")):
            if up not in AXES:
                raise UsageError(f"{name} is '{up}'; wanted {', '.join(AXES)}")
        if (self.body_units or self.body_up) and not self.body:
            raise UsageError("check: --body-units and --body-up are a body's; give --body FILE with them")
        _shift(self.shift)
        if self.weld is not None and not 0 < self.weld < 0.1:
            raise UsageError(f"--weld is {self.weld:g}; wanted metres above 0 and below 0.1")
        if self.fix is not None:
            writable(self.fix)

    def _check_mesh(self) -> None:
        from garmentbench.importing.mesh_doctor.examine import examine, summary
        from garmentbench.importing.mesh_doctor.files import read_mesh, read_wearer, wardrobe_lines
        from garmentbench.importing.mesh_doctor.picture import picture

        wearer = read_wearer(self.body, self.body_units, self.body_up) if self.body else None
        mesh, file = read_mesh(self.file, self.mesh), self.file
        for line in () if wearer is None else wearer.assumed:
            print(f"body {self.body}: {line}")
        if self.fix is not None:
            self._mend(mesh, wearer, self.fix)
            mesh, file = read_mesh(self.fix), self.fix
        findings = examine(mesh, wearer)
        print(f"{file}: {summary(mesh)}")
        if self.picture is not None:
            picture(mesh, findings, self.picture, None if wearer is None else wearer.body)
        _verdict(file, [f.problem for f in findings])
        if self.fix is not None and self.fix.suffix == ".npz":
            print(wardrobe_lines(self.fix))

    def _mend(self, mesh: "Mesh", wearer: "Wearer | None", out: Path) -> None:
        from garmentbench.importing.mesh_doctor.files import write_mesh
        from garmentbench.importing.mesh_doctor.repairs import mend

        make_uv = self.make_uv or mesh.uv is None  # a garment can't be without
        mended, lines = mend(mesh, wearer, self.units or None, self.up, _shift(self.shift), make_uv, self.weld)
        lines += write_mesh(out, mended)
        for line in lines or ["nothing to repair"]:
            print(f"fix: {line}")
        print(f"{self.fix}: written; what is left:")

    def _check_sequence(self) -> None:
        from garmentbench import sequence_file
        from garmentbench.sequence_file.examine import check_sequence
        from garmentbench.viewing.first_frame import draw_first_frame

        problems = check_sequence(self.file)
        if not errors(problems):
            sequence = sequence_file.load(self.file)
            print(f"{self.file}: {_spread(sequence)}")
            problems += looked_into(sequence)
            if self.picture is not None:
                draw_first_frame(self.file, self.picture)
        _verdict(self.file, problems)


def looked_into(sequence: "Sequence") -> list[Problem]:
    """What is wrong with a sequence whose file is whole: a garment that isn't worn, and what its mesh is warned of."""
    from garmentbench.importing.mesh_doctor.examine import examine_template
    from garmentbench.importing.mesh_doctor.files import mesh_of
    from garmentbench.importing.mesh_doctor.unworn import never_worn
    from garmentbench.importing.mesh_doctor.worn import garment_in, of_frame

    off = never_worn(sequence)
    on_body = sequence.body is not None and not errors(off)
    first, wearer = of_frame(sequence, 0) if on_body else (garment_in(sequence, 0), None)
    found = examine_template(mesh_of(sequence.template.garment), first, wearer)
    return off + [replace(f.problem, where=f"garment {f.problem.where}", warning=True) for f in found]


def _shift(given: str) -> tuple[float, float, float]:
    """The shift of --shift. Raises `UsageError`."""
    try:
        numbers = [float(word) for word in given.split(",")] if given else [0.0]
    except ValueError:
        numbers = []
    if len(numbers) not in (1, 3) or not all(abs(x) < 100 for x in numbers):
        raise UsageError(f"--shift is '{given}'; wanted metres, up or x,y,z, e.g. 0.9 or 0,0,0.9")
    x, y, z = numbers if len(numbers) == 3 else (0.0, 0.0, numbers[0])
    return x, y, z


def _spread(sequence: "Sequence") -> str:
    """What the runs of a sequence mean for who reads errors against it."""
    from garmentbench.metrics.push_growth import regime

    if sequence.spread_cm is None:
        return "spread not measured (one run): how small a difference means something is unknown"
    growth = regime(sequence.push_growth)
    return f"spread {sequence.spread_cm:.2g} cm, {growth}: differences below the spread mean nothing"


def _verdict(file: Path, problems: list[Problem]) -> None:
    """Print the problems, errors first, and a last line. Raises `UserError` where there are errors."""
    for problem in sorted(problems, key=lambda p: p.warning):
        print(f"{'warning' if problem.warning else 'error'}: {problem}")
    from garmentbench.importing.mesh_doctor.unworn import Slipped

    bad = len(errors(problems))
    if bad:
        raise UserError(f"{file}: {bad} error{'s' if bad > 1 else ''}, listed above; the file can't be used as it is")
    off = next((p.where for p in problems if isinstance(p, Slipped)), "")
    if off:
        print(f"{file}: whole, but not worn from {off} on at the latest: see the warnings")
    else:
        print(f"{file}: {'good, but see the warnings' if problems else 'good'}")
