"""Supports from the command line (``kelvin-voigt:k=2.5e9,c=7.6e8``) and from YAML: springs, or piles."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Literal

import numpy as np
from pydantic import Field

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError, did_you_mean, located, look_up, require, require_between
from jackettwin.files import Placed, Schema, read_yaml, validate
from jackettwin.soil.caisson import Caisson
from jackettwin.soil.foundation import (
    Foundation,
    PileModel,
    build_foundation,
    read_foundation,
    shipped_foundations,
)
from jackettwin.soil.laws.families import Family, families
from jackettwin.soil.laws.files import ElasticLaw, LawSchema
from jackettwin.soil.laws.viscoelastic import Law, Prony, require_positive
from jackettwin.soil.mudline import MUDLINE, mudline_parameters, mudline_support, tied_at_mudline
from jackettwin.soil.support import Spring, Support, clamped, on_translations, own_support, pinned
from jackettwin.structure import Structure


class SpringSchema(Schema):
    """One entry of ``supports``."""

    nodes: Literal["reaction"] | list[str]
    stiffness: list[float] | list[list[float]] | None = None
    caisson: Placed[Caisson] | None = None
    law: LawSchema = ElasticLaw(type="elastic")

    def build(self, structure: Structure) -> list[Spring]:
        """Return one spring a node."""
        nodes = structure.reaction_nodes if self.nodes == "reaction" else self.nodes
        for node in nodes:
            remedy = did_you_mean(node, structure.nodes) or "name a node of the structure"
            require(node in structure.nodes, "no such node", field="nodes", value=node, remedy=remedy)
        require(
            (self.stiffness is None) != (self.caisson is None),
            "a support is a stiffness, or a caisson",
            field="stiffness, caisson",
            remedy="give exactly one of them",
        )
        if self.caisson is not None:
            matrix = self.caisson.stiffness()
        else:
            matrix = _matrix(self.stiffness or [])
        law = self.law.build()
        return [Spring(node, matrix, law) for node in nodes]


class SpringsSchema(Schema):
    """A support file."""

    supports: list[SpringSchema] = Field(min_length=1)


def _unknown_frequency() -> float:
    raise InputError("reference frequency is missing", field="f0", remedy="give f0=… [Hz]")


def read_support(
    text: str | Path | None,
    structure: Structure,
    *,
    first_frequency_hz: Callable[[], float] = _unknown_frequency,
    folder: Path | None = None,
) -> Support:
    """Return the support a user asked for; piles are lumped at their heads (:func:`read_supported`).

    Parameters
    ----------
    text : str or Path or None
        ``pinned``, ``clamped``, a short form, a shipped foundation, or a YAML file of springs or of a pile
        foundation; None is the structure's own.
    structure : Structure
    first_frequency_hz : callable
        Gives the first pinned frequency, the default reference frequency of ``springpot`` and ``maxwell-3``;
        without it these need ``f0``.
    folder : Path, optional
        What a relative path is relative to.

    Raises
    ------
    InputError
        If the text is none of these, or a value is out of range.
    """
    if text is None:
        return own_support(structure)
    word = str(text)
    require(
        structure.reactions,
        "the structure has no reaction nodes to support",
        field="reaction_nodes",
        value=[],
        remedy="name them in the structure file",
    )
    if word in ("pinned", "clamped"):
        return pinned(structure) if word == "pinned" else clamped(structure)
    name, colon, arguments = word.partition(":")
    forms = short_forms()
    if colon and name == MUDLINE:
        return _mudline(arguments, structure, first_frequency_hz)
    if colon and name in forms:
        return on_translations(structure, parse_law(name, arguments, first_frequency_hz))
    foundation = named_foundation(text, folder)
    if foundation is not None:
        return foundation.heads(structure)
    path = Path(word) if folder is None else folder / word
    if path.suffix.lower() in (".yaml", ".yml"):
        return _read_support_file(path, structure)
    known = ["pinned", "clamped", *shipped_foundations(), *forms, MUDLINE]
    forms = {**forms, MUDLINE: "LAW:k_u=,k_theta=,…"}
    raise InputError(
        "unknown support or law",
        field="support",
        value=word,
        allowed=", ".join(f"{k}:{forms[k]}" if k in forms else k for k in known) + ", or a .yaml file",
        remedy=did_you_mean(name, known) or "take one of these, or give the path of a file",
    )


def read_supported(
    text: str | Path | None,
    structure: Structure,
    *,
    pile_model: PileModel | None = None,
    first_frequency_hz: Callable[[], float] = _unknown_frequency,
    folder: Path | None = None,
) -> tuple[Structure, Support]:
    """Return the structure and the support that a user asked for, with its piles as members if so asked.

    Under one matrix at the mudline the feet are tied to one node.

    Parameters
    ----------
    pile_model : {"head", "members"}, optional
        How piles stand under the structure; by default as their foundation says. The other parameters are
        those of :func:`read_support`.

    Raises
    ------
    InputError
        As :func:`read_support`; and if members are asked for where no foundation of piles is.
    """
    foundation = named_foundation(text, folder) if structure.reactions else None
    if foundation is not None:
        return foundation.under(structure, pile_model)
    require(
        pile_model != "members",
        "only the piles of a foundation can be members",
        field="pile_model",
        value=pile_model,
        allowed="members, with a foundation as the support",
        remedy=f"give a foundation file or {', '.join(shipped_foundations())} as the support",
    )
    if text is not None and str(text).startswith(f"{MUDLINE}:"):
        structure = tied_at_mudline(structure)
    return structure, read_support(text, structure, first_frequency_hz=first_frequency_hz, folder=folder)


def _mudline(text: str, structure: Structure, first_frequency_hz: Callable[[], float]) -> Support:
    """Return the support of ``LAW:k_u=…,k_theta=…,…`` behind ``mudline:``, under the one foot."""
    feet = structure.reaction_nodes
    require(
        len(feet) == 1,
        "the feet are not tied to one node",
        field="reaction_nodes",
        value=list(feet),
        remedy="jackettwin.soil.read_supported ties them, and returns the structure, too",
    )
    with located(field=f"support.{MUDLINE}"):
        law, given = _mudline_values(text)
        for p in mudline_parameters(law)[:2]:
            require_positive(p.name, given[p.name])
        at = given.get("f0")
        return mudline_support(structure, law, given, first_frequency_hz if at is None else lambda: at)


def _mudline_values(text: str) -> tuple[Family, dict[str, float]]:
    """Return the law of ``LAW:k_u=…,k_theta=…,…``, Kelvin–Voigt if none is named, and its numbers."""
    name, colon, arguments = text.partition(":")
    law = look_up(families(), name if colon else "kelvin-voigt", "law")
    names = [p.name for p in mudline_parameters(law)] + (["f0"] if law.needs_frequency else [])
    given = _arguments(",".join(f"{key}=" for key in names), arguments if colon else text)
    return law, {key: _number(key, value) for key, value in given.items()}


def named_foundation(text: str | Path | None, folder: Path | None = None) -> Foundation | None:
    """Return the foundation that a support's text names; None if it names another kind of support."""
    if text is None:
        return None
    if str(text) in shipped_foundations():
        return read_foundation(str(text))
    path = Path(text) if folder is None else folder / text
    if path.suffix.lower() not in (".yaml", ".yml"):
        return None
    content = read_yaml(path, what="support file")
    return build_foundation(content, path) if isinstance(content, dict) and "pile" in content else None


