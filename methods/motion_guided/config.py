"""All that can be chosen about the model, the three sizes, and the ablations.

Defaults are the paper's. Where paper and code disagree, and where we depart from both so that a small model trains
in minutes, the field says so. Options are grouped by the stage that they decide, so that what an ablation does not
change is shared.
"""

from collections.abc import Callable
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any

from garmentbench.errors import unknown_name
from garmentbench.methods.training import Training
from garmentbench.sequence import Needs


@dataclass(frozen=True)
class Model:
    """The generative model of section 4, and the sizes that all blocks share."""

    map_size: int = 128
    """Pixels a side of the encoders' UV maps, a power of two; D's map has twice as many. A map is drawn at its pixels'
    centres, so at 16 the encoders see a fifth of the laptop T-shirt's vertices."""
    width: int = 128
    """Channels of a feature map; all other widths are in proportion to it."""
    mlp_width: int = 64
    """Channels of R's hidden layers."""
    latent: int = 64
    """Length of a latent code."""
    seeds: int = 581
    """Seed points on the body."""
    dynamic_weights: bool = True
    """Blend weights from the displaced canonical vertices; False: from the rest garment, fixed over time (figure 7).
    Their radii are learnt as logarithms, so at the paper's rates none can change by more than 2.1 times; the code
    learns them as they are."""
    seed_rotation: str = "frame"
    """"frame": the seed's full tangent frame turns it (the paper's "known rotation"); "normal": the smallest rotation
    that carries the canonical normal to the present one (the code), which loses twist."""
    axes: str = "world"
    """Axes of the inputs: the "world"'s (paper and code); ours: those turned by the body's "heading" about the
    vertical, so that where it heads changes nothing."""
    upright_objects: bool = True
    """Eq. 1 takes an object for its upright root, as all methods here do: R_t is its heading, T_t that of its middle.
    A stick that rolls would carry round the cloth that hangs from it, and d have to undo that (42 cm on average). The
    paper's stick is not said to roll. Descriptor and force keep to the points on its surface."""
    map_border: float = 1.5
    """Pixels of background that the encoders' maps have on every side at least, so that the convolutions see where the
    chart ends, the seeds with it. Paper and code do not say how their charts lie in the map."""
    output_scale: float | None = 1.0
    """Displacement [m] that an output of 1 of R means. None (ours): the root mean square of the training garments'
    displacements, so that outputs are of order 1."""
    centred_descriptor: bool = False
    """Ours: take the training mean off the descriptor map before its first convolution."""
    chart_channel: bool = False
    """Ours, beside a centred descriptor: one more channel that is constant in the chart. What is centred and goes
    through convolutions and norms without biases gives a deviation and four times as much the same code; beside a
    constant it does not."""
    linear_paths: bool = False
    """Ours: beside E^Sta a linear map of the descriptor, and in D the principal components of the training
    displacements, both in closed form; the networks learn what these leave. A network alone answers a garment in a new
    pose with one that it knows (trials, cm on another arm space: 0.65 alone, 0.42 with both)."""


@dataclass(frozen=True)
class Posing:
    """Random poses that an encoder is trained on beside the recording's (ours, see `posing`). 0: none."""

    limb_angle: float = 0.0
    """Standard deviation of a limb's turn about each axis [rad]."""
    whole_angle: float = 0.0
    """... and of the whole body's."""
    code_spread: float = 0.0
    """Stage 1: standard deviation of the codes of the random garments in them. Stage 2: of what is added to the code of
    the garment before, which the next is not to keep; needs `linear_paths`."""


@dataclass(frozen=True)
class Sdf:
    """SDF_0, the signed distance network of the canonical body (section 4.2)."""

    layers: int = 8
    width: int = 512
    batch: int = 4_096
    """Points on the surface in a step; as many are near it, and an eighth anywhere."""
    training: Training = Training(steps=20_000, learning_rate=5e-4, halve_every=5_000)
    """Its `batch` does not count."""


@dataclass(frozen=True)
class Stage1:
    """Training of the generative model (section 4.2)."""

    training: Training = Training()
    edge_weight: float = 1.0
    """Of L_rand (code: 0.1)."""
    sdf_weight: float = 100.0
    """lambda_1 (code: 1). In a small model's training its term is at most 0.5 % of the loss."""
    sdf_from_step: int = 0
    """L_SDF0 counts from this step on (code: 500)."""
    sdf_on_random: bool = True
    """L_SDF0 on the random sample too (code: False)."""
    sdf_margin: float = 6e-4
    """Its eps [m]; the paper does not give it, this is the code's."""
    latent_weight: float = 1e-3
    """lambda_2."""
    posing: Posing = Posing()
    """Ours: how random garments are posed, on which E^Sta's linear path is solved, and as many of which as of the
    recording's join each batch. Used with `linear_paths` only."""
    code_weight: float = 0.01
    """Weight of the L1 error of their codes."""
    random_every: int = 1
    """Ours: decode the random sample, and ask SDF_0, only once in this many steps, at as many times the weight."""


