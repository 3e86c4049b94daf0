"""The authors' checkpoints in our networks: our forward against theirs, written anew in `authors_networks`."""

from dataclasses import dataclass, replace
from pathlib import Path

import authors_networks as theirs
import numpy as np
import pytest
import torch
from authors_example import Y_UP, Z_UP, Written, write_release

from garmentbench.errors import UserError
from garmentbench.method import BodyFrame, History
from garmentbench.methods.motion_guided.authors.checkpoint import (
    DYNAMIC,
    SDF,
    STATIC,
    code_config,
    read_checkpoint,
    sizes_of,
)
from garmentbench.methods.motion_guided.authors.files import read_mesh
from garmentbench.methods.motion_guided.authors.model import read_canonical, read_model
from garmentbench.methods.motion_guided.authors.networks import load_dynamic, load_sdf, load_static
from garmentbench.methods.motion_guided.authors.release import open_release
from garmentbench.methods.motion_guided.config import Config, Model, Stage2
from garmentbench.methods.motion_guided.descriptor import uv_encoding
from garmentbench.methods.motion_guided.dynamics import DynamicEncoder
from garmentbench.methods.motion_guided.frames import Link, Pose
from garmentbench.methods.motion_guided.generative import GenerativeModel
from garmentbench.methods.motion_guided.inputs import Inputs, dynamic_inputs, past_of
from garmentbench.methods.motion_guided.method import MotionGuided
from garmentbench.methods.motion_guided.networks import Decoder, DisplacementMLP, Encoder, GeometryFeatures
from garmentbench.sequence import Body, Garment, Template

AXES = {"z_up": Z_UP, "y_up": Y_UP}
# Equality is tested in float64. In float32 two ways to compute the same differ by rounding, differently on every
# processor: a chain of convolutions here adds up to 1,500 numbers of order 1 one after another, each rounded by at most
# 2^-24 of it.
EXACT, ROUNDED = 1e-10, 1500 * 2**-24
PRECISIONS = pytest.mark.parametrize(("dtype", "tolerance"), [(torch.float32, ROUNDED), (torch.float64, EXACT)])


@dataclass
class Networks:
    """Their modules with random weights, and how they are saved."""

    relative: theirs.Relative
    encoder: theirs.Encoder
    decoder: theirs.Decoder
    change: theirs.Change
    dynamic: theirs.Encoder
    radius: torch.Tensor

    @classmethod
    def random(cls, width: int = 4, size: int = 8, latent: int = 6, mlp: int = 5, seeds: int = 12) -> "Networks":
        torch.manual_seed(3)
        relative, change = theirs.Relative(seeds, width), theirs.Change(seeds, width)
        encoder, dynamic = (theirs.Encoder(k * width, size, width, latent) for k in (1, 2))
        return cls(
            relative,
            encoder,
            theirs.Decoder(size, width, latent, mlp),
            change,
            dynamic,
            torch.tensor([0.04, 0.05, 0.07]),
        )

    def double(self) -> "Networks":
        return Networks(*(x.double() for x in vars(self).values()))

    @property
    def static(self) -> dict:
        states = (self.relative, self.encoder, self.decoder)
        named = zip(STATIC, (m.state_dict() for m in states), strict=False)
        return {"itter": 50_000, **dict(named), "skinRadius": self.radius.clone().requires_grad_()}

    @property
    def dynamics(self) -> dict:
        return {
            "itter": 50_000,
            **dict(zip(DYNAMIC, (self.change.state_dict(), self.dynamic.state_dict()), strict=True)),
        }


class Frame:
    """Their forward on what was written, in their axes."""

    def __init__(self, nets: Networks, w: Written, dtype: torch.dtype) -> None:
        def tensor(x) -> torch.Tensor:
            return torch.from_numpy(np.asarray(x)).to(dtype)

        self.nets, self.w, self.tensor = nets, w, tensor
        table = torch.from_numpy(w.chart_table)
        weights = torch.cat([1 - table[:, 5:].sum(1, keepdim=True), table[:, 5:]], dim=1).to(dtype)
        size = sizes_of(nets.static).map_size
        self.map = (size, table[:, :2].long(), table[:, 2:5].long(), weights)
        self.seeds0 = tensor(np.einsum("nk,nkx->nx", w.weights, w.body_rest[w.corners]))
        self.radius = nets.radius.to(dtype)[torch.from_numpy(w.labels)]

    def features(self, garment, seeds) -> torch.Tensor:
        return self.nets.relative(theirs.map_of(theirs.relative(garment, seeds), *self.map)[None])

    def displaced(self, code) -> torch.Tensor:
        uv = theirs.encoded_uv(self.tensor(self.w.uv.astype(np.float32)))
        d = self.nets.decoder(code, torch.from_numpy(self.w.pixels), self.tensor(self.w.pixel_weights), uv)[0]
        return self.tensor(self.w.rest) + torch.einsum("vxk,vk->vx", self.tensor(self.w.frames), d)

    def posed(self, code, t) -> torch.Tensor:
        seeds = self.tensor(self.w.seeds[t])
        return theirs.posed(
            self.displaced(code), self.seeds0, self.radius, self.tensor(self.w.rotations[t]), seeds - self.seeds0
        )

    def code(self, past, velocity, acceleration, t) -> torch.Tensor:
        """Z_t after the garment `past` at t - 1."""
        before, now, normals = (self.tensor(x) for x in (self.w.seeds[t - 1], self.w.seeds[t], self.w.normals[t]))
        pushed = theirs.map_of(theirs.force(past, now, normals, before), *self.map)[None]
        moved = theirs.map_of(torch.cat([velocity, acceleration], dim=-1), *self.map)[None]
        change = self.nets.change(pushed, moved)
        return self.nets.dynamic(torch.cat([self.features(past, before), change], dim=1))


