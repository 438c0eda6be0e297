"""What `fitting` lets out, for `__init__.py` and for type checkers."""

from .case import Evaluations as Evaluations
from .cost import explain_fit as explain_fit
from .design import FitDesign as FitDesign
from .design import FitError as FitError
from .design import is_fit_design as is_fit_design
from .figures import fit_figures as fit_figures
from .fit_file import is_fit as is_fit
from .fit_file import open_fit as open_fit
from .results import FitResult as FitResult
from .run import fit as fit
from .run import log_posterior as log_posterior
from .run import read_design as read_design
