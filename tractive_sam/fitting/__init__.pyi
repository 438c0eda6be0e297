"""What `fitting` lets out, for `__init__.py` and for type checkers."""

from .case import Evaluations as Evaluations
from .cost import explain_design as explain_design
from .cost import explain_fit as explain_fit
from .cost import explain_spread as explain_spread
from .design import FitDesign as FitDesign
from .design import FitError as FitError
from .design import question_of as question_of
from .distributions import SpreadDesign as SpreadDesign
from .distributions import SpreadError as SpreadError
from .figures import fit_figures as fit_figures
from .fit_file import is_fit as is_fit
from .fit_file import open_fit as open_fit
from .optimum import DesignError as DesignError
from .optimum import OptimumDesign as OptimumDesign
from .optimum import OptimumResult as OptimumResult
from .optimum import open_design as open_design
from .percentiles import SpreadResult as SpreadResult
from .percentiles import open_spread as open_spread
from .percentiles import spread as spread
from .response import QuestionResult as QuestionResult
from .results import FitResult as FitResult
from .run import fit as fit
from .run import log_posterior as log_posterior
from .run import read_design as read_design
