#!/usr/bin/env python3
"""The pictures of docs/guide.md that show the night, whose light it is, what if, and what to dim, from a running server.

Usage: docs/figures.py SERVER SCENE FOLDER [gallery|night|land|water|clouds|natural|ground|slopes|swaps]: all, or one of those. Made for the Black Marble year of Kenya (VNP46A4, 2023): the sites are there.
`slopes` alone needs two maps in FOLDER, slope.tif and horizontal.tif, each by
skyglow atlas --scene demo --bounds 7.4,45.6,9.8,47.0 --measure slope -o FOLDER/slope.tif
On Debian: apt-get install python3-requests python3-rasterio python3-pil python3-matplotlib
"""

import io
import math
import sys

import numpy
import rasterio
import requests
from PIL import Image, ImageDraw, ImageFont

SERVER, SCENE, FOLDER = sys.argv[1:4]
API = f"{SERVER}/api/v1"
SITE = {"lat": -1.75, "lon": 36.45}
# Light and sky alone, without hills.
OPEN = {"terrain": "off"}
ZOOM, WEST, NORTH, WIDE, HIGH = 9, 306, 257, 3, 3
NAIROBI = [[36.60, -1.50], [37.15, -1.50], [37.15, -1.05], [36.60, -1.05], [36.60, -1.50]]
KENYA = [[33.0, -5.0], [42.5, -5.0], [42.5, 5.5], [33.0, 5.5], [33.0, -5.0]]
FONT = ImageFont.truetype("/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf", 17)


def ask(method, url, **arguments):
    answer = requests.request(method, url, timeout=300, **arguments)
    if not answer.ok:
        sys.exit(f"{url}: {answer.text}")
    return answer


def picture(url, **params):
    return Image.open(io.BytesIO(ask("GET", url, params=params).content)).convert("RGBA")


def sky(scenario=None, **params):
    query = {**SITE, **OPEN, "legend": "on", **params}
    if scenario:
        query["scenario"] = scenario
    return picture(f"{API}/scenes/{SCENE}/panorama.png", **query)


def zenith(scenario=None, **params):
    query = {**SITE, **OPEN, **params, **({"scenario": scenario} if scenario else {})}
    return ask("GET", f"{API}/scenes/{SCENE}/sky", params=query).json()["sky"]["zenith_luminance_cd_m2"]


