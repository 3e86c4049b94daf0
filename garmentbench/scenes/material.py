"""What the cloth is made of and how it is integrated. The wardrobe and scenes override both by name."""

from dataclasses import dataclass
from typing import Annotated

from msgspec import Meta

Number = Annotated[float, Meta(ge=0)]
Positive = Annotated[float, Meta(gt=0)]
Count = Annotated[int, Meta(ge=0)]


@dataclass(frozen=True)
class Material:
    """A fabric, about a light cotton knit. A modulus is per metre of width, so it does not depend on the mesh.

    Attributes:
        density: Mass per area [kg/m^2].
        stretch: Spring modulus [N/m]; on a mesh of equilateral triangles the sheet's Young modulus (times its
            thickness) is a third of it, its Poisson ratio a third.
        compression: Part of `stretch` that resists shortening [1]; below 1, cloth shrinks where it would fold.
        bending: Flexural rigidity [N m] of equilateral triangles bent to a cylinder; isometric bending (Bergou et al.
            2006, "A quadratic bending model for inextensible surfaces").
        stretch_damping: Damping time of stretch [s]: damping = this times stiffness. It is held back where it would
            shorten the time step (`time_step.stretch_damping`).
        bend_damping: Damping time of bending [s].
        drag: Drag coefficient across the cloth [1]: pressure = drag times density of air times speed^2 / 2; about 1.2
            for a plate (Hoerner 1965, "Fluid-dynamic drag").
        drag_along: The same along the cloth [1], of both faces together: friction of the air.
        friction: Coulomb's coefficient against the body [1].
        thickness: Distance that vertices keep from the body, and layers of cloth from each other [m]. Centres of faces
            and middles of edges keep half of it from the body.
    """

    density: Positive = 0.2
    stretch: Number = 300.0
    compression: Number = 1.0
    bending: Number = 3e-5
    stretch_damping: Number = 1e-4
    bend_damping: Number = 5e-3
    drag: Number = 1.2
    drag_along: Number = 0.02
    friction: Number = 0.4
    thickness: Number = 5e-3


@dataclass(frozen=True)
class Settings:
    """The solver. Nothing here should change a result by more than the spread of the reference's runs.

    The frequency caps are multiples of the mesh's own median frequency: they soften slivers (which would set the step
    for everybody) and nothing else. So a stiffer cloth is as much stiffer as it says, at the price of more substeps; an
    absolute cap would have silently stopped it from getting stiffer.

    Attributes:
        stretch_cap: No edge oscillates faster than this times the median edge [1].
        bend_cap: No bending stencil oscillates faster than this times the median stencil [1].
        mass_floor: No particle is lighter than this times the median particle [1].
        contact_frequency: Angular frequency of the compliant contact [rad/s].
        contact_damping: Its damping ratio [1].
        contact_depth: Penetration beyond which contact pushes no harder [m]. Between two skins that touch (armpits) a
            vertex has nowhere to go: pushed without bound it shoots to and fro, and is found deeper inside.
        self_contact: The cloth touches itself.
        queries: Nearest-point queries of the body, and of the cloth itself, a frame.
        step_margin: The time step over its stability bound [1].
        substep_factor: Times as many substeps as the bound asks for (2 in a doubling study).
        start_noise: Size of a random push of each vertex at the start [m].
        noise_seed: Its seed.
        gravity: Downwards acceleration [m/s^2].
        air_density: [kg/m^3].
        settling: Rate at which velocity decays towards that of the air [1/s]: brings cloth to rest where only its rest
            matters. No scene of the suite has any.
    """

    stretch_cap: Number = 1.7
    bend_cap: Number = 4.0
    mass_floor: Number = 0.3
    contact_frequency: Number = 1500.0
    contact_damping: Number = 0.5
    contact_depth: Number = 1e-3
    self_contact: bool = True
    queries: Annotated[int, Meta(ge=1)] = 8
    step_margin: Positive = 0.9
    substep_factor: Annotated[int, Meta(ge=1)] = 1
    start_noise: Number = 0.0
    noise_seed: Count = 0
    gravity: Number = 9.81
    air_density: Number = 1.2
    settling: Number = 0.0
