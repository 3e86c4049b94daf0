"""Recorded motions (BVH, ASF/AMC, AMASS) on our bodies: reading, retargeting, feet on the floor."""
