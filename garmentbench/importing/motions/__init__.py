"""Recorded motions (BVH, AMASS) on our bodies: reading, retargeting, feet on the floor."""