def map_of(layer, **params):
    """Tiles of a layer over the raster's radiance in grey."""
    whole = Image.new("RGBA", (256 * WIDE, 256 * HIGH), "black")
    for column in range(WIDE):
        for row in range(HIGH):
            at = f"{ZOOM}/{WEST + column}/{NORTH + row}.png"
            under = picture(f"{API}/scenes/{SCENE}/tiles/radiance/{at}")
            grey = Image.merge("RGBA", (*[under.convert("L").point(lambda v: v // 3)] * 3, under.split()[3]))
            whole.alpha_composite(grey, (256 * column, 256 * row))
            if layer:
                whole.alpha_composite(picture(f"{API}/scenes/{SCENE}/tiles/{layer}/{at}", **params), (256 * column, 256 * row))
    return marked(whole)


def place_px(lat, lon):
    n = 256 * 2**ZOOM
    x = (lon + 180) / 360 * n - 256 * WEST
    y = (1 - math.asinh(math.tan(math.radians(lat))) / math.pi) / 2 * n - 256 * NORTH
    return x, y


def marked(image):
    draw = ImageDraw.Draw(image)
    x, y = place_px(SITE["lat"], SITE["lon"])
    draw.ellipse((x - 7, y - 7, x + 7, y + 7), outline="white", width=2)
    return image


def plan_map(plan):
    """Pixels that a plan dims, over the radiance in grey: yellow a little, red all."""
    whole = map_of(None)
    raster = rasterio.open(io.BytesIO(ask("GET", f"{API}/plans/{plan}.tif").content))
    cut = raster.read(1)
    draw = ImageDraw.Draw(whole)
    for row, column in zip(*numpy.nonzero(numpy.nan_to_num(cut) > 0)):
        west, north = raster.transform * (column, row)
        east, south = raster.transform * (column + 1, row + 1)
        corners = (*place_px(north, west), *place_px(south, east))
        draw.rectangle(corners, fill=(255, int(230 * (1 - cut[row, column])), 40))
    return marked(whole)


def sheet(name, rows):
    """Rows of (picture, caption), all of a row as high as each other."""
    height = 330
    lines = []
    for row in rows:
        parts = []
        for image, caption in row:
            image = image.convert("RGB").resize((round(image.width * height / image.height), height), Image.LANCZOS)
            part = Image.new("RGB", (image.width, height + 30), "white")
            part.paste(image, (0, 30))
            ImageDraw.Draw(part).text((4, 5), caption, fill="black", font=FONT)
            parts.append(part)
        line = Image.new("RGB", (sum(part.width + 8 for part in parts), height + 30), "white")
        x = 0
        for part in parts:
            line.paste(part, (x, 0))
            x += part.width + 8
        lines.append(line)
    whole = Image.new("RGB", (max(line.width for line in lines), sum(line.height + 8 for line in lines)), "white")
    y = 0
    for line in lines:
        whole.paste(line, (0, y))
        y += line.height + 8
    whole.save(f"{FOLDER}/{name}.png", optimize=True)


def scenario(*edits, base=None):
    body = {"edits": list(edits), **({"base": base} if base else {})}
    return ask("POST", f"{API}/scenes/{SCENE}/scenarios", json=body).json()["id"]


def polygon(ring, **change):
    return {"polygon": {"type": "Polygon", "coordinates": [ring]}, **change}


def plan(**body):
    return ask("POST", f"{API}/scenes/{SCENE}/plans", params=OPEN, json=body).json()


def side_by_side(name, rows):
    """Pictures of one size without captions."""
    gap = 4
    width, height = rows[0][0].size
    size = (len(rows[0]) * (width + gap) - gap, len(rows) * (height + gap) - gap)
    whole = Image.new("RGB", size, "black")
    for down, row in enumerate(rows):
        for across, image in enumerate(row):
            whole.paste(image.convert("RGB"), (across * (width + gap), down * (height + gap)))
    whole.save(f"{FOLDER}/{name}.png", optimize=True)


def labelled(image, words):
    """A picture with words in its lower left corner."""
    image = image.convert("RGBA")
    draw = ImageDraw.Draw(image)
    left, top, right, bottom = draw.textbbox((14, image.height - 34), words, font=FONT)
    plate = Image.new("RGBA", image.size)
    ImageDraw.Draw(plate).rounded_rectangle((left - 7, top - 5, right + 7, bottom + 5), 6, fill=(9, 13, 26, 190))
    image.alpha_composite(plate)
    ImageDraw.Draw(image).text((14, image.height - 34), words, fill="white", font=FONT)
    return image


def gallery():
    """One place beside a city: by new Moon, half Moon, at dusk and by full Moon; then its lamps, and a plan, seen by one eye."""
    place = {"lat": -1.43, "lon": 36.66}
    look = {**place, "projection": "perspective", "azimuth": 55, "elevation": 22, "fov": 84, "height": 25, "width": 640, "height_px": 400, "style": "eye", "legend": "off"}
    see = lambda words, **params: labelled(picture(f"{API}/scenes/{SCENE}/panorama.png", **{**look, **params}), words)
    dark = "2026-08-12T19:00:00Z"
    made = ask("POST", f"{API}/scenes/{SCENE}/plans", json={"method": "target", "max_cut": 0.7, "sites": [{**place, "reduce_by": 0.5}]}).json()
    lamps = {"time": dark, "adaptation": 0.004}
    side_by_side("gallery", [
        [see("new Moon", time=dark), see("half Moon", time="2026-08-20T18:00:00Z"), see("dusk", time="2026-08-12T16:12:00Z"),
         see("full Moon", time="2026-08-27T19:00:00Z")],
        [see("sodium lamps", lamp="hps", **lamps), see("LED, 4000 K", lamp="led_4000k", **lamps),
         see("today", **lamps), see("with a plan: half of the glow overhead", scenario=made["id"], **lamps)],
    ])
    print("gallery", made["id"], made["dimmed_pixels"], made["flux_removed_share"])


def night():
    """Four skies as the eye sees them, and a town with two kinds of lamps for the eye and for a camera."""
    see = lambda **params: picture(f"{API}/scenes/{SCENE}/panorama.png", legend="off", **params)
    plain, edge = {"lat": -2.3, "lon": 36.9}, {"lat": -1.35, "lon": 36.75}
    dome = {"style": "eye", "projection": "fisheye", "width": 400, "height_px": 400}
    times = [(plain, "2026-08-12T19:00:00Z"), (plain, "2026-08-20T18:00:00Z"), (plain, "2026-08-12T16:10:00Z"), (edge, "2026-08-12T19:00:00Z")]
    side_by_side("night", [[see(**place, **dome, time=time) for place, time in times]])
    towards = {"lat": -1.45, "lon": 36.66, "projection": "perspective", "azimuth": 45, "elevation": 18, "fov": 80, "width": 640, "height_px": 400}
    for_camera = {"style": "realistic", "exposure": -2, "sky": "total"}
    side_by_side("lamps", [
        [see(**towards, **style, time="2026-08-12T19:00:00Z", lamp=lamp) for lamp in ("hps", "led_4000k")]
        for style in ({"style": "eye"}, for_camera)
    ])


def land():
    """A town in a valley of the demo with and without its light, by starlight and under broken clouds, then under snow and by the half Moon; one eye for all."""
    look = {"lat": 46.12, "lon": 9.78, "height": 60, "projection": "perspective", "azimuth": 60, "elevation": 8, "fov": 60, "width": 780, "height_px": 390,
            "style": "eye", "adaptation": 0.001, "ground": "lit", "time": "2026-08-12T22:30:00Z", "legend": "off"}
    edit = {"brush": {"points": [[9.87, 46.17]], "radius_m": 25000}, "factor": 0}
    dimmed = {"scenario": ask("POST", f"{API}/scenes/demo/scenarios", json={"edits": [edit]}).json()["id"]}
    broken = {"clouds": 1500, "cloud_cover": 0.5, "cloud_pattern": 2}
    see = lambda words, **params: labelled(picture(f"{API}/scenes/demo/panorama.png", **{**look, **params}), words)
    side_by_side("land", [
        [see("the town, by starlight"), see("without its light", **dimmed)],
        [see("under broken clouds", **broken), see("without its light", **broken, **dimmed)],
        [see("under snow", ground="snow"), see("by the half Moon", time="2026-08-20T19:45:00Z")],
    ])


def water():
    """A town on the coast of the demo, before land and in calm water."""
    look = {"lat": 44.25, "lon": 8.6, "height": 30, "projection": "perspective", "azimuth": 312, "elevation": 2, "fov": 42, "width": 780, "height_px": 390,
            "style": "eye", "adaptation": 0.002, "time": "2026-08-12T22:30:00Z", "legend": "off"}
    see = lambda ground: labelled(picture(f"{API}/scenes/demo/panorama.png", **look, ground=ground), f"ground={ground}")
    side_by_side("water", [[see("lit"), see("water")]])


def clouds():
    """A town on a lake of the demo under no clouds, some, more and a closed layer, by starlight, and a valley there by the full Moon."""
    see = lambda words, **params: labelled(picture(f"{API}/scenes/demo/panorama.png", legend="off", style="eye", **params), words)
    dome = {"projection": "fisheye", "width": 400, "height_px": 400}
    some = {"clouds": 1500, "cloud_cover": 0.3, "cloud_pattern": 3}
    more = {"clouds": 1500, "cloud_cover": 0.6, "cloud_pattern": 2}
    layers = {"no clouds": {}, "three tenths": some, "six tenths": more, "overcast": {"clouds": 1500}}
    town = {"lat": 46.17, "lon": 8.79, "time": "2026-08-12T22:30:00Z", "adaptation": 0.004}
    moonlit = {"lat": 46.53, "lon": 8.61, "time": "2026-08-27T22:30:00Z", "adaptation": 0.006}
    rows = {"a town": town, "a valley, full Moon": moonlit}
    side_by_side("clouds", [[see(f"{row}, {words}", **place, **dome, **layer) for words, layer in layers.items()] for row, place in rows.items()])


COMPONENTS = {
    "sun": ("Sun", "#d9822b"), "moon": ("Moon", "#808890"), "starlight": ("Milky Way and faint stars", "#3b6fb6"),
    "stars": ("stars, scattered", "#8fb3e0"), "zodiacal_light": ("zodiacal light", "#b08a2e"), "airglow": ("airglow", "#3f9b5b"),
}


def natural():
    """The natural sky of a dark valley of the demo by its components, through a night and through a solar cycle, and all-sky pictures."""
    from datetime import datetime, timedelta

    from matplotlib import dates, pyplot

    place = {"lat": 46.53, "lon": 8.61, "terrain": "off"}

    def zenith_of(**params):
        answer = ask("GET", f"{API}/scenes/demo/sky", params={**place, **params}).json()
        seen = {each["component"]: 1e3 * each["zenith_luminance_cd_m2"] for each in answer["night_sky"]["components"]}
        lamps = 1e3 * answer["sky"]["zenith_luminance_cd_m2"]
        return {**seen, "lamps": lamps, "total": 1e3 * answer["sky"]["zenith_total_luminance_cd_m2"]}

    def lines(axis, across, skies):
        for name, (label, colour) in COMPONENTS.items():
            axis.plot(across, [sky.get(name, float("nan")) for sky in skies], color=colour, label=label, linewidth=1.6)
        axis.plot(across, [sky["lamps"] for sky in skies], color="#c0392b", linestyle=":", label="lamps", linewidth=1.6)
        axis.plot(across, [sky["total"] for sky in skies], color="black", label="all", linewidth=2.2)
        axis.set_yscale("log")
        axis.grid(alpha=0.25, which="major")

    figure, (left, right) = pyplot.subplots(1, 2, figsize=(11, 4.4), width_ratios=(3, 2), sharey=True, layout="constrained")
    times = [datetime(2026, 8, 20, 17, 30) + timedelta(minutes=5) * step for step in range(133)]
    lines(left, times, [zenith_of(time=f"{time:%Y-%m-%dT%H:%M:%SZ}") for time in times])
    left.xaxis.set_major_formatter(dates.DateFormatter("%H"))
    left.set(xlabel="2026-08-20 and 21, UTC: a half Moon sets at dusk", ylabel="luminance of the zenith, mcd/m²", ylim=(1e-3, 1e2), xlim=(times[0], times[-1]))
    fluxes = [65, 75, 90, 110, 130, 150, 170, 190, 210, 230]
    lines(right, fluxes, [zenith_of(time="2026-08-12T22:00:00Z", solar_flux=flux) for flux in fluxes])
    right.set(xlabel="solar flux at 10.7 cm, sfu: minimum to maximum of a cycle", xlim=(65, 230))
    right.legend(loc="lower right", fontsize=8, ncols=2)
    figure.savefig(f"{FOLDER}/natural-sky.png", dpi=110)
    all_skies(place)


def all_skies(place):
    """The whole sky at four hours: on one scale, and each on its own."""
    from matplotlib import colors, pyplot, ticker

    dome = {**place, "terrain": "on", "sky": "total", "projection": "fisheye", "width": 400, "height_px": 400, "legend": "off", "colormap": "viridis"}
    hours = {
        "new Moon": ("2026-08-12T22:00:00Z", 1e-4, 1e-2), "half Moon in the south-west": ("2026-08-20T20:00:00Z", 3e-4, 1e-2),
        "twilight, the Sun 11° below": ("2026-08-12T19:40:00Z", 1e-3, 1e-1), "day": ("2026-08-12T10:00:00Z", 1e3, 3e4),
    }
    figure, rows = pyplot.subplots(2, 4, figsize=(13, 7.2), layout="constrained")
    for column, (words, (time, least, most)) in enumerate(hours.items()):
        for axis, (low, high) in zip(rows[:, column], ((1e-4, 1e4), (least, most))):
            axis.imshow(picture(f"{API}/scenes/demo/panorama.png", **dome, time=time, min=low, max=high))
            axis.axis("off")
            bar = pyplot.cm.ScalarMappable(norm=colors.LogNorm(low, high), cmap="viridis")
            if axis is rows[1, column] or column == 3:
                scale = figure.colorbar(bar, ax=axis, orientation="horizontal" if axis is rows[1, column] else "vertical", shrink=0.8, label="cd/m²")
                scale.ax.xaxis.set_minor_formatter(ticker.NullFormatter())
        rows[0, column].set_title(words, fontsize=11)
    figure.savefig(f"{FOLDER}/all-skies.png", dpi=100, bbox_inches="tight", pad_inches=0.1)


def swaps():
    """What other lamps at as many lumens do to the zenith, by the distance from a town: a town of its own in the place of the demo's lights."""
    from matplotlib import pyplot

    everywhere = [[4.0, 42.5], [15.0, 42.5], [15.0, 49.0], [4.0, 49.0], [4.0, 42.5]]
    town = {"points": [[10.0, 46.0]], "radius_m": 2000}
    edits = [polygon(everywhere, factor=0), {"brush": town, "add_radiance_nw_cm2_sr": 50}]
    alone = ask("POST", f"{API}/scenes/demo/scenarios", json={"edits": edits}).json()["id"]
    distances_km = [1, 2, 3, 5, 7, 10, 15, 20, 30, 40, 50, 65, 80]

    def zeniths(lamp):
        found = []
        for distance_km in distances_km:
            at = {"lat": 46.0, "lon": 10.0 - distance_km / 77.2, **OPEN, "altitude": 300, "scenario": alone, "lamp": lamp}
            answer = ask("GET", f"{API}/scenes/demo/sky", params=at).json()
            lumens = answer["lamp"]["lumens_per_dnb_watt"]
            found.append({each["response"]: each["value"] / lumens for each in answer["sky"]["zenith_by_response"]})
        return found

    sodium = zeniths("hps")
    figure, axes = pyplot.subplots(1, 3, figsize=(11, 3.8), sharex=True, layout="constrained")
    responses = {"scotopic": "eye adapted to the dark", "photopic": "eye adapted to light", "sqm": "Sky Quality Meter"}
    for lamp, colour in {"led_4000k": "#2b6cb0", "led_2700k": "#dd8a2c", "pc_amber": "#b7791f", "lps": "#744210"}.items():
        other = zeniths(lamp)
        for axis, response in zip(axes, responses):
            factors = [new[response] / old[response] for new, old in zip(other, sodium)]
            axis.plot(distances_km, factors, color=colour, label=lamp, marker="o", markersize=3)
    for axis, words in zip(axes, responses.values()):
        axis.set(title=words, xscale="log", xlabel="distance from the town, km")
        axis.axhline(1, color="grey", linewidth=0.8)
        axis.grid(alpha=0.25)
        axis.set_ylim(0, None)
    axes[0].set_ylabel("zenith, times that of high-pressure sodium")
    axes[0].legend(fontsize=8, loc=(0.6, 0.34))
    figure.savefig(f"{FOLDER}/lamp-swaps.png", dpi=110)


def half_moon():
    """Illuminance of level ground by a half Moon, lux, and how high it stands, degrees."""
    at = {"lat": -2.3, "lon": 36.9, "terrain": "off", "time": "2026-08-20T16:30:00Z"}
    answer = ask("GET", f"{API}/scenes/{SCENE}/sky", params=at).json()
    return answer["sky"]["horizontal_total_illuminance_lx"], answer["night_sky"]["moon"]["apparent_altitude_deg"]


def slopes():
    """What level ground and the ground as it slopes have of the demo's lamps by way of the sky, in units of half a Moon."""
    from matplotlib import colors, pyplot

    half_moon_lx, altitude_deg = half_moon()
    moons = []
    for name in ["horizontal", "slope"]:
        with rasterio.open(f"{FOLDER}/{name}.tif") as raster:
            moons.append(raster.read(1) / half_moon_lx)
            box = raster.bounds
    extent = (box.left, box.right, box.bottom, box.top)
    aspect = 1 / math.cos(math.radians((box.top + box.bottom) / 2))
    figure, axes = pyplot.subplots(1, 3, figsize=(14, 4.3), layout="constrained", sharey=True)
    places = [place for place in ask("GET", f"{API}/scenes/demo/places").json()
              if box.left + 0.1 < place["longitude_deg"] < box.right - 0.2 and box.bottom + 0.1 < place["latitude_deg"] < box.top - 0.1]
    light, parts = colors.LogNorm(3e-3, 1), colors.LogNorm(0.5, 2)
    drawn = [(moons[0], "level, under an open sky", "magma", light),
             (moons[1], "as it slopes, behind its mountains", "magma", light),
             (moons[1] / moons[0], "the second in parts of the first", "RdBu_r", parts)]
    for axis, (values, title, colormap, norm) in zip(axes, drawn):
        image = axis.imshow(values, extent=extent, aspect=aspect, cmap=colormap, norm=norm, interpolation="nearest")
        for place in places[:7] if norm is light else []:
            axis.annotate(place["name"], (place["longitude_deg"], place["latitude_deg"]), color="white", fontsize=8,
                          xytext=(4, 4), textcoords="offset points")
        axis.set_title(title, fontsize=11)
        axis.set_xlabel("longitude, degrees")
        if axis is axes[1]:
            figure.colorbar(image, ax=axes[:2], label=f"half Moons {altitude_deg:.0f}° up ({1e3 * half_moon_lx:.0f} mlx)", shrink=0.9)
    axes[0].set_ylabel("latitude, degrees")
    figure.suptitle("Ground in the sky's artificial light, the demo", fontsize=12)
    ratio = figure.colorbar(image, ax=axes[2], shrink=0.9)
    ratio.ax.minorticks_off()
    ratio.set_ticks([0.5, 0.7, 1, 1.4, 2], labels=["0.5", "0.7", "1", "1.4", "2"])
    figure.savefig(f"{FOLDER}/slopes.png", dpi=90)


def ground():
    """What level ground has of the demo's lamps by way of a clear sky and of clouds, in units of half a Moon."""
    import time

    from matplotlib import colors, pyplot

    half_moon_lx, altitude_deg = half_moon()
    figure, axes = pyplot.subplots(1, 2, figsize=(13.5, 5.2), layout="constrained", sharey=True)
    for axis, clouds, title in zip(axes, ["none", "1500"], ["clear", "under closed clouds at 1 500 m (grey: ground at them)"]):
        query = {"measure": "horizontal", "clouds": clouds}
        while (file := requests.get(f"{API}/scenes/demo/layers/brightness.tif", params=query, timeout=300)).status_code in (202, 503):
            time.sleep(2)
        with rasterio.open(io.BytesIO(file.content)) as raster:
            moons, box = raster.read(1) / half_moon_lx, raster.bounds
        extent = (box.left, box.right, box.bottom, box.top)
        axis.set_facecolor("#777777")
        image = axis.imshow(moons, extent=extent, aspect=1.43, cmap="magma", norm=colors.LogNorm(1e-4, 10))
        lines = axis.contour(moons, levels=[1e-2, 1e-1, 1], extent=extent, origin="upper", colors="white", linewidths=0.6)
        axis.clabel(lines, fmt=lambda level: f"{level:g}", fontsize=7)
        for place in ask("GET", f"{API}/scenes/demo/places").json()[:9]:
            axis.annotate(place["name"], (place["longitude_deg"], place["latitude_deg"]), color="white", fontsize=8,
                          xytext=(5, 5), textcoords="offset points")
        axis.set(xlabel="longitude, degrees", title=title)
    axes[0].set_ylabel("latitude, degrees")
    figure.suptitle(f"Level ground in the sky's artificial light, by that of a half Moon {altitude_deg:.0f}° up ({1e3 * half_moon_lx:.0f} mlx)")
    figure.colorbar(image, ax=axes, label="half Moons", shrink=0.8)
    figure.savefig(f"{FOLDER}/ground.png", dpi=90)


def main():
    alone = sys.argv[4:]
    if not alone or "gallery" in alone:
        gallery()
    if not alone or "night" in alone:
        night()
    if not alone or "land" in alone:
        land()
    if not alone or "water" in alone:
        water()
    if not alone or "clouds" in alone:
        clouds()
    if not alone or "natural" in alone:
        natural()
    if not alone or "ground" in alone:
        ground()
    if "slopes" in alone:
        slopes()
    if not alone or "swaps" in alone:
        swaps()
    if alone:
        return
    scale = {"min": 3e-6, "max": 3e-3, "width": 640, "height_px": 240}
    region = "20,1;65,1;65,25;20,25"
    sheet("whose-light", [[
        (map_of("influence", **SITE, **OPEN), "whose light is at the zenith"),
        (map_of("influence", **SITE, **OPEN, measure="region", region=region), "and in the glow of the north-east"),
        (sky(**scale), "the sky there"),
    ]])
    dimmed = scenario(polygon(NAIROBI, factor=0.3))
    town = {"points": [[36.45, -1.95], [36.47, -1.95]], "radius_m": 2500}
    new = scenario({"brush": town, "add_radiance_nw_cm2_sr": 60})
    today = zenith()
    both = scenario({"brush": town, "add_radiance_nw_cm2_sr": 60}, base=dimmed)
    ratio = lambda id: f"zenith {100 * (zenith(id) / today - 1):+.0f} %"
    lamps = {
        "sodium": scenario(polygon(KENYA, lamp="hps")),
        "amber": scenario(polygon(KENYA, lamp="pc_amber")),
        "4000 K": scenario(polygon(KENYA, lamp="led_4000k")),
        "4000 K, shielded": scenario(polygon(KENYA, lamp="led_4000k", emission="shielded")),
    }
    colours = {"style": "realistic", "exposure": 2.5, "projection": "fisheye", "width": 420, "height_px": 420, "sky": "artificial"}
    sheet("what-if", [
        [(sky(**scale), "today"), (sky(dimmed, **scale), f"Nairobi dimmed to 30 %: {ratio(dimmed)}")],
        [(sky(new, **scale), f"a new town in the south: {ratio(new)}"), (sky(both, **scale), f"both: {ratio(both)}")],
        [(sky(id, **colours), f"{name}: {ratio(id)}") for name, id in lamps.items()],
    ])
    near = plan(method="target", sites=[{**SITE, "reduce_by": 0.3}])
    # The city's middle may stay as it is, and no light may lose more than 80 %.
    ring = [[36.79, -1.31], [36.86, -1.31], [36.86, -1.26], [36.79, -1.26], [36.79, -1.31]]
    far = plan(method="target", max_cut=0.8, sites=[{**SITE, "reduce_by": 0.3}],
               protect={"type": "Polygon", "coordinates": [ring]})
    threshold = plan(method="threshold", site=SITE, measure="norm", q_a="p98", q_b="p99.5", gamma=0.8)
    rows = []
    for name, made in (("least flux that must go", near), ("the same, no light by more than 80 %, the centre not at all", far),
                       ("the 2 % most influential by norm", threshold)):
        site = made["sites"][0]
        share = 100 * made["flux_removed_share"]
        by = f"{-100 * site['reduced_by']:.0f} %" if made["method"] == "target" else f"{100 * (zenith(made['id']) / today - 1):.0f} %"
        rows.append([
            (plan_map(made["id"]), f"{made['dimmed_pixels']} pixels, {share:.2f} % of the flux"),
            (sky(made["id"], **scale), f"{name}: zenith {by}"),
        ])
        print(name, made["id"], made["dimmed_pixels"], share, site["before"], site["after"], site["target"])
    sheet("what-to-dim", rows)
    print("today", today, {name: zenith(id) / today for name, id in {**lamps, "dimmed": dimmed, "new": new, "both": both}.items()})


if __name__ == "__main__":
    main()