@pytest.fixture(scope="module", params=AXES)
def written(request, tmp_path_factory) -> Written:
    return write_release(tmp_path_factory.mktemp(request.param), AXES[request.param])


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """Both checkpoints, as the authors save them."""
    folder, nets = tmp_path_factory.mktemp("checkpoints"), Networks.random()
    torch.save(nets.static, folder / "static.ckp")
    torch.save(nets.dynamics, folder / "dynamic.ckp")
    return folder / "static.ckp", folder / "dynamic.ckp"


def ours(written: Written, nets: Networks, dtype: torch.dtype) -> tuple[GenerativeModel, DynamicEncoder]:
    static, turn = nets.static, torch.from_numpy(written.place.turn)
    sizes = sizes_of(static)
    release = open_release(written.folder)
    body, faces = read_mesh(release.body("body_geo.obj"))
    canonical = read_canonical(release, written.place, body, faces, sizes.map_size)
    model = GenerativeModel(canonical, sizes).to(dtype)
    model.uv = uv_encoding(torch.from_numpy(canonical.uv).to(dtype))
    dynamics = DynamicEncoder(sizes, sizes.seeds, Stage2()).to(dtype)
    load_static(model, static, written.folder, torch.arange(3), turn)
    load_dynamic(dynamics, nets.dynamics, written.folder, turn)
    return model, dynamics


def without_collision(method: MotionGuided) -> Config:
    return replace(method.config, collision=replace(method.config.collision, enabled=False))


def template(method: MotionGuided, bodies: np.ndarray) -> Template:
    c = method.canonical
    return Template(
        Garment("tshirt", c.rest, c.faces, c.uv, c.seams), Body("authors", bodies[0], np.zeros((0, 3), np.int32)), 30.0
    )


def pair(
    written: Written, dtype: torch.dtype, nets: Networks | None = None
) -> tuple[Frame, GenerativeModel, DynamicEncoder, torch.Tensor]:
    """Theirs and ours with the same weights, and the turn from their axes to ours."""
    nets = nets or Networks.random()
    nets = nets.double() if dtype is torch.float64 else nets
    return Frame(nets, written, dtype), *ours(written, nets, dtype), torch.from_numpy(written.place.turn).to(dtype)


def step_code(frame: Frame, t: int) -> torch.Tensor:
    """Their code at t after the written garments."""
    x = [frame.tensor(frame.w.garment[k]) for k in (t - 3, t - 2, t - 1)]
    velocity = x[2] - x[1]
    return frame.code(x[2], velocity, velocity - (x[1] - x[0]), t)


def step_inputs(frame: Frame, model: GenerativeModel, turn: torch.Tensor, t: int) -> Inputs:
    """Our inputs there, in our axes, relative to the seeds' mean at t - 1."""
    w = frame.w
    origin = frame.tensor(w.seeds[t - 1]).mean(0)

    def pose(t: int) -> Pose:
        seeds = (frame.tensor(w.seeds[t]) - origin) @ turn.T
        turns = torch.eye(3, dtype=seeds.dtype).expand(1, len(seeds), 3, 3)  # which the encoder does not see
        return Pose(seeds[None], turns, (frame.tensor(w.normals[t]) @ turn.T)[None], seeds[None])

    third, second, last = ((frame.tensor(w.garment[k]) - origin) @ turn.T for k in (t - 3, t - 2, t - 1))
    stay = Link(torch.eye(3, dtype=third.dtype)[None], torch.zeros(1, 1, 3, dtype=third.dtype))
    past = past_of(third[None], second[None], last[None], stay)
    return dynamic_inputs(model, past, pose(t - 1), pose(t), stay, code_config(model.options).stage2)


