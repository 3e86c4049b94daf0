"""What tells one walk from another."""

from dataclasses import dataclass, replace

_LEG = 0.90215  # the base body's leg [m]


@dataclass(frozen=True)
class Gait:
    """A walk. Angles in degrees, lengths in metres; a cycle is two steps, its phase 0 the left heel's strike.

    Attributes:
        arm_space: Angle of the upper arms off the hanging line, to the side.
        period: Length of a cycle [s].
        stride: Distance covered in a cycle by the base body; the speed is stride / period.
        step_width: Distance between the lines that the two ankles walk on.
        arm_swing: Amplitude of the upper arm's swing, forward and back.
        elbow: Mean bend of the elbow.
        hip_sway: Amplitude of the pelvis' list towards the swinging leg.
        side_sway: Amplitude of the pelvis' path to the side.
        pelvis_turn: Amplitude of the pelvis' turn about the vertical; the chest turns against it.
        lean: Forward lean of the trunk.
        knee_load: Bend of the knee as the weight comes on; the more, the less the pelvis rises over the standing leg.
        heel_strike: Pitch of the foot, toes up, when the heel strikes.
        push_off: Pitch of the foot, heel up, when the toes leave the ground.
        variation: How much one stride differs from the next: 1 as in people, 0 for an exact loop (see `variation.py`).
    """

    arm_space: float
    period: float = 1.09
    stride: float = 1.35
    step_width: float = 0.09
    arm_swing: float = 18.0
    elbow: float = 22.0
    hip_sway: float = 3.5
    side_sway: float = 0.02
    pelvis_turn: float = 5.0
    lean: float = 3.0
    knee_load: float = 16.0
    heel_strike: float = 18.0
    push_off: float = 55.0
    variation: float = 1.0

    @property
    def stance(self) -> float:
        """Part of the cycle for which a foot is on the ground, less in a swifter walk.

        0.62 at 1.2 m/s (Perry and Burnfield 2010, "Gait Analysis", chapter 1), falling by 0.035 a metre a second
        (Kirtley, Whittle and Jefferson 1985, "Influence of walking speed on gait parameters").
        """
        return 0.62 - 0.035 * (self.stride / self.period - 1.2)

    def of_legs(self, length: float) -> "Gait":
        """The gait of a body whose legs have this length [m]: its strides are as long in proportion."""
        return replace(self, stride=self.stride * length / _LEG)


WALK = Gait(arm_space=22.0)

# The numbers of "armspace" are settings of the paper's source of motions (Mixamo), not degrees. Ours in degrees keep
# the fore-arms off the torso (5 cm at 12 degrees). A catwalk's arms are held a little away: between upper arm and
# trunk there is little room for cloth at 14 degrees.
GAITS = {
    "armspace-60": replace(WALK, arm_space=14.0),
    "armspace-75": WALK,
    "armspace-90": replace(WALK, arm_space=30.0),
    "catwalk": replace(
        WALK,
        arm_space=24.0,
        period=1.2,
        stride=1.4,
        step_width=0.05,
        arm_swing=16.0,
        elbow=14.0,
        hip_sway=8.0,
        side_sway=0.03,
        pelvis_turn=8.0,
        lean=-1.0,
    ),
    "strut": replace(
        WALK,
        arm_space=24.0,
        period=1.0,
        stride=1.35,
        arm_swing=30.0,
        elbow=38.0,
        hip_sway=5.0,
        pelvis_turn=8.0,
        lean=-4.0,
        knee_load=12.0,
    ),
    "fast": replace(
        WALK,
        arm_space=22.0,
        period=0.8,
        stride=1.42,
        arm_swing=28.0,
        elbow=65.0,
        pelvis_turn=7.0,
        lean=7.0,
        heel_strike=22.0,
        push_off=62.0,
    ),
}
