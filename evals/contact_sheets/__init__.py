"""Pictures of every garment in every motion that is tested on, so that a hole, a crack or skin is seen."""