def difference(mine: torch.Tensor, their: torch.Tensor) -> float:
    assert mine.shape == their.shape
    return float((mine - their).abs().max())


@PRECISIONS
@torch.no_grad()
def test_static_branch_equals_theirs(written, dtype, tolerance):
    frame, model, _, turn = pair(written, dtype)
    garment, seeds, rotations = (frame.tensor(x[3]) for x in (written.garment, written.seeds, written.rotations))
    origin = seeds.mean(0)
    local = ((garment - origin) @ turn.T)[None], ((seeds - origin) @ turn.T)[None]
    features = frame.features(garment, seeds)
    assert difference(model.features(*local), features) < tolerance
    code = frame.nets.encoder(features)
    assert difference(model.encode(*local), code) < tolerance
    assert code.abs().max() > 0.1
    displaced = model.displaced(code)
    assert difference(displaced[0], frame.displaced(code) @ turn.T) < tolerance
    pose = Pose(local[1], (turn @ rotations @ turn.T)[None], local[1], local[1])
    posed = model.pose(displaced, pose)[0]
    assert difference(posed + origin @ turn.T, frame.posed(code, 3) @ turn.T) < tolerance


@PRECISIONS
@torch.no_grad()
def test_dynamic_branch_equals_theirs(written, dtype, tolerance):
    (frame, model, dynamics, turn), t = pair(written, dtype), 4
    inputs = step_inputs(frame, model, turn, t)
    assert (inputs.strength > 0).any()
    assert difference(dynamics(inputs), step_code(frame, t)) < tolerance
    features = frame.features(frame.tensor(written.garment[t - 1]), frame.tensor(written.seeds[t - 1]))
    still = frame.nets.dynamic(torch.cat([features, torch.zeros_like(features)], dim=1))
    assert difference(dynamics.still(inputs), still) < tolerance


@torch.no_grad()
def test_roll_out_of_a_model_made_from_files_equals_theirs(written, files, tmp_path):
    method, told = read_model(open_release(written.folder), *files)
    assert any("normals within 0.0 and rotations within 0.0 degrees" in line for line in told)
    method.config = without_collision(method)
    method.save(tmp_path)
    method = MotionGuided.load(tmp_path)
    frame = Frame(Networks.random().double(), written, torch.float64)  # in float32 the plain form is itself off by 1e-3
    garments, bodies = (np.stack([written.place(x) for x in array]) for array in (written.garment, written.body))
    state = method.begin(template(method, bodies), History(garments[:3], bodies[:3]))
    x = [frame.tensor(written.garment[t]) for t in range(3)]
    for t in (3, 4, 5):
        garment, state = method.step(state, BodyFrame(bodies[t]))
        velocity = x[-1] - x[-2]
        x.append(frame.posed(frame.code(x[-1], velocity, velocity - (x[-2] - x[-3]), t), t))
        closed = method.seams(x[-1]).numpy()  # the mean of copies, as they save it
        np.testing.assert_allclose(garment, written.place(closed), rtol=0, atol=ROUNDED)  # [m]


@torch.no_grad()
def test_sdf_equals_theirs_in_our_axes(tmp_path):
    torch.manual_seed(0)
    network, centre = theirs.Implicit(), torch.tensor([0.1, 0.9, -0.05])
    torch.save({"network": network.state_dict(), "data_center": centre}, tmp_path / "sdf.ckp")
    turn = torch.from_numpy(Y_UP.turn).float()
    mine = load_sdf(read_checkpoint(tmp_path / "sdf.ckp", SDF), tmp_path, turn).double()
    points = torch.rand(50, 3).double()
    assert difference(mine(points @ turn.T.double()), network.double()(points - centre.double())) < EXACT


