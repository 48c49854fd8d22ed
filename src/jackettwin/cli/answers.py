"""The answers of a run on a terminal and as JSON."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from jackettwin.cli.console import output, say

if TYPE_CHECKING:
    from jackettwin.answers import Answers

_COLOURS = {"ok": "green", "look": "yellow", "act": "bold red"}


def print_answers(answers: Answers) -> None:
    """Print the light and the headline, then every question with its short answer."""
    from jackettwin.report import light, sentences

    said, at_a_glance = sentences(answers), light(answers)
    output.print()
    output.print(f"[{_COLOURS[at_a_glance.level]}]{at_a_glance.words}.[/]")
    for line in said.headline:
        output.print(f"[bold]{line}[/bold]")
    for question in said.questions:
        say(f"\n{question.title}")
        for line in question.short:
            say(f"  {line}")


def answers_document(answers: Answers) -> dict[str, Any]:
    """Return the answers as plain JSON data, as numbers and sentences."""
    from jackettwin.files import encode
    from jackettwin.report import light, sentences

    said, plain = sentences(answers), encode(answers)
    for mode, own in zip(plain["modes"], answers.modes, strict=True):
        mode["unexplained"] = own.unexplained
    return {
        "light": encode(light(answers)),
        "answers": plain,
        "headline": list(said.headline),
        "questions": {q.title: [*q.short, *q.more] for q in said.questions},
    }
