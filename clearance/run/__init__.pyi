from .checking import Resources, answer, check
from .options import CheckOptions
from .question import Question
from .result import Run

__all__ = ["CheckOptions", "Question", "Resources", "Run", "answer", "check"]
