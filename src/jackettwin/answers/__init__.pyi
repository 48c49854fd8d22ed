from .answer import answer as answer
from .result import Answers as Answers, Span as Span