def short_forms() -> Mapping[str, str]:
    """Return what each law's short form takes behind its name: ``k=,c=``."""
    updated = {
        name: ",".join(f"{key}=" for key in (*law.names, *(["f0"] if law.needs_frequency else [])))
        for name, law in families().items()
    }
    return {"elastic": "k=", "maxwell": "k0=,branches=k/tau;k/tau", **updated}


def parse_law(name: str, arguments: str, first_frequency_hz: Callable[[], float]) -> Law:
    """Return the law of a short form ``name:arguments``.

    Raises
    ------
    InputError
        If an argument is missing, unknown, given twice, not a number or out of range.
    """
    with located(field=f"support.{name}"):
        given = _arguments(short_forms()[name], arguments)
        branches = given.pop("branches", "")
        number = {key: _number(key, text) for key, text in given.items()}
        if name == "elastic":
            return Prony(k0=number["k"])
        if name == "maxwell":
            return Prony(number["k0"], 0.0, *_branches(branches))
        law, f0 = families()[name], 1.0
        if law.needs_frequency:
            f0 = number["f0"] if "f0" in number else first_frequency_hz()
            require_positive("f0", f0)
        return law.build(np.array([number[p] for p in law.names]), f0)


def read_law(text: str) -> Law:
    """Return the law of a short form ``name:k=…``, of those that ``--support`` takes.

    Raises
    ------
    InputError
        If there is no such law, or an argument is missing, unknown, not a number or out of range.
    """
    name, _, arguments = text.partition(":")
    look_up(short_forms(), name, "law", field="law")
    return parse_law(name, arguments, _unknown_frequency)


