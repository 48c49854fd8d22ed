"""Routes for support laws: which there are, and what one does at every frequency and through time."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query

from jackettwin.files import null_for_nan
from jackettwin.service.web import auth
from jackettwin.service.web.dependencies import WAITING, Route
from jackettwin.service.web.problems import answers
from jackettwin.service.web.schemas.common import Page
from jackettwin.service.web.schemas.drawings import LawFamilyOut, LawOut, LawParameterOut

router = APIRouter(tags=["answers"], route_class=Route)

_POINTS = 200
_F0 = LawParameterOut(name="f0", words="reference frequency", unit="Hz", low=0.01, high=10.0)
"""Of laws that are stated at one; below and above it no structure has its first mode."""


@router.get("/laws", dependencies=[auth.VIEWER, WAITING], responses=answers(401, 422))
def laws() -> Page[LawFamilyOut]:
    """List the support laws, also of installed packages, the usual ones first."""
    from jackettwin.soil import DEFAULT_LAWS, families

    known = families()
    found = []
    for name in dict.fromkeys((*DEFAULT_LAWS, *known)):
        law = known[name]
        each = [LawParameterOut.model_validate(p, from_attributes=True) for p in law.parameters]
        parameters = [*each, _F0] if law.needs_frequency else each
        found.append(LawFamilyOut(name=name, words=law.words, parameters=parameters))
    return Page(items=found)


@router.get("/law", dependencies=[auth.VIEWER, WAITING], responses=answers(401, 422))
def law(
    of: Annotated[
        str,
        Query(
            max_length=300,
            description="A law as --support takes it.",
            examples=["zener:k0=2.6e9,c=8.7e8,k1=1e10"],
        ),
    ],
    low_hz: Annotated[float, Query(gt=0.0, le=1e6)] = 0.01,
    high_hz: Annotated[float, Query(gt=0.0, le=1e6)] = 10.0,
) -> LawOut:
    """Return storage, loss, creep and relaxation of a law, as ``jackettwin law`` does."""
    from jackettwin.soil import law_curves, read_law

    found = law_curves(read_law(of), low_hz, high_hz, _POINTS)
    return LawOut(
        law=of,
        frequency_hz=found.frequency_hz.tolist(),
        storage_n_m=null_for_nan(found.stiffness.real.tolist()),
        loss_n_m=null_for_nan(found.stiffness.imag.tolist()),
        loss_factor=null_for_nan(found.loss_factor.tolist()),
        time_s=found.time_s.tolist(),
        creep_m_n=null_for_nan(found.creep.tolist()),
        relaxation_n_m=null_for_nan(found.relaxation.tolist()),
    )
