"""How many vertices each garment has at each size: wanted, after the split at the seams."""

VERTICES = {  # at paper size the paper's own for bodysuit, pleated skirt and T-shirt; it gives none for the others
    "bodysuit": {"smoke": 500, "laptop": 1_500, "desktop": 5_000, "paper": 21_904},
    "dress": {"smoke": 400, "laptop": 1_500, "desktop": 5_000, "paper": 18_000},
    "laid_sheet": {"smoke": 400, "laptop": 1_500, "desktop": 5_000, "paper": 5_000},
    "over_skirt": {"smoke": 400, "laptop": 1_500, "desktop": 5_000, "paper": 18_000},
    "pleated_skirt": {"smoke": 400, "laptop": 1_500, "desktop": 5_000, "paper": 17_678},
    "sheet": {"smoke": 400, "laptop": 1_500, "desktop": 5_000, "paper": 5_000},
    "tshirt": {"smoke": 400, "laptop": 1_500, "desktop": 5_000, "paper": 18_902},
}
