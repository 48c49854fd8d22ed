from .answer import answer as answer
from .compare import (
    ChangedInput as ChangedInput,
    ChangedNumber as ChangedNumber,
    changed_inputs as changed_inputs,
)
from .result import Answers as Answers, GroundAnswer as GroundAnswer, ModeAnswer as ModeAnswer, Span as Span