def read_family(text: str) -> tuple[Family, FloatArray, bool]:
    """Return the law of a short form that can be updated, its values, and whether it is at the mudline.

    Parameters
    ----------
    text : ``name:k=…``, or ``mudline:name:k_u=…,k_theta=…``

    Raises
    ------
    InputError
        If there is no such law, or a value is missing, unknown or out of its bounds.
    """
    name, _, arguments = text.partition(":")
    at_mudline = name == MUDLINE
    with located(field=f"support.{name}"):
        if at_mudline:
            law, given = _mudline_values(arguments)
            parameters = mudline_parameters(law)
        else:
            law = look_up(families(), name, "law", field="support")
            read = _arguments(short_forms()[name], arguments)
            parameters, given = (
                law.parameters,
                {p.name: _number(p.name, read[p.name]) for p in law.parameters},
            )
        for p in parameters:
            require_between(p.name, given[p.name], p.low, p.high, "" if p.unit == "-" else p.unit)
    return law, np.array([given[p.name] for p in parameters]), at_mudline


def _arguments(form: str, text: str) -> dict[str, str]:
    """Return the arguments of a short form by name."""
    known = [part.partition("=")[0] for part in form.split(",")]
    values: dict[str, str] = {}
    for part in filter(None, text.split(",")):
        key, _, value = part.partition("=")
        remedy = did_you_mean(key, known) or "take one of these"
        require(key in known, "unknown argument", value=part, allowed=form, remedy=remedy)
        require(key not in values, "argument is given twice", field=key, value=part)
        values[key] = value
    for key in known:
        require(key in values or key == "f0", "argument is missing", field=key, allowed=form)
    return values


def _number(key: str, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    require(np.isfinite(value), "not a finite number", field=key, value=text, remedy="write e.g. 2.5e9")
    return value


def _branches(text: str) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return stiffnesses and relaxation times of ``k/tau;k/tau``."""
    pairs = [pair.split("/") for pair in text.split(";") if pair]
    require(
        pairs and all(len(pair) == 2 for pair in pairs),
        "branches are pairs k/tau joined by ;",
        field="branches",
        value=text,
        allowed="k/tau;k/tau",
    )
    k, tau = (tuple(_number("branches", pair[i]) for pair in pairs) for i in (0, 1))
    for value in tau:
        require_positive("tau", value)
    return k, tau


def _read_support_file(path: Path, structure: Structure) -> Support:
    schema = validate(SpringsSchema, read_yaml(path, what="support file"), file=path)
    springs: list[Spring] = []
    for index, entry in enumerate(schema.supports):
        with located(file=path, field=f"supports.{index}"):
            springs += entry.build(structure)
    return Support(springs=tuple(springs))


def _matrix(values: list[float] | list[list[float]]) -> FloatArray:
    """Return the 6×6 matrix of 3 or 6 diagonal values, or of a full symmetric matrix."""
    told = {"field": "stiffness", "allowed": "3 or 6 numbers, or a symmetric 6×6 matrix that stores energy"}
    if all(isinstance(value, (int, float)) for value in values) and len(values) in (3, 6):
        matrix = np.diag(np.concatenate([np.asarray(values, dtype=float), np.zeros(6 - len(values))]))
    else:
        try:
            matrix = np.array(values, dtype=float)
        except ValueError:
            raise InputError("stiffness rows differ in length", **told) from None
        require(matrix.shape == (6, 6), "stiffness has the wrong shape", value=matrix.shape, **told)
    scale = np.sqrt(np.maximum(np.abs(np.diag(matrix)), 1e-300))
    scaled = matrix / np.outer(scale, scale)
    require(np.abs(scaled - scaled.T).max() <= 1e-6, "stiffness is not symmetric", **told)
    passive = np.linalg.eigvalsh(scaled).min() >= -1e-9
    require(passive, "stiffness gives energy out", value=float(np.diag(matrix).min()), **told)
    return np.asarray(0.5 * (matrix + matrix.T))
