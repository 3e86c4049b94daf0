"""The mesh doctor: what is wrong with a garment's mesh (`examine`), and repairs of what is safe (`mend`)."""
