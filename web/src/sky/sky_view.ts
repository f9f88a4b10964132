// The picture of the sky: canvas, frame, pointer and keyboard readout.

import type { NamedPlace } from "../api/types.ts";
import type { Place } from "../state.ts";
import { make } from "../ui/dom.ts";
import type { ColourMapName } from "./colour_maps.ts";
import type { SkyGrid, SkyKind, SkySample } from "./grid.ts";
import { draw_cross, draw_curve, draw_frame, draw_horizon, draw_towns } from "./overlay.ts";
import { paint_sky } from "./paint.ts";
import { angle_deg, region_from_trail, type Region } from "./region.ts";
import { towns_on_horizon } from "./towns.ts";
import { equirectangular, fisheye, type Plot, type Projection, type ProjectionName, type SkyDirection } from "./projection.ts";

export interface SkyLook {
  projection: ProjectionName;
  sky: SkyKind;
  colours: ColourMapName;
  /** A part of the sky that is marked. */
  region: Region | null;
}

export interface SkyViewEvents {
  pointed: (sample: SkySample | null) => void;
  /** A curve was closed, or drawing ended without one. */
  drawn: (region: Region | null) => void;
}

/** Room for a town's name along the horizon. */
const NAME_PX = 74;
/** Nearer to the corner before, a corner set by keyboard closes the curve. */
const SAME_DEG = 0.5;

/** Finer pictures than this cost time and show nothing more: the grid has 256 × 64 samples. */
const FINEST_PIXELS_PER_CSS_PX = 2;

const MARGIN = { strip: { left: 34, right: 8, top: 8, bottom: 28 }, disc: 26 };

export class SkyView {
  private readonly picture = document.createElement("canvas");
  private readonly overlay = document.createElement("canvas");
  private grid: SkyGrid | null = null;
  private projection: Projection | null = null;
  private plot: Plot = { left_px: 0, top_px: 0, width_px: 1, height_px: 1 };
  private named: { place: Place; places: readonly NamedPlace[] } | null = null;
  private pointed: SkyDirection | null = null;
  /** What is drawn so far; null while nothing is to be drawn. */
  private trail: SkyDirection[] | null = null;

  constructor(
    private readonly container: HTMLElement,
    private look: SkyLook,
    private readonly events: SkyViewEvents,
  ) {
    this.picture.className = "sky-picture";
    this.picture.setAttribute("aria-hidden", "true");
    this.overlay.className = "sky-overlay";
    this.overlay.tabIndex = 0;
    this.overlay.setAttribute("role", "application");
    this.overlay.setAttribute("aria-roledescription", "sky picture");
    this.overlay.setAttribute("aria-describedby", "sky-readout");
    this.overlay.setAttribute("aria-label", "Sky in false colour. Arrow keys move the readout, Escape ends it.");
    this.container.append(make("div", "sky-canvases", this.picture, this.overlay));
    this.overlay.addEventListener("pointermove", (event) => {
      this.point_at(event);
      if (event.buttons !== 0) this.draw_on();
    });
    this.overlay.addEventListener("pointerdown", (event) => {
      this.point_at(event);
      if (this.trail === null) return;
      this.overlay.setPointerCapture(event.pointerId);
      this.trail = [];
      this.draw_on();
    });
    this.overlay.addEventListener("pointerup", () => this.close_curve());
    this.overlay.addEventListener("pointerleave", (event) => {
      // A finger that was lifted leaves its readout; a mouse that goes away takes it along.
      if (event.pointerType === "mouse") this.set_pointed(null);
    });
    this.overlay.addEventListener("keydown", (event) => this.key_pressed(event));
    new ResizeObserver(() => this.draw()).observe(this.container);
  }

  show(grid: SkyGrid | null): void {
    this.grid = grid;
    this.draw();
    this.announce();
  }

  set_look(look: SkyLook): void {
    this.look = look;
    this.draw();
    this.announce();
  }

  /** The place below this sky and the towns around it, whose names stand where their glow is. */
  set_towns(place: Place | null, places: readonly NamedPlace[]): void {
    this.named = place === null ? null : { place, places };
    this.draw();
  }

  /** The next curve by hand marks a part of the sky. */
  set_drawing(on: boolean): void {
    this.trail = on ? [] : null;
    this.overlay.classList.toggle("drawing", on);
    if (on) this.overlay.focus();
    this.draw_marks();
  }

  /** Where a direction lies, CSS pixels inside the canvas; null before anything is drawn. */
  point_of(direction: SkyDirection): { x_px: number; y_px: number } | null {
    return this.projection?.point_from_direction(direction) ?? null;
  }

