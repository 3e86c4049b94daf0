"""A learned method in 60 lines: a GRU from the body's motion to the garment's displacement from skinning."""

from dataclasses import dataclass

import torch

import garmentbench as gb


@dataclass(frozen=True)
class Config:
    codes: int = 16  # principal components of the displacement
    steps: int = 300  # of Adam, each over all training sequences


class PoseGRU(torch.nn.Module):
    name, Config = "pose_gru", Config

    def __init__(self, seeds, mean, basis):
        super().__init__()
        self.seeds, self.mean, self.basis = map(torch.nn.Buffer, (seeds, mean, basis))
        self.gru, self.head = torch.nn.GRU(6 * len(seeds), 64), torch.nn.Linear(64, len(basis))

    @classmethod
    def fit(cls, train, config, run):
        torch.manual_seed(run.seed)
        seeds = gb.Skin.of(train[0].template, 60).vertices  # points on the body, from which the motion is read
        pairs = [(gb.Skin.of(s.template, seeds), s) for s in train]
        moved = torch.cat([torch.tensor(skin.displacement(s.body, s.garment)[1:]).flatten(1) for skin, s in pairs])
        mean, basis = moved.mean(0), torch.pca_lowrank(moved, config.codes)[2].T
        method, codes = cls(torch.tensor(seeds), mean, basis), (moved - mean) @ basis.T
        motions = [torch.tensor(skin.motion(s.body)) for skin, s in pairs]
        adam = torch.optim.Adam(method.parameters(), lr=5e-3)
        for step in range(config.steps):
            errors = torch.cat([method.head(method.gru(motion)[0]) for motion in motions]) - codes
            adam.zero_grad()
            errors.square().mean().backward()
            adam.step()
            run.log(step, error=errors.abs().mean().item())
        return method.requires_grad_(False)

    def save(self, folder):
        torch.save(self.state_dict(), folder / "weights.pt")

    @classmethod
    def load(cls, folder):
        weights = torch.load(folder / "weights.pt", weights_only=True)
        method = cls(weights["seeds"], weights["mean"], weights["basis"]).requires_grad_(False)
        method.load_state_dict(weights)
        return method

    def begin(self, template, history):
        skin = gb.Skin.of(template, self.seeds.numpy())
        return skin, history.bodies[-1], self.gru(torch.tensor(skin.motion(history.bodies)))[1]

    def step(self, state, body):
        skin, last, hidden = state
        out, hidden = self.gru(torch.tensor(skin.motion([last, body.vertices])), hidden)
        moved = (self.mean + self.head(out[0]) @ self.basis).numpy().reshape(-1, 3)
        return skin.pose(body.vertices, moved), (skin, body.vertices, hidden)
