"""What a run means: is the model right, what is the ground, whose is the damping, what to do next."""

from typing import TYPE_CHECKING

from jackettwin.doors import door

if TYPE_CHECKING:
    from jackettwin.answers.answer import answer as answer
    from jackettwin.answers.result import Answers as Answers, Span as Span

door(__name__)
