"""Motion Guided Deep Dynamic 3D Garments (Zhang, Ceylan, Mitra; SIGGRAPH Asia 2022), and its ablations.

Equations, sections and tables cited in this folder are that paper's, "the code" is what its authors released.
"""

from garmentbench.methods.motion_guided.method import MotionGuided

__all__ = ["MotionGuided"]
