from .answer import answer as answer
from .result import Answers as Answers, GroundAnswer as GroundAnswer, ModeAnswer as ModeAnswer, Span as Span
