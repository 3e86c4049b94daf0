"""The rungs of the ladder, and which of them make the short ones."""

from garmentbench.evals.stability.course import Course, Rung

CLOTH, MOTION, BODY, START, TIME, NUMBERS = "cloth", "motion", "body", "start", "time", "numbers"


PLAIN = Course()


def _rung(name: str, title: str, group: str, step: int = 1, starts: int = 10, unmoved: bool = False, **course) -> Rung:
    return Rung(name=name, title=title, group=group, course=Course(**course), step=step, starts=starts, unmoved=unmoved)


RUNGS = (
    _rung("no-stress", "no stress", CLOTH),
    _rung("stretch-10", "stretch × 10", CLOTH, material=(("stretch", 10.0),)),
    _rung("stretch-100", "stretch × 100", CLOTH, material=(("stretch", 100.0),)),
    _rung("stretch-1000", "stretch × 1,000", CLOTH, material=(("stretch", 1000.0),)),
    _rung("leather", "leather", CLOTH, fabric="leather"),
    _rung("silk", "silk", CLOTH, fabric="silk"),
    _rung("bending-0", "bending × 0", CLOTH, material=(("bending", 0.0),)),
    _rung("bending-100", "bending × 100", CLOTH, material=(("bending", 100.0),)),
    _rung("density-0.1", "density × 0.1", CLOTH, material=(("density", 0.1),)),
    _rung("density-10", "density × 10", CLOTH, material=(("density", 10.0),)),
    _rung("friction-0", "friction 0", CLOTH, friction=0.0),
    _rung("friction-1", "friction 1", CLOTH, friction=1.0),
    _rung("speed-2", "speed × 2", MOTION, speed=2.0),
    _rung("speed-4", "speed × 4", MOTION, speed=4.0),
    _rung("stop", "abrupt stop", MOTION, event="stop"),
    _rung("dropped-frame", "a dropped frame", MOTION, event="dropped"),
    _rung("teleport", "a teleport by 1 m", MOTION, event="teleport"),
    _rung("arms-pressed", "arms pressed into the torso", MOTION, event="pressed"),
    _rung("frozen", "frozen for 1,000 frames", MOTION, freeze=True, seconds=34.0),
    _rung("long", "10,000 frames, never the same", MOTION, starts=1, event="medley", seconds=10_000 / 30),
    _rung("far", "turned by 90°, 1 km away", MOTION, turn=90.0, translate=(1000.0, 0.0, 0.0), unmoved=True),
    _rung("heavy", "heavy body", BODY, body="heavy"),
    _rung("heavier", "heavy body, exaggerated threefold", BODY, body="heavy", beyond=3.0),
    _rung("slimmer", "slim body, exaggerated threefold", BODY, body="slim", beyond=3.0),
    _rung("taller", "tall body, exaggerated threefold", BODY, body="tall", beyond=3.0),
    _rung("push-1mm", "start pushed by 1 mm", START, push=1e-3),
    _rung("push-1cm", "start pushed by 1 cm", START, push=1e-2),
    _rung("push-5cm", "start pushed by 5 cm", START, push=5e-2),
    _rung("fps-15", "15 frames a second", TIME, fps=15.0),
    _rung("fps-30", "30 frames a second", TIME),
    _rung("fps-60", "60 frames a second", TIME, fps=60.0),
    _rung("fps-120", "120 frames a second", TIME, fps=120.0),
    _rung("step-2", "time step × 2", TIME, step=2, fps=15.0),
    _rung("step-4", "time step × 4", TIME, step=4, fps=7.5),
    Rung(name="float32", title="float32", group=NUMBERS, course=PLAIN, precision="float32"),
    Rung(name="bfloat16", title="bfloat16", group=NUMBERS, course=PLAIN, precision="bfloat16"),
    Rung(name="float64", title="float64", group=NUMBERS, course=PLAIN, precision="float64"),
)
SHORT = ("no-stress", "stretch-100", "speed-4", "teleport", "arms-pressed", "heavy", "push-5cm", "bfloat16")
FIRST_LOOK = ("no-stress", "teleport", "push-5cm")  # where sequences are cut short: there time is short, too


def chosen(names: tuple[str, ...]) -> tuple[Rung, ...]:
    """The rungs of these names, in the ladder's order."""
    return tuple(rung for rung in RUNGS if rung.name in names)
