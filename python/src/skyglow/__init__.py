"""Skies, influences and plans of Skyglow as xarray, geopandas and astropy objects.

    sky = skyglow.Client("http://127.0.0.1:8080").panorama(46.17, 8.79)
    sky.skyglow.fisheye()

``skyglow.Engine`` answers the same in this process, without a server.
``skyglow.astropy``, ``skyglow.astroplan`` and ``skyglow.measurements`` are imported by name.
"""

from . import accessor, plot
from .answers import Answer, Plan
from .client import AsyncClient, Client
from .engine import Engine
from .errors import (
    BusyError,
    ConflictError,
    FieldError,
    InvalidRequestError,
    NotAllowedError,
    NotFoundError,
    OutsideSceneError,
    ProblemError,
    SkyglowError,
    UnreachableError,
)

__all__ = [
    "Answer",
    "AsyncClient",
    "BusyError",
    "Client",
    "ConflictError",
    "Engine",
    "FieldError",
    "InvalidRequestError",
    "NotAllowedError",
    "NotFoundError",
    "OutsideSceneError",
    "Plan",
    "ProblemError",
    "SkyglowError",
    "UnreachableError",
    "accessor",
    "plot",
]
__version__ = "0.1.0"
