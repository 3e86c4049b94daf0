"""One model a garment, as in the paper's Table 3: each trained on its own walk armspace-75, tested on armspace-90.

The over-skirt is predicted from the dress beneath it, which takes the body's place (section 6.5); the dress that it is
given is the simulated one.
"""

from garmentbench.evals.comparison import Comparison
from garmentbench.evals.trial import FULL, TUNED, Entry

GARMENTS = ("bodysuit", "pleated_skirt", "dress", "over_skirt")
WARDROBE = tuple(
    Comparison(
        name=f"wardrobe-{garment}",
        table="table3",
        title="Wardrobe",
        train=(f"{garment}-armspace-75",),
        tests=(f"{garment}-armspace-90",),
        entries=(Entry("skinning"), Entry("linear_subspace"), TUNED, FULL),
    )
    for garment in GARMENTS
)
