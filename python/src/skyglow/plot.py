"""Pictures of skies and maps, each in one line, by matplotlib."""

from __future__ import annotations

from typing import Any

import geopandas
import matplotlib.pyplot as plt
import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.collections import Collection, PolyCollection
from matplotlib.colors import LogNorm, Normalize
from matplotlib.ticker import FuncFormatter

from . import datasets

COMPASS = ("N", "NE", "E", "SE", "S", "SW", "W", "NW")
GROUND = "#1b1d22"
# Magnitudes of the server's own scale: one scale for all skies, so that two pictures can be compared.
BRIGHTEST_MAG, DARKEST_MAG = 15.0, 25.0


def fisheye(
    sky: xarray.Dataset,
    *,
    ax: Axes | None = None,
    cmap: str = "inferno",
    title: str | None = None,
    limits: tuple[float, float] = (BRIGHTEST_MAG, DARKEST_MAG),
    colorbar: bool = True,
) -> Axes:
    """The sky as one sees it lying on the ground, head to the north: north up, east left, the zenith in the middle.

    ``limits`` are the magnitudes of the brightest and the darkest colour.
    """
    values, norm, label = _shown(sky, limits)
    if ax is None:
        _, made = plt.subplots(figsize=(6.4, 6.4), subplot_kw={"projection": "polar"}, layout="constrained")
        ax = made
    elif ax.name != "polar":
        raise ValueError('a fisheye needs polar axes: plt.subplots(subplot_kw={"projection": "polar"})')
    polar: Any = ax
    azimuth_edges, elevation_edges = _edges(sky["azimuth"].values), _edges(sky["elevation"].values)
    mesh = polar.pcolormesh(
        np.radians(azimuth_edges), 90.0 - elevation_edges, values, cmap=cmap, norm=norm, rasterized=True
    )
    azimuth, horizon = _closed_horizon(sky)
    polar.fill_between(np.radians(azimuth), 90.0 - horizon, 90.0, color=GROUND, linewidth=0, zorder=2)
    polar.set_theta_zero_location("N")
    polar.set_theta_direction(1)
    polar.set_ylim(0.0, 90.0)
    polar.set_xticks(np.radians(np.arange(0, 360, 45)), COMPASS)
    polar.set_yticks([30.0, 60.0], ["60°", "30°"], color="white", fontsize="small")
    polar.grid(color="white", alpha=0.18, linewidth=0.6)
    polar.tick_params(pad=4)
    polar.spines["polar"].set_color(GROUND)
    _finish(ax, mesh, norm, label, sky, title, 0.72 if colorbar else None)
    return ax


def panorama(
    sky: xarray.Dataset,
    *,
    ax: Axes | None = None,
    cmap: str = "inferno",
    title: str | None = None,
    limits: tuple[float, float] = (BRIGHTEST_MAG, DARKEST_MAG),
    colorbar: bool = True,
) -> Axes:
    """The sky as a strip, south in the middle; ``limits`` as for a fisheye."""
    values, norm, label = _shown(sky, limits)
    if ax is None:
        _, ax = plt.subplots(figsize=(11, 3.6), layout="constrained")
    # North is at both ends.
    azimuth_edges = _edges(np.append(sky["azimuth"].values, 360.0 + sky["azimuth"].values[0]))
    around = np.column_stack([values, values[:, 0]])
    mesh = ax.pcolormesh(azimuth_edges, _edges(sky["elevation"].values), around, cmap=cmap, norm=norm, rasterized=True)
    azimuth, horizon = _closed_horizon(sky)
    ax.fill_between(azimuth, horizon, color=GROUND, linewidth=0, zorder=2)
    ax.set(xlim=(0.0, 360.0), ylim=(0.0, 90.0), xlabel="azimuth", ylabel="elevation")
    ax.set_xticks(np.arange(0, 361, 45), [*COMPASS, "N"])
    ax.set_yticks(np.arange(0, 91, 30), [f"{angle}°" for angle in range(0, 91, 30)])
    _finish(ax, mesh, norm, label, sky, title, 1.0 if colorbar else None)
    return ax