@dataclass(frozen=True)
class Stage2:
    """Training of the dynamic-aware encoder (section 5)."""

    training: Training = Training()
    pose_path: bool = False
    """Ours: beside E^Dyn a linear map of where the seeds are and how they have moved since the last frame, in closed
    form; the network learns what it leaves. It does not see the garment, so it can't feed errors back (a linear path
    from the garment fitted better and ran away in 1,150 frames). Paper and code know b_t through C_t alone. Only where
    there is a human body: its pose says much of what is worn on it, an object's little of what lies on it."""
    virtual_sample: bool = True
    """The constraint of E_t = 0 (figure 10)."""
    pair_weight: float = 1.0
    """Weight of each of the two terms of L_geo and L_Z (code: 0.5)."""
    code_weight: float = 1.0
    """Of L_Z. Ours: 0.003 beside linear paths, where most components of a code are faint."""
    latent_weight: float = 1e-3
    """lambda_2."""
    units: str = "metres"
    """Of velocity, acceleration and interaction force: "metres" a frame (paper and code); ours: the "spread" of each
    over the training frames. In metres velocities are a fiftieth of the features beside them, and what a small model
    was trained to does not change when they are set to zero."""
    velocity: bool = True
    """E^Dyn is given velocity and acceleration (False: an ablation)."""
    force: bool = True
    """... and the interaction force (False: an ablation)."""
    garment: bool = True
    """... and the garment of the frame before. False, an ablation: the pose alone, as the descriptor of the rest
    garment skinned to it, with neither velocity nor force; it has no virtual sample then."""
    force_distance: str = "present"
    """The interaction force fades with the distance to the seed's "present" (paper) or "previous" (code) place."""
    posing: Posing = Posing()
    """Ours: what is done to the poses of all four frames of a sample, and to the garment before."""
    cache_inputs: bool = False
    """Ours: make S(M_{t-1}) and the force maps of all frames once, which needs memory. Not with `posing`."""


@dataclass(frozen=True)
class Collision:
    """The collision stage at run time (section 5.1).

    Its regularisers are means and the depths a sum. Read as norms throughout, the paper's regularisers are 3 V times as
    strong. Where it ends early is ours, so an imported model's stage is not quite its authors'.
    """

    enabled: bool = True
    solver: str = "adam"
    """"adam": the paper's residual map, optimised. "push" (ours): every vertex that is behind its plane is put before
    it, and how far is smoothed over the cloth, in turn. On a laptop T-shirt disturbed smoothly by 7 mm (root mean
    square) the map left 0.02 % of the vertices inside, moved them by 3.1 mm on average and changed edges by up to 13 %
    (95th percentile); pushing left 0.002 %, moved 0.95 mm and changed edges by 3 %, in no more time. It uses
    `trigger`, `threshold` and the next three."""
    clearance: float = 5e-4
    """How far before its plane "push" puts a vertex [m], since another plane may then be its nearest."""
    rounds: int = 10
    """Of smoothing and putting back, of "push"."""
    passes: int = 2
    """How often at most "push" does all this, with the planes that are then the nearest."""
    map_size: int = 128
    """Pixels a side of the residual displacement map."""
    trigger: str = "sum"
    """The stage runs when the "sum" (paper) or the "mean" (code) of penetration depths [m] passes `threshold`."""
    threshold: float = 1e-4
    """Its eps [m]; the paper does not give it (code: 5e-6, of the mean)."""
    position_weight: float = 1.0
    """Weight of the L1 to the network's prediction, a mean (code: 10)."""
    laplacian_weight: float = 1.0
    """Weight of its Laplacian's L1, a mean (code: 1e4)."""
    collision_weight: float = 100.0
    """lambda_3, of the depths' sum (code: 1e4, of their mean)."""
    learning_rate: float = 1e-3
    """Of Adam."""
    betas: tuple[float, float] = (0.9, 0.999)
    """Of Adam (code: 0, 0.9)."""
    steps: int = 51
    """The largest number of steps a frame (code); it ends early when nothing penetrates any more."""
    carry: bool = True
    """The map and Adam's state go on to the next frame (code). Ours: False, since a stage that ends as soon as nothing
    penetrates would keep what one frame needed for ever (0.71 against 0.61 cm in a trial)."""


