"""What a plan says, as a page to read or to print."""

from __future__ import annotations

from html import escape
from typing import Any

_STYLE = (
    "body{font:15px/1.5 sans-serif;max-width:60em;margin:2em auto;padding:0 1em}"
    "table{border-collapse:collapse;margin:1em 0}th,td{padding:.3em .7em;border-bottom:1px solid #bbb;text-align:right}"
    "th:first-child,td:first-child{text-align:left}.no{color:#a03000}"
)
# Pixels that the page lists.
_LISTED = 30


def of_plan(plan: dict[str, Any], link: str) -> str:
    """A page about a plan."""
    sites = plan["sites"]
    scene = sites[0]["scene"]
    head = (
        f"<p>{plan['dimmed_pixels']} of {plan['lit_pixels_within_reach']} lit pixels within 300 km are dimmed; "
        f"{100 * plan['flux_removed_share']:.2f} % of their light goes. No light is cut by more than "
        f"{100 * (plan.get('max_cut') or 1):.0f} %.</p>"
    )
    least = plan.get("least_flux_dnb_w")
    if least is not None:
        head += (
            f"<p>{plan['flux_removed_dnb_w']:.0f} W of upward flux (in the satellite's band) go; no plan that does "
            f"as much takes less than {least:.0f} W.</p>"
        )
    if scene.get("illustrative"):
        head += "<p class='no'>The scene is illustrative: made-up light, not measured.</p>"
    if link:
        head += f"<p><a href='{escape(link, quote=True)}'>The plan in the browser</a></p>"
    shown = [_site(site) for site in sites]
    pixels = [_pixel(pixel) for pixel in plan["pixels"][:_LISTED]]
    columns = ["site", "measure", "before", "after", "darker by", "zenith before", "after", "Bortle"]
    lights = ["rank", "place", "cut", "light that goes (W)", "its part of the effect", "with those before"]
    return (
        f"<!doctype html><html lang='en'><meta charset='utf-8'><title>What to dim</title><style>{_STYLE}</style>"
        f"<h1>What to dim</h1><p>Scene {escape(scene['id'])}, plan {escape(plan['id'])}, {escape(plan['created'])}</p>"
        f"{head}<h2>Sites</h2>{_table(columns, shown)}{''.join(_why_not(sites))}"
        f"<h2>The lights with the most effect</h2>{_table(lights, pixels)}</html>"
    )


def _site(site: dict[str, Any]) -> list[str]:
    before, after = site["sky_before"], site["sky_after"]
    return [
        _place(site["observer"]),
        site["measure"],
        f"{site['before']:.3g} {site['unit']}",
        f"{site['after']:.3g} {site['unit']}",
        f"{100 * site['reduced_by']:.1f} %",
        _magnitude(before["zenith_total_brightness_mag_arcsec2"]),
        _magnitude(after["zenith_total_brightness_mag_arcsec2"]),
        f"{before['bortle_class'] or '–'} → {after['bortle_class'] or '–'}",
    ]


def _why_not(sites: list[dict[str, Any]]) -> list[str]:
    unmet = [site for site in sites if not site["target"]["is_met"]]
    return [
        f"<p class='no'>{_place(site['observer'])}: {escape(site['target']['why_not'] or 'out of reach')}</p>"
        for site in unmet
    ]


def _pixel(pixel: dict[str, Any]) -> list[str]:
    return [
        str(pixel["rank"]),
        _place(pixel),
        f"{100 * pixel['cut']:.0f} %",
        f"{pixel['flux_removed_dnb_w']:.1f}",
        f"{100 * pixel['effect']:.2f} %",
        f"{100 * pixel['cumulative_effect']:.1f} %",
    ]


def _place(at: dict[str, Any]) -> str:
    return f"{at['latitude_deg']:.4f}, {at['longitude_deg']:.4f}"


def _magnitude(value: float | None) -> str:
    return "–" if value is None else f"{value:.2f} mag/arcsec²"


def _table(columns: list[str], rows: list[list[str]]) -> str:
    head = "".join(f"<th>{escape(column)}</th>" for column in columns)
    body = "".join("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows)
    return f"<table><tr>{head}</tr>{body}</table>"
