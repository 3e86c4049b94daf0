"""The report of a preset: tables, plots, strips of frames and a page, from results.csv and the runs alone."""

from garmentbench.report.make import make_report
from garmentbench.report.material import write_material

__all__ = ["make_report", "write_material"]