def map(  # noqa: A001 - `skyglow.plot.map` is the plain name
    shown: geopandas.GeoDataFrame | xarray.DataArray,
    column: str | None = None,
    *,
    ax: Axes | None = None,
    cmap: str | None = None,
    title: str | None = None,
) -> Axes:
    """A map of points (influences, plans, skies, places) or of a layer.

    ``column`` says what of a table is shown; without it ``share`` of influences, ``cut`` of plans, or the
    brightness of the zenith.
    """
    if ax is None:
        _, ax = plt.subplots(figsize=(7.6, 6.2), layout="constrained")
    if isinstance(shown, xarray.DataArray):
        drawn, label = _draw_layer(ax, shown, cmap)
        latitude = float(shown[shown.dims[0]].mean())
        is_geographic = shown.dims[0] == "latitude"
    else:
        drawn, label = _draw_points(ax, shown, column, cmap)
        latitude = float(shown.geometry.y.mean()) if len(shown) else 0.0
        is_geographic = shown.crs is None or shown.crs.is_geographic
    if is_geographic:
        ax.set_aspect(1.0 / max(np.cos(np.radians(latitude)), 0.05))
        ax.set(xlabel="longitude, °E", ylabel="latitude, °N")
    else:
        ax.set_aspect(1.0)
        ax.set(xlabel="x, m", ylabel="y, m")
    if drawn is not None:
        bar = ax.figure.colorbar(drawn, ax=ax, shrink=0.85, pad=0.02)
        bar.set_label(label)
        if label.startswith(("share", "part")):
            bar.ax.yaxis.set_major_formatter(FuncFormatter(lambda share, _: f"{100 * share:g} %"))
        if "mag" in label:
            bar.ax.invert_yaxis()
    ax.set_title(title or _map_title(shown), fontsize="medium", loc="left")
    return ax


def _shown(sky: xarray.Dataset, limits: tuple[float, float]) -> tuple[np.ndarray[Any, Any], Normalize, str]:
    """What a picture shows of a sky: magnitudes where it has them, else the value itself on a logarithmic scale."""
    if "response" in sky.dims:
        raise ValueError('the sky has several responses: sky.sel(response="photopic") takes one')
    if "time" in sky.dims:
        raise ValueError("the sky has several times: sky.isel(time=0) takes one")
    order = ("elevation", "azimuth")
    if "brightness" in sky and not bool(sky["brightness"].isnull().all()):
        brightest, darkest = limits
        values = _down_to_the_ground(sky["brightness"].transpose(*order).values, darkest)
        # Colour maps end bright: the scale runs from dark to bright.
        return -values, Normalize(-darkest, -brightest), "brightness, mag/arcsec²"
    name = "luminance" if "luminance" in sky else "radiance_seen"
    shown = sky[name].transpose(*order)
    unit = shown.attrs["units"]
    if unit == "cd m-2":
        low, high = datasets.luminance_cd_m2(limits[::-1])
    else:
        lit = shown.values[shown.values > 0]
        low, high = (lit.min(), lit.max() * 1.001) if lit.size else (1e-9, 1.0)
    label = f"{name.replace('_', ' ')}, {_unit(unit)}"
    # Below the scale's end there is nothing to tell apart, and a logarithm has no 0.
    values = np.maximum(_down_to_the_ground(shown.values, low), low * (1 + 1e-6))
    return values, LogNorm(low, high), label


def _down_to_the_ground(values: np.ndarray[Any, Any], nothing: float) -> np.ndarray[Any, Any]:
    """Hidden samples as the lowest visible ones above them: the drawn ground covers them, with a smooth edge."""
    filled = values.copy()
    for row in range(len(filled) - 2, -1, -1):
        filled[row] = np.where(np.isfinite(filled[row]), filled[row], filled[row + 1])
    return np.where(np.isfinite(filled), filled, nothing)


