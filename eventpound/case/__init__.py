"""Case files: what they may say, what is wrong with them, and the scene they make."""

from eventpound.case.case import Case
from eventpound.case.loading import load_case, read_case
from eventpound.case.run_options import RunOptions
from eventpound.case.solver_options import SolverOptions
from eventpound.case.template import write_template

__all__ = ["Case", "RunOptions", "SolverOptions", "load_case", "read_case", "write_template"]
