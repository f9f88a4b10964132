"""A constraint for astroplan: targets where the sky is dark enough."""

from __future__ import annotations

from typing import Any

import astropy.units as u
import numpy as np
from astroplan import Constraint
from astropy.coordinates import SkyCoord
from astropy.time import Time

from .astropy import SURFACE_BRIGHTNESS, NightSky
from .questions import Questions


class SkyBrightnessConstraint(Constraint):  # type: ignore[misc]
    """The sky where the target stands is at least so dark, in magnitudes per square arcsecond.

    With ``limiting_magnitude`` instead, a star so faint must be seen there by the naked eye. Places of the observer
    are those of astroplan's ``Observer``; ``asked`` are the server's parameters, such as ``turbidity``.
    """

    def __init__(
        self,
        client: Questions,
        darkest: u.Quantity | None = None,
        *,
        limiting_magnitude: u.Quantity | None = None,
        time_step: u.Quantity | None = None,
        **asked: Any,
    ) -> None:
        if darkest is not None and limiting_magnitude is None:
            self.at_least, self._column = darkest.to(SURFACE_BRIGHTNESS), "brightness"
        elif limiting_magnitude is not None and darkest is None:
            self.at_least, self._column = limiting_magnitude.to(u.mag), "limiting_magnitude"
        else:
            raise ValueError("say either how dark the sky has to be or limiting_magnitude=")
        self.client = client
        self._how = {"time_step": time_step, **asked}
        self._skies: dict[tuple[float, float, float], NightSky] = {}

    def compute_constraint(self, times: Time, observer: Any, targets: SkyCoord) -> np.ndarray[Any, Any]:
        """Whether it is dark enough, by target and time."""
        location = observer.location
        place = (location.lat.value, location.lon.value, location.height.to_value(u.m))
        if place not in self._skies:
            self._skies[place] = NightSky(self.client, location, **self._how)
        night = self._skies[place]
        moments = np.atleast_1d(times)
        each = np.atleast_1d(targets) if targets.isscalar else np.asarray(targets).ravel()
        shape = np.broadcast_shapes(targets.shape, times.shape)
        seen = [night.track(target, moments)[self._column] for target in each]
        return np.array([row >= self.at_least for row in seen]).reshape(shape)
