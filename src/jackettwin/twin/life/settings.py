"""``life`` of a twin file: how damage at the welds is counted, and what life was designed for."""

from __future__ import annotations

from datetime import date
from typing import Annotated

from pydantic import Field

from jackettwin.fatigue import ModelsAtHeight, TubeDetails, models_at_height
from jackettwin.files import Schema


class LifeSettings(Schema):
    """S-N curve and design life of the welds.

    Attributes
    ----------
    curve, edition : of the S-N curve; None takes the newest edition that comes with the package
    butt_curve : of butt welds around tubes
    design_factor : design fatigue factor
    years : design life; with the factor it is the budget of damage of a year
    in_service : since when damage is done; None is since the first record
    """

    curve: str = "T"
    edition: str | None = None
    butt_curve: str = "D"
    design_factor: Annotated[float, Field(ge=1.0, le=10.0)] = 1.0
    years: Annotated[float, Field(gt=0.0, le=200.0)] = 25.0
    in_service: date | None = None

    @property
    def models(self) -> ModelsAtHeight:
        """Corrosion environment of a weld at an elevation above the sea [m], and its curve.

        Raises
        ------
        InputError
            If there is no such curve or edition.
        """
        return self._models(self.curve)

    @property
    def details(self) -> TubeDetails:
        """Butt welds around tubes and their curve.

        Raises
        ------
        InputError
            If there is no such curve or edition.
        """
        return TubeDetails(self._models(self.butt_curve))

    def _models(self, curve: str) -> ModelsAtHeight:
        return models_at_height(curve, design_factor=self.design_factor, edition=self.edition)

    @property
    def budget(self) -> float:
        """Damage of a year by the design curve that the design life allows."""
        return 1.0 / (self.design_factor * self.years)