class Blocks(torch.nn.Module):
    """The generative model's blocks alone."""

    def __init__(self, m: Model) -> None:
        super().__init__()
        self.features_block = GeometryFeatures(m.seeds, m.width)
        self.encoder = Encoder(m.width, m.map_size, m.width, m.latent)
        self.decoder = Decoder(m.map_size, m.width, m.latent)
        self.displacement_block = DisplacementMLP(m.width // 2, 32, m.mlp_width)
        self.log_radii = torch.nn.Parameter(torch.zeros(5, device="cpu"))
        self.rest = torch.zeros(1, 3)


def test_names_and_shapes_at_the_papers_size():
    """Without the values, which are 116 million numbers."""
    with torch.device("meta"):
        modules = [theirs.Relative(581), theirs.Encoder(128), theirs.Decoder(), theirs.Change(581), theirs.Encoder(256)]
        counted = [sum(p.numel() for p in m.parameters()) / 1e6 for m in modules]
        assert counted == pytest.approx([9.65, 25.48, 45.08, 9.96, 25.63], abs=0.006)
        states = dict(zip((*STATIC[:3], *DYNAMIC), (m.state_dict() for m in modules), strict=True))
        sizes = sizes_of(states)
        assert sizes == replace(Model(), seed_rotation="normal")
        blocks, dynamics = Blocks(sizes), DynamicEncoder(sizes, 581, Stage2())
    radii = torch.linspace(0.02, 0.06, 5)
    load_static(blocks, states | {"skinRadius": radii}, Path("paper.ckp"), torch.arange(5), torch.eye(3))
    assert torch.allclose(blocks.log_radii.exp(), radii)
    load_dynamic(dynamics, states, Path("paper.ckp"), torch.eye(3))


def spoilt(nets: Networks) -> dict:
    static = nets.static
    relative = static["Relative_encoder"]
    del relative["encoder_1.2.conv.0.weight"]
    relative["encoder_1.9.conv.0.weight"] = torch.zeros(1)
    static["Pre_decoder"]["MLP_pred.LinearGeo.1.bias"] = torch.zeros(4)
    static["skinRadius"] = torch.zeros(2)
    return static


def test_all_that_is_wrong_is_listed_in_one_line(tmp_path):
    release = open_release(write_release(tmp_path / "data").folder)
    nets = Networks.random()
    torch.save(spoilt(nets), tmp_path / "static.ckp")
    torch.save(nets.dynamics, tmp_path / "dynamic.ckp")
    with pytest.raises(UserError) as told:
        read_model(release, tmp_path / "static.ckp", tmp_path / "dynamic.ckp")
    message = str(told.value)
    assert "\n" not in message
    for found in (
        "static.ckp: Relative_encoder: missing encoder_1.2.conv.0.weight",
        "Relative_encoder: unknown encoder_1.9.conv.0.weight",
        "Pre_decoder: MLP_pred.LinearGeo.1.bias has shape (4,), wanted (3,)",
        "skinRadius of shape (2,), wanted a radius above 0 for each of the labels 0 to 2",
    ):
        assert found in message


def test_checkpoints_that_are_swapped_or_of_other_data_are_refused(tmp_path, files):
    static, dynamic = files
    release = open_release(write_release(tmp_path / "data", seed_count=13).folder)
    with pytest.raises(UserError, match="lacks Relative_encoder, .*holds itter, Dynamic_ForceEncoder"):
        read_model(release, dynamic, static)
    with pytest.raises(UserError, match="made for 12 seeds, .* has 13"):
        read_model(release, static, dynamic)
    with pytest.raises(UserError, match="in cm; the authors' networks are in metres"):
        read_model(open_release(write_release(tmp_path / "cm", scale=100.0).folder), static, dynamic)


class Trap:
    """Were it unpickled, it would write a file."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def __reduce__(self) -> tuple:
        return Path.touch, (self.path,)


def test_a_checkpoint_is_never_run(tmp_path):
    torch.save({"itter": 1, "skinRadius": Trap(tmp_path / "was_run")}, tmp_path / "evil.ckp")
    with pytest.raises(UserError, match="no checkpoint that can be read as data only"):
        read_checkpoint(tmp_path / "evil.ckp", STATIC)
    assert not (tmp_path / "was_run").exists()


@pytest.mark.parametrize("old_format", [False, True])
def test_damaged_checkpoints_end_in_one_line(tmp_path, files, old_format):
    path, random = tmp_path / "cut.ckp", np.random.default_rng(0)
    torch.save(torch.load(files[0], weights_only=True), path, _use_new_zipfile_serialization=not old_format)
    whole = path.read_bytes()
    for length in [0, 1, 10, 100, *random.integers(0, len(whole), 60)]:
        path.write_bytes(whole[:length])
        with pytest.raises(UserError) as told:
            read_checkpoint(path, STATIC)
        assert "\n" not in str(told.value)
    for place in random.integers(0, len(whole), 150):
        path.write_bytes(whole[:place] + bytes([whole[place] ^ int(random.integers(1, 256))]) + whole[place + 1 :])
        try:
            read_checkpoint(path, STATIC)
        except UserError as e:
            assert "\n" not in str(e)


@torch.no_grad()
def test_all_581_seeds_on_the_papers_garment_equal_theirs(tmp_path):
    """The paper's vertices and seeds, hence its 1,743 channels, on smaller maps and widths."""
    written = write_release(tmp_path, Y_UP, frames=4, size=32, seed_count=581, meshes=("paper", "full"))
    nets = Networks.random(width=16, size=32, latent=64, mlp=64, seeds=581)
    (frame, model, dynamics, turn), t = pair(written, torch.float64, nets), 3
    code = step_code(frame, t)
    inputs = step_inputs(frame, model, turn, t)
    assert difference(dynamics(inputs), code) < EXACT
    assert difference(model.displaced(code)[0], frame.displaced(code) @ turn.T) < EXACT
