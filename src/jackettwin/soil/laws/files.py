"""Support laws in YAML: parameters of a factor on a stiffness."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from jackettwin.files import Schema
from jackettwin.soil.laws.viscoelastic import Law, Prony, Springpot, kelvin_voigt

Share = Annotated[float, Field(ge=0.0, le=1e6)]
"""Of the stiffness that the law scales."""
Time = Annotated[float, Field(ge=0.0, le=1e9)]
"""Of relaxation or retardation [s]."""


class BranchSchema(Schema):
    """A Maxwell branch: relative stiffness and relaxation time."""

    g: Share
    tau_s: Annotated[Time, Field(gt=0.0)]


class ElasticLaw(Schema):
    """K."""

    type: Literal["elastic"]

    def build(self) -> Law:
        """Return the law."""
        return Prony(k0=1.0)


class KelvinVoigtLaw(Schema):
    """K·(1 + τs)."""

    type: Literal["kelvin-voigt"]
    tau_s: Time

    def build(self) -> Law:
        """Return the law."""
        return kelvin_voigt(1.0, self.tau_s)


class MaxwellLaw(Schema):
    """K·(g0 + Σ g τs/(1+τs))."""

    type: Literal["maxwell"]
    g0: Share = 1.0
    branches: list[BranchSchema] = Field(min_length=1)

    def build(self) -> Law:
        """Return the law."""
        return Prony(self.g0, 0.0, tuple(b.g for b in self.branches), tuple(b.tau_s for b in self.branches))


class SpringpotLaw(Schema):
    """K·(s/ω0)^α."""

    type: Literal["springpot"]
    alpha: Annotated[float, Field(ge=0.0, lt=1.0)]
    omega0_rad_s: Annotated[float, Field(ge=1e-6, le=1e6)]

    def build(self) -> Law:
        """Return the law."""
        return Springpot(1.0, self.alpha, self.omega0_rad_s)


LawSchema = Annotated[ElasticLaw | KelvinVoigtLaw | MaxwellLaw | SpringpotLaw, Field(discriminator="type")]