@dataclass(frozen=True)
class Config:
    """The motion-guided model. Defaults: the paper."""

    model: Model = Model()
    sdf: Sdf = Sdf()
    stage1: Stage1 = Stage1()
    stage2: Stage2 = Stage2()
    collision: Collision = Collision()


def _small(model: Model, sdf: Sdf, stage1_steps: int, stage2_steps: int) -> Config:
    """A size at which training takes minutes, with what the trials showed to help there."""
    quick = Training(schedule="one_cycle", batch=2)
    return Config(
        model=replace(model, axes="heading", output_scale=None, centred_descriptor=True),
        sdf=sdf,
        stage1=Stage1(
            replace(quick, steps=stage1_steps, learning_rate=4e-3), edge_weight=0.1, sdf_weight=1.0, random_every=4
        ),
        stage2=Stage2(replace(quick, steps=stage2_steps, learning_rate=1.5e-3), units="spread", cache_inputs=True),
        collision=Collision(map_size=32, carry=False),
    )


def _small_sdf(width: int, steps: int, batch: int) -> Sdf:
    return Sdf(4, width, batch, Training(steps=steps, learning_rate=5e-3, schedule="one_cycle"))


SIZES: dict[str, Config] = {
    "smoke": _small(
        Model(map_size=16, width=16, mlp_width=32, latent=32, seeds=40),
        _small_sdf(width=32, steps=300, batch=256),
        stage1_steps=150,
        stage2_steps=100,
    ),
    "laptop": _small(
        Model(map_size=16, width=32, mlp_width=64, latent=64, seeds=100),
        _small_sdf(width=64, steps=1_500, batch=512),
        stage1_steps=3_000,
        stage2_steps=2_500,
    ),
    "paper": Config(),
}
SIZES["desktop"] = SIZES["laptop"]  # finer cloth on the same body: the networks see it through maps of that size


def config_for(preset_name: str) -> Config:
    """The full model's configuration at a preset. Raises `UsageError` for an unknown one."""
    if preset_name not in SIZES:
        raise unknown_name("preset", preset_name, list(SIZES))
    return SIZES[preset_name]


def for_scene(config: Config, needs: Needs) -> Config:
    """The configuration without what a scene does not need: a pose path is a human body's."""
    s = config.stage2
    force, path = s.force and needs.interaction_force, s.pose_path and needs.body
    return replace(config, stage2=replace(s, force=force, pose_path=path))


def config_from(table: dict) -> Config:
    """The configuration whose `dataclasses.asdict` went through JSON."""
    return _from(Config, table)


def _from(kind: type, table: dict) -> Any:
    values = {
        f.name: _from(type(f.default), v) if is_dataclass(f.default) else tuple(v) if isinstance(v, list) else v
        for f in fields(kind)
        for v in [table[f.name]]
    }
    return kind(**values)


def _with_linear_paths(full: Config) -> Config:
    """With the linear paths, the random poses that they are solved on, and the gentler training that they need."""
    stage1, stage2 = full.stage1, full.stage2
    gentle1 = replace(stage1.training, batch=1, learning_rate=stage1.training.learning_rate / 4)
    gentle2 = replace(stage2.training, learning_rate=stage2.training.learning_rate / 3)
    return replace(
        full,
        model=replace(full.model, linear_paths=True, output_scale=0.03),
        stage1=replace(stage1, training=gentle1, posing=Posing(limb_angle=0.2, whole_angle=0.08, code_spread=3.0)),
        stage2=replace(
            stage2,
            training=gentle2,
            pose_path=True,
            code_weight=0.003,
            posing=Posing(limb_angle=0.3, whole_angle=0.15),
            cache_inputs=False,
        ),
    )


VARIANTS: dict[str, Callable[[Config], Config]] = {
    "full": lambda full: full,
    "fixed_weights": lambda full: replace(full, model=replace(full.model, dynamic_weights=False)),
    "no_virtual_sample": lambda full: replace(full, stage2=replace(full.stage2, virtual_sample=False)),
    "no_velocity": lambda full: replace(full, stage2=replace(full.stage2, velocity=False)),
    "no_force": lambda full: replace(full, stage2=replace(full.stage2, force=False)),
    "pose_only": lambda full: replace(
        full, stage2=replace(full.stage2, garment=False, velocity=False, force=False, virtual_sample=False)
    ),
    "no_collision": lambda full: replace(full, collision=replace(full.collision, enabled=False)),
    "push_out": lambda full: replace(full, collision=replace(full.collision, solver="push")),
    "linear_paths": _with_linear_paths,
}
"""The full model, its ablations, and what another collision stage and closed-form linear paths would add to it (ours,
not the paper's).

Each changes the full model's configuration.
"""