def _unit(unit: str) -> str:
    return {"cd m-2": "cd/m²", "W m-2 sr-1": "W/(m² sr)", "nW cm-2 sr-1": "nW/(cm² sr)"}.get(unit, unit)


def _finish(
    ax: Axes, mesh: Any, norm: Normalize, label: str, sky: xarray.Dataset, title: str | None, shrink: float | None
) -> None:
    if shrink is not None:
        bar = ax.figure.colorbar(mesh, ax=ax, shrink=shrink, pad=0.04, extend="both")
        bar.set_label(label)
        if not isinstance(norm, LogNorm):
            brightest, darkest = -float(norm.vmax or 0.0), -float(norm.vmin or 0.0)
            step = 2.0 if darkest - brightest > 6.0 else 1.0
            ticks = np.arange(np.ceil(brightest / step) * step, darkest + 1e-6, step)
            bar.set_ticks(list(-ticks), labels=[f"{tick:.0f}" for tick in ticks])
    ax.set_title(_sky_title(sky) if title is None else title, fontsize="medium", loc="left")


def _sky_title(sky: xarray.Dataset) -> str:
    observer = {"latitude_deg": float(sky["latitude"]), "longitude_deg": float(sky["longitude"])}
    words = [f"{datasets.place(observer)}, {float(sky['altitude']):.0f} m"]
    if "time" in sky.coords:
        words.append(f"{str(sky['time'].values.astype('datetime64[m]')).replace('T', ' ')} UTC")
    light = {"artificial": "artificial light", "total": "all light"}[sky.attrs["light"]]
    words.append(f"{light}, {sky['response'].item()}, turbidity {sky.attrs['turbidity']:g}")
    if sky.attrs.get("comment"):
        words.append(sky.attrs["comment"])
    return "\n".join(words)


def _closed_horizon(sky: xarray.Dataset) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
    """The horizon all around, with its first point again at the end."""
    azimuth, horizon = sky["azimuth"].values, sky["horizon"].values
    return np.append(azimuth, azimuth[0] + 360.0), np.append(horizon, horizon[0])


def _edges(centres: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    half = 0.5 * (centres[1] - centres[0])
    return np.append(centres - half, centres[-1] + half)


def _draw_points(
    ax: Axes, frame: geopandas.GeoDataFrame, column: str | None, cmap: str | None
) -> tuple[Collection | None, str]:
    usual = ("share", "cut", "zenith_total_brightness_mag_arcsec2", "brightness_mag_arcsec2", "population")
    name = column or next((known for known in usual if known in frame.columns), None)
    points = frame.geometry
    if name is None or frame.empty:
        ax.scatter(points.x, points.y, s=12, color="tab:orange")
        return None, ""
    values = frame[name].astype(float)
    # The strongest lie on top of the others.
    is_magnitude = name.endswith("mag_arcsec2")
    order = np.argsort(-values.to_numpy() if is_magnitude else values.to_numpy(), kind="stable")
    norm: Normalize | None = Normalize(0.0, 1.0) if name == "cut" else None
    if name in ("share", "influence", "population") and (values > 0).any():
        norm = LogNorm(values[values > 0].min(), values.max())
    at, seen = np.column_stack([points.x, points.y])[order], values.to_numpy()[order]
    colours = cmap or ("inferno_r" if is_magnitude else "magma_r")
    # Named places have shares too, and are no pixels.
    size = _pixel_size(at) if name in ("share", "influence", "cut") and "name" not in frame else None
    if size is not None:
        corners = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]) * size
        drawn: Collection = PolyCollection(
            at[:, np.newaxis] + corners, array=seen, norm=norm, cmap=colours, linewidths=0, rasterized=True
        )
        drawn.set_offsets(np.zeros((1, 2)))
        ax.add_collection(drawn)
        ax.margins(0.08)
        ax.autoscale_view()
    else:
        drawn = ax.scatter(
            at[:, 0],
            at[:, 1],
            c=seen,
            s=24 if len(frame) < 1000 else 8,
            marker="o" if len(frame) < 100 or is_magnitude else "s",
            norm=norm,
            cmap=colours,
            linewidths=0.2,
            edgecolors="0.3",
        )
        ax.margins(0.08)
    observers = [frame.attrs] if "observer" in frame.attrs else frame.attrs.get("sites", [])
    for observer in (each["observer"] for each in observers):
        where = (observer["longitude_deg"], observer["latitude_deg"])
        ax.plot(*where, "x", color="tab:blue", ms=11, mew=2.5)
        ax.annotate("observer", where, xytext=(7, 7), textcoords="offset points", color="tab:blue")
    return drawn, _label(name, frame.attrs)


