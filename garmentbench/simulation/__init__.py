"""The reference simulation: an explicit, frequency-capped cloth solver in Warp, one code for CPU and CUDA."""