  private draw(): void {
    const width_px = Math.floor(this.container.clientWidth);
    const height_px = Math.floor(this.container.clientHeight);
    if (width_px < 40 || height_px < 40) return;
    const scale = Math.min(window.devicePixelRatio || 1, FINEST_PIXELS_PER_CSS_PX);
    for (const canvas of [this.picture, this.overlay]) {
      canvas.width = Math.round(width_px * scale);
      canvas.height = Math.round(height_px * scale);
    }
    if (this.look.projection === "fisheye") {
      const m = MARGIN.disc;
      this.plot = { left_px: m, top_px: m, width_px: width_px - 2 * m, height_px: height_px - 2 * m };
      this.projection = fisheye(this.plot);
    } else {
      const m = MARGIN.strip;
      this.plot = { left_px: m.left, top_px: m.top, width_px: width_px - m.left - m.right, height_px: height_px - m.top - m.bottom };
      this.projection = equirectangular(this.plot);
    }
    const context = this.picture.getContext("2d");
    if (context === null) return;
    if (this.grid !== null) {
      const image = context.createImageData(this.picture.width, this.picture.height);
      paint_sky(image, this.grid, this.look.sky, this.look.colours, this.projection, scale);
      context.putImageData(image, 0, 0);
    }
    context.setTransform(scale, 0, 0, scale, 0, 0);
    draw_frame(context, this.projection, this.plot);
    if (this.grid !== null) {
      draw_horizon(context, this.projection, this.grid);
      if (this.named !== null) draw_towns(context, this.projection, this.plot, this.grid, towns_on_horizon(this.named.place, this.named.places, this.apart_deg()));
    }
    context.setTransform(1, 0, 0, 1, 0, 0);
    this.draw_marks();
  }

  /** Names nearer to each other than this would overlap. */
  private apart_deg(): number {
    const around_px = this.look.projection === "fisheye" ? Math.PI * Math.min(this.plot.width_px, this.plot.height_px) : this.plot.width_px;
    return Math.min((NAME_PX / around_px) * 360, 90);
  }

  /** The curve and the cross. */
  private draw_marks(): void {
    const context = this.overlay.getContext("2d");
    if (context === null || this.projection === null) return;
    context.clearRect(0, 0, this.overlay.width, this.overlay.height);
    if (this.grid === null) return;
    const scale = Math.min(window.devicePixelRatio || 1, FINEST_PIXELS_PER_CSS_PX);
    context.setTransform(scale, 0, 0, scale, 0, 0);
    if (this.trail !== null) draw_curve(context, this.projection, this.trail, false);
    else if (this.look.region !== null) draw_curve(context, this.projection, this.look.region, true);
    if (this.pointed !== null) draw_cross(context, this.projection, this.grid.nearest(this.pointed.azimuth_deg, this.pointed.elevation_deg));
    context.setTransform(1, 0, 0, 1, 0, 0);
  }

  private point_at(event: PointerEvent): void {
    this.set_pointed(this.projection?.direction_from_point(event.offsetX, event.offsetY) ?? null);
  }

  private set_pointed(direction: SkyDirection | null): void {
    this.pointed = direction;
    this.draw_marks();
    this.announce();
  }

  /** The curve goes on to where is pointed. */
  private draw_on(): void {
    if (this.trail === null || this.pointed === null) return;
    this.trail.push(this.pointed);
    this.draw_marks();
  }

  private close_curve(): void {
    if (this.trail === null || this.trail.length === 0) return;
    const region = region_from_trail(this.trail);
    // A click encloses nothing: drawing goes on.
    this.trail = [];
    if (region !== null) this.end_drawing(region);
    else this.draw_marks();
  }

  private end_drawing(region: Region | null): void {
    this.set_drawing(false);
    this.events.drawn(region);
  }

  /** Sets a corner at the cross; a second one in the same place closes the curve. */
  private set_corner(): void {
    if (this.trail === null || this.pointed === null) return;
    const before = this.trail.at(-1);
    if (before !== undefined && angle_deg(before, this.pointed) < SAME_DEG) this.close_curve();
    else this.draw_on();
  }

  private announce(): void {
    const { pointed, grid } = this;
    this.events.pointed(pointed === null || grid === null ? null : grid.nearest(pointed.azimuth_deg, pointed.elevation_deg));
  }

  private key_pressed(event: KeyboardEvent): void {
    const { grid } = this;
    if (grid === null) return;
    if (event.key === "Escape") {
      if (this.trail === null) this.set_pointed(null);
      else this.end_drawing(null);
      return;
    }
    if (event.key === "Enter" && this.trail !== null) {
      event.preventDefault();
      this.set_corner();
      return;
    }
    const steps = event.shiftKey ? 8 : 1;
    const moves: Record<string, [number, number]> = {
      ArrowLeft: [-1, 0],
      ArrowRight: [1, 0],
      ArrowUp: [0, 1],
      ArrowDown: [0, -1],
    };
    const move = moves[event.key];
    if (move === undefined) return;
    event.preventDefault();
    const from = this.pointed ?? { azimuth_deg: 180, elevation_deg: 45 };
    const nearest = grid.nearest(from.azimuth_deg, from.elevation_deg);
    const azimuth_deg = (nearest.azimuth_deg + move[0] * steps * grid.azimuth_step_deg + 360) % 360;
    const last_deg = grid.elevation_first_deg + (grid.elevation_count - 1) * grid.elevation_step_deg;
    const elevation_deg = Math.min(
      Math.max(nearest.elevation_deg + move[1] * steps * grid.elevation_step_deg, grid.elevation_first_deg),
      last_deg,
    );
    this.set_pointed({ azimuth_deg, elevation_deg });
  }
}
