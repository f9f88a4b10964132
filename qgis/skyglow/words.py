"""The numbers of a sky in a line or two."""

from __future__ import annotations

from typing import Any


def headline(sky: dict[str, Any]) -> str:
    """How dark it is: brightness overhead, Bortle's class, and the faintest star."""
    parts = []
    brightness = sky.get("zenith_total_brightness_mag_arcsec2")
    if brightness is not None:
        parts.append(f"{brightness:.2f} mag/arcsec²")
    if sky.get("bortle_class") is not None:
        parts.append(f"Bortle {sky['bortle_class']}")
    if sky.get("naked_eye_limit_mag") is not None:
        parts.append(f"stars to {sky['naked_eye_limit_mag']:.1f} mag")
    return " · ".join(parts)


def details(answer: dict[str, Any]) -> str:
    """How much of it is artificial, and what the answer depends on."""
    sky = answer["sky"]
    sentences = [
        f"Overhead the lamps have {times(sky['ratio_to_natural'])} the natural light.",
        f"Theirs on level ground: {1000 * sky['horizontal_illuminance_lx']:.2g} mlx.",
    ]
    stars = ((answer.get("night_sky") or {}).get("stars") or {}).get("visible")
    if stars is not None:
        sentences.append(f"{stars} stars are seen.")
    if answer["coverage"] < 0.9:
        sentences.append(f"Only {100 * answer['coverage']:.0f} % of the light within 300 km is known.")
    if answer["scene"].get("illustrative"):
        sentences.append("Made-up light, not measured.")
    return " ".join(sentences)


def times(ratio: float) -> str:
    """A ratio as people say it."""
    if ratio < 0.01:
        return "less than 1 % of"
    return f"{100 * ratio:.0f} % of" if ratio < 1 else f"{ratio:.1f} times"


def place(latitude_deg: float, longitude_deg: float) -> str:
    """Coordinates with their sides."""
    north, east = "N" if latitude_deg >= 0 else "S", "E" if longitude_deg >= 0 else "W"
    return f"{abs(latitude_deg):.4f}° {north}, {abs(longitude_deg):.4f}° {east}"
