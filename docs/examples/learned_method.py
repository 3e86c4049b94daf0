"""A learned method in 60 lines: a GRU from the body's motion to the garment's displacement from skinning."""

from dataclasses import dataclass

import numpy as np
import torch

import garmentbench as gb


@dataclass(frozen=True)
class Config:
    seeds: int = 60  # body vertices near the garment, from which the motion is read
    codes: int = 16  # principal components of the displacement
    steps: int = 300  # of Adam, each over all training sequences


def motion(skin, bodies):  # where the seeds are and were a frame before, at all bodies but the first
    return torch.tensor(np.array([gb.seed_features(skin.seeds, np.stack(b)) for b in zip(bodies, bodies[1:])])).float()


class PoseGRU(torch.nn.Module):
    name, Config = "pose_gru", Config

    def __init__(self, seeds, mean, basis):
        super().__init__()
        self.seeds, self.mean, self.basis = map(torch.nn.Buffer, (seeds, mean, basis))
        self.gru, self.head = torch.nn.GRU(6 * len(seeds), 64), torch.nn.Linear(64, len(basis))
        self.skin_of = gb.SkinOf(len(seeds), seeds.numpy())

    @classmethod
    def fit(cls, train, config, run):
        torch.manual_seed(run.seed)
        seeds = gb.Skin.of(train[0].template, config.seeds).seeds.vertices
        skins = [gb.Skin.of(s.template, len(seeds), seeds) for s in train]
        moved = [
            gb.lift(k.blend(s.body[t]), s.garment[t]) - k.rest for k, s in zip(skins, train) for t in range(1, len(s))
        ]
        moved = torch.tensor(np.array(moved)).flatten(1).float()
        codes, strength, basis = torch.linalg.svd(moved - moved.mean(0), full_matrices=False)
        basis, weight = (strength[:, None] * basis)[: config.codes], strength[: config.codes] ** 2
        method = cls(torch.tensor(seeds), moved.mean(0), basis / len(moved) ** 0.5)
        codes = (codes[:, : config.codes] * len(moved) ** 0.5).split([len(s) - 1 for s in train])
        inputs, adam = [motion(k, s.body) for k, s in zip(skins, train)], torch.optim.Adam(method.parameters(), 5e-3)
        for step in range(config.steps):
            loss = sum(((method(x)[0] - z) ** 2 @ weight).mean() for x, z in zip(inputs, codes)) / weight.sum()
            adam.zero_grad(), loss.backward(), adam.step(), run.log(step, loss=loss.item())
        return method.requires_grad_(False)

    def forward(self, motion, hidden=None):
        out, hidden = self.gru(motion, hidden)
        return self.head(out), hidden

    def save(self, folder):
        torch.save(self.state_dict(), folder / "weights.pt")

    @classmethod
    def load(cls, folder):
        weights = torch.load(folder / "weights.pt", weights_only=True)
        method = cls(weights["seeds"], weights["mean"], weights["basis"]).requires_grad_(False)
        method.load_state_dict(weights)
        return method

    def begin(self, template, history):
        skin = self.skin_of(template)
        return skin, history.bodies[-1], self(motion(skin, history.bodies))[1]

    def step(self, state, body):
        skin, last, hidden = state
        codes, hidden = self(motion(skin, [last, body.vertices]), hidden)
        moved = (self.mean + codes[0] @ self.basis).numpy().reshape(-1, 3)
        return gb.place(skin.blend(body.vertices), skin.rest + moved), (skin, body.vertices, hidden)