def _pixel_size(at: np.ndarray[Any, Any]) -> np.ndarray[Any, Any] | None:
    """Width and height of the pixels whose middles these are; None where no grid along the axes has them."""
    sizes = []
    for along in at.T:
        ticks = np.unique(np.round(along, 7))
        if ticks.size < 2:
            return None
        step = float(np.diff(ticks).min())
        steps = (ticks - ticks[0]) / step
        if np.abs(steps - np.round(steps)).max() > 0.05:
            return None
        sizes.append(float(ticks[-1] - ticks[0]) / float(np.round(steps[-1])))
    return np.array(sizes)


def _label(name: str, attributes: dict[str, Any]) -> str:
    of_measure = f" of {attributes['measure']}" if "measure" in attributes else ""
    known = {
        "share": f"share{of_measure}",
        "influence": f"influence on {attributes.get('measure', 'the sky')}, {_unit(attributes.get('unit', ''))}",
        "cut": "part of the light that goes",
        "zenith_total_brightness_mag_arcsec2": "brightness of the zenith, mag/arcsec²",
        "brightness_mag_arcsec2": "measured brightness, mag/arcsec²",
    }
    return known.get(name, name.replace("_", " "))


def _draw_layer(ax: Axes, layer: xarray.DataArray, cmap: str | None) -> tuple[Any, str]:
    y, x = layer.dims
    values = layer.values.astype(float)
    label = str(layer.attrs.get("long_name", layer.name)).partition(";")[0]
    unit = str(layer.attrs.get("units", ""))
    norm: Normalize | None = None
    if layer.name == "elevation":
        colours = cmap or "gist_earth"
    elif layer.name == "brightness" and unit in ("cd m-2", "cd/m2"):
        values, unit = datasets.brightness_mag_arcsec2(values), "mag/arcsec²"
        label, norm = "artificial light at the zenith", Normalize(BRIGHTEST_MAG, DARKEST_MAG)
        colours = cmap or "inferno_r"
    else:
        values = np.where(values > 0, values, np.nan)
        lit = values[np.isfinite(values)]
        norm = LogNorm(np.percentile(lit, 1), lit.max()) if lit.size else None
        colours = cmap or "inferno"
        ax.set_facecolor("black")
    mesh = ax.pcolormesh(
        _edges(layer[x].values), _edges(layer[y].values), values, cmap=colours, norm=norm, rasterized=True
    )
    return mesh, f"{label}, {_unit(unit)}" if unit else label


def _map_title(shown: geopandas.GeoDataFrame | xarray.DataArray) -> str:
    if isinstance(shown, xarray.DataArray):
        return str(shown.attrs.get("long_name", "")).partition("; ")[2].capitalize()
    sites = shown.attrs.get("sites") or [{}]
    scene = shown.attrs.get("scene") or sites[0].get("scene")
    if not isinstance(scene, dict):
        return ""
    note = " (illustrative, not measured)" if scene.get("illustrative") else ""
    return f"Scene {scene['id']}{note}"
