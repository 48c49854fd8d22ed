"""The answers of a run on a terminal and as JSON."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from jackettwin.cli.console import output, say

if TYPE_CHECKING:
    from jackettwin.answers import Answers


def print_answers(answers: Answers) -> None:
    """Print the headline, then every question with its short answer."""
    from jackettwin.report import sentences

    said = sentences(answers)
    output.print()
    for line in said.headline:
        output.print(f"[bold]{line}[/bold]")
    for question in said.questions:
        say(f"\n{question.title}")
        for line in question.short:
            say(f"  {line}")


def answers_document(answers: Answers) -> dict[str, Any]:
    """Return the answers as plain JSON data, in numbers and in words."""
    from jackettwin.files import encode
    from jackettwin.report import sentences

    said = sentences(answers)
    return {
        "answers": encode(answers),
        "headline": list(said.headline),
        "questions": {q.title: [*q.short, *q.more] for q in said.questions},
    }
