"""Labels of modes as people write them: ``1st FA``, ``SS1``, ``fore_aft_2``, ``2. Torsion``."""

from __future__ import annotations

import re

from jackettwin.errors import InputError

KIND_WORDS: tuple[tuple[str, str], ...] = (
    ("fore_aft", r"fa|fore[\s_\-]*aft(?:[\s_\-]*bending)?"),
    ("side_side", r"ss|sts|s2s|side[\s_\-]*(?:to[\s_\-]*)?side(?:[\s_\-]*bending)?"),
    ("torsion", r"t|to|tor|tors|torsion(?:al)?|yaw|twist"),
    ("heave", r"heave|vertical|vert|axial"),
    ("local", r"local"),
)
"""Kind of mode and what it is called, without regard to case."""
_FORMS = (
    r"^(?:mode\s*)?(?P<number>\d{1,2})(?:st|nd|rd|th|\.)?[\s_\-.]*(?:KIND)(?:\s*mode)?$",
    r"^(?:KIND)[\s_\-.#]*(?P<number>\d{1,2})$",
    r"^(?P<number>)(?:KIND)$",
)
"""Number before the kind, behind it, or none."""


def read_mode_label(text: str) -> str:
    """Return a mode's label as the program writes it.

    A kind without a number is the first of its kind.

    Raises
    ------
    InputError
        If it names no kind of mode.

    Examples
    --------
    >>> [read_mode_label(text) for text in ("1st FA", "SS1", "fore_aft_2", "2nd side-side", "torsion")]
    ['fore_aft_1', 'side_side_1', 'fore_aft_2', 'side_side_2', 'torsion_1']
    """
    lower = " ".join(text.strip().lower().split())
    for kind, words in KIND_WORDS:
        for form in _FORMS:
            match = re.match(form.replace("KIND", words), lower)
            if match is not None:
                return f"{kind}_{int(match['number'] or 1)}"
    raise InputError(
        "is not the name of a mode",
        field="mode",
        value=text,
        allowed="a number, or e.g. fore_aft_1, 1st FA, SS2, torsion",
        remedy="name direction and number",
    )
