// The picture of the sky: canvas, frame, pointer and keyboard readout.

import type { NamedPlace } from "../api/types.ts";
import { words } from "../language/words.ts";
import type { Place } from "../state.ts";
import { make } from "../ui/dom.ts";
import type { SkyGrid, SkySample } from "./grid.ts";
import { draw_cross, draw_curve, draw_frame, draw_horizon, draw_towns } from "./overlay.ts";
import { paint_sky, type PictureLook } from "./paint.ts";
import { region_from_trail, type Region } from "./region.ts";
import { towns_on_horizon } from "./towns.ts";
import { equirectangular, fisheye, perspective, type Gaze, type Plot, type Projection, type ProjectionName, type SkyDirection } from "./projection.ts";

export interface SkyLook extends PictureLook {
  projection: ProjectionName;
  /** A part of the sky that is marked. */
  region: Region | null;
  /** Where the perspective looks; null: towards the brightest light. */
  gaze: Gaze | null;
}

export interface SkyViewEvents {
  pointed: (sample: SkySample | null) => void;
  /** A curve was closed, or drawing ended without one. */
  drawn: (region: Region | null) => void;
  /** Somebody looks elsewhere. */
  gazed: (gaze: Gaze) => void;
}

const FIELD_DEG = { initial: 55, least: 15, most: 110 };
/** How far the eye is raised from the brightest light, which is low. */
const INITIAL_ELEVATION_DEG = 17;
const ZOOM_STEP = 1.15;
/** The server draws no wider perspective. */
const WIDEST_FOV_DEG = 150;

/** Room for a town's name along the horizon. */
const NAME_PX = 74;

/** Finer pictures than this cost time and show nothing more: the grid has 256 × 64 samples. */
const FINEST_PIXELS_PER_CSS_PX = 2;

const MARGIN = { view: 8, strip: { left: 34, right: 8, top: 8, bottom: 28 }, disc: 26 };

export class SkyView {
  private readonly picture = document.createElement("canvas");
  private readonly overlay = document.createElement("canvas");
  private grid: SkyGrid | null = null;
  private other: SkyGrid | null = null;
  /** Where the other sky ends, as a part of the picture's width. */
  private split = 0.5;
  private projection: Projection | null = null;
  private plot: Plot = { left_px: 0, top_px: 0, width_px: 1, height_px: 1 };
  private dragged_from: { x_px: number; y_px: number } | null = null;
  private drawing_soon = false;
  /** Where every pointer that is down was last. */
  private readonly fingers = new Map<number, { x_px: number; y_px: number }>();
  private place: Place | null = null;
  private places: readonly NamedPlace[] = [];
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
    this.overlay.setAttribute("aria-roledescription", words().sky.picture_kind);
    this.overlay.setAttribute("aria-describedby", "sky-readout");
    this.overlay.setAttribute("aria-label", words().sky.picture);
    this.container.append(make("div", "sky-canvases", this.picture, this.overlay));
    this.overlay.addEventListener("pointermove", (event) => {
      if (this.pinch(event) || this.turn(event)) return;
      this.point_at(event);
      if (event.buttons !== 0) this.draw_on();
    });
    this.overlay.addEventListener("pointerdown", (event) => {
      this.fingers.set(event.pointerId, { x_px: event.offsetX, y_px: event.offsetY });
      // A second finger zooms; other buttons do nothing.
      if (!event.isPrimary || event.button !== 0) return;
      this.point_at(event);
      if (this.trail === null && this.look.projection !== "perspective") return;
      this.overlay.setPointerCapture(event.pointerId);
      if (this.trail === null) {
        this.dragged_from = { x_px: event.offsetX, y_px: event.offsetY };
        return;
      }
      this.trail = [];
      this.draw_on();
    });
    this.overlay.addEventListener("pointerup", (event) => {
      this.fingers.delete(event.pointerId);
      if (!event.isPrimary) return;
      this.end_turn();
      this.close_curve();
    });
    this.overlay.addEventListener("pointercancel", (event) => {
      this.fingers.delete(event.pointerId);
      this.end_turn();
      if (this.trail !== null) this.trail = [];
      this.draw_marks();
    });
    this.overlay.addEventListener(
      "wheel",
      (event) => {
        if (this.look.projection !== "perspective") return;
        event.preventDefault();
        this.zoom(event.deltaY > 0 ? ZOOM_STEP : 1 / ZOOM_STEP);
      },
      { passive: false },
    );
    this.overlay.addEventListener("pointerleave", (event) => {
      // A finger that was lifted leaves its readout; a mouse that goes away takes it along.
      if (event.pointerType === "mouse") this.set_pointed(null);
    });
    this.overlay.addEventListener("keydown", (event) => this.key_pressed(event));
    new ResizeObserver(() => this.draw()).observe(this.container);
  }

  /** Shows a sky; left of the split another one, where there is one. */
  show(grid: SkyGrid | null, other: SkyGrid | null = null): void {
    this.grid = grid;
    this.other = other;
    this.draw();
    this.announce();
  }

  set_split(part: number): void {
    this.split = part;
    if (this.other !== null) this.draw_soon();
  }

  /** The look may come with more than that; what is drawn already is not drawn again. */
  set_look({ projection, sky, colours, exposure_ev, region, gaze }: SkyLook): void {
    const before = this.look;
    this.look = { projection, sky, colours, exposure_ev, region, gaze };
    if (Object.entries(this.look).every(([name, value]) => before[name as keyof SkyLook] === value)) return;
    this.draw();
    this.announce();
  }

  /** The place below this sky and the towns around it, whose names stand where their glow is. */
  set_towns(place: Place | null, places: readonly NamedPlace[]): void {
    if (place === this.place && places === this.places) return;
    this.place = place;
    this.places = places;
    this.draw();
  }

  /** What a perspective shows, as the API takes it; null for the others. */
  view(): { azimuth: number; elevation: number; fov: number } | null {
    if (this.look.projection !== "perspective") return null;
    const { azimuth_deg, elevation_deg, field_deg } = this.gaze();
    const half_rad = Math.atan((Math.tan((field_deg / 2) * (Math.PI / 180)) * this.plot.width_px) / this.plot.height_px);
    return { azimuth: +azimuth_deg.toFixed(1), elevation: +elevation_deg.toFixed(1), fov: Math.min(+((2 * half_rad * 180) / Math.PI).toFixed(1), WIDEST_FOV_DEG) };
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
    const scale = this.pixels_per_css_px();
    for (const canvas of [this.picture, this.overlay]) {
      canvas.width = Math.round(width_px * scale);
      canvas.height = Math.round(height_px * scale);
    }
    if (this.look.projection === "fisheye") {
      const m = MARGIN.disc;
      this.plot = { left_px: m, top_px: m, width_px: width_px - 2 * m, height_px: height_px - 2 * m };
      this.projection = fisheye(this.plot);
    } else if (this.look.projection === "perspective") {
      const m = MARGIN.view;
      this.plot = { left_px: m, top_px: m, width_px: width_px - 2 * m, height_px: height_px - 2 * m };
      this.projection = perspective(this.plot, this.gaze());
    } else {
      const m = MARGIN.strip;
      this.plot = { left_px: m.left, top_px: m.top, width_px: width_px - m.left - m.right, height_px: height_px - m.top - m.bottom };
      this.projection = equirectangular(this.plot);
    }
    const context = this.picture.getContext("2d");
    if (context === null) return;
    if (this.grid !== null) {
      const image = context.createImageData(this.picture.width, this.picture.height);
      paint_sky(image, this.grid, this.look, this.projection, scale);
      context.putImageData(image, 0, 0);
      if (this.other !== null) this.draw_other(context, this.other, this.projection, scale);
    }
    context.setTransform(scale, 0, 0, scale, 0, 0);
    draw_frame(context, this.projection, this.plot);
    if (this.grid !== null) {
      draw_horizon(context, this.projection, this.plot, this.grid);
      if (this.place !== null) draw_towns(context, this.projection, this.plot, this.field_deg(), this.grid, towns_on_horizon(this.place, this.places, this.apart_deg()));
    }
    context.setTransform(1, 0, 0, 1, 0, 0);
    this.draw_marks();
  }

  /** Names nearer to each other than this would overlap. */
  private apart_deg(): number {
    if (this.look.projection === "perspective") return (NAME_PX / this.plot.height_px) * this.gaze().field_deg;
    const around_px = this.look.projection === "fisheye" ? Math.PI * Math.min(this.plot.width_px, this.plot.height_px) : this.plot.width_px;
    return Math.min((NAME_PX / around_px) * 360, 90);
  }

  /** How much of the sky fits between the lower and the upper edge. */
  private field_deg(): number {
    return this.look.projection === "perspective" ? this.gaze().field_deg : 90;
  }

  /** While it is dragged, a picture comes soon rather than fine. */
  private pixels_per_css_px(): number {
    const screen = window.devicePixelRatio || 1;
    return Math.min(screen, this.dragged_from === null ? FINEST_PIXELS_PER_CSS_PX : 1);
  }

  private gaze(): Gaze {
    if (this.look.gaze !== null) return this.look.gaze;
    return { azimuth_deg: this.grid?.brightest().azimuth_deg ?? 180, elevation_deg: INITIAL_ELEVATION_DEG, field_deg: FIELD_DEG.initial };
  }

  /** Two fingers zoom; whether there are two. */
  private pinch({ pointerId, offsetX, offsetY }: PointerEvent): boolean {
    const before = this.fingers.get(pointerId);
    if (before === undefined) return false;
    const now = { x_px: offsetX, y_px: offsetY };
    this.fingers.set(pointerId, now);
    const other = [...this.fingers].find(([id]) => id !== pointerId)?.[1];
    if (other === undefined || this.look.projection !== "perspective") return false;
    const distance_px = (at: { x_px: number; y_px: number }) => Math.max(Math.hypot(at.x_px - other.x_px, at.y_px - other.y_px), 1);
    this.zoom(distance_px(before) / distance_px(now));
    this.dragged_from = null;
    return true;
  }

  /** The picture follows the pointer that holds it; whether one does. */
  private turn({ offsetX, offsetY }: PointerEvent): boolean {
    const from = this.dragged_from;
    if (from === null) return false;
    const gaze = this.gaze();
    const degrees_a_px = gaze.field_deg / this.plot.height_px;
    // Near the zenith a degree of azimuth is a short way.
    const around = degrees_a_px / Math.max(Math.cos((gaze.elevation_deg * Math.PI) / 180), 0.25);
    this.look_at({
      azimuth_deg: (gaze.azimuth_deg - (offsetX - from.x_px) * around + 720) % 360,
      elevation_deg: gaze.elevation_deg + (offsetY - from.y_px) * degrees_a_px,
      field_deg: gaze.field_deg,
    });
    this.dragged_from = { x_px: offsetX, y_px: offsetY };
    return true;
  }

  private end_turn(): void {
    if (this.dragged_from === null) return;
    this.dragged_from = null;
    this.draw();
    this.events.gazed(this.gaze());
  }

  private zoom(factor: number): void {
    const gaze = this.gaze();
    this.look_at({ ...gaze, field_deg: Math.min(Math.max(gaze.field_deg * factor, FIELD_DEG.least), FIELD_DEG.most) });
    this.events.gazed(this.gaze());
  }

  private look_at(gaze: Gaze): void {
    this.look = { ...this.look, gaze: { ...gaze, elevation_deg: Math.min(Math.max(gaze.elevation_deg, -10), 90) } };
    this.draw_soon();
  }

  /** Once in a frame, however often something moves in it. */
  private draw_soon(): void {
    if (this.drawing_soon) return;
    this.drawing_soon = true;
    requestAnimationFrame(() => {
      this.drawing_soon = false;
      this.draw();
    });
  }

  /** Looks at where the keyboard's cross went out of the picture. */
  private keep_cross_in_view(direction: SkyDirection): void {
    const point = this.point_of(direction);
    const { left_px, top_px, width_px, height_px } = this.plot;
    const inside = point !== null && point.x_px > left_px && point.x_px < left_px + width_px && point.y_px > top_px && point.y_px < top_px + height_px;
    if (this.look.projection !== "perspective" || inside) return;
    this.look_at({ ...direction, field_deg: this.gaze().field_deg });
    this.events.gazed(this.gaze());
  }

  /** The other sky lies left of the split, with a line between them. */
  private draw_other(context: CanvasRenderingContext2D, other: SkyGrid, projection: Projection, scale: number): void {
    const split_px = Math.round((this.plot.left_px + this.split * this.plot.width_px) * scale);
    if (split_px < 1) return;
    const image = context.createImageData(split_px, this.picture.height);
    paint_sky(image, other, this.look, projection, scale);
    context.putImageData(image, 0, 0);
    context.fillStyle = "#ffffff";
    context.fillRect(split_px - scale / 2, this.plot.top_px * scale, scale, this.plot.height_px * scale);
  }

  /** The curve and the cross. */
  private draw_marks(): void {
    const context = this.overlay.getContext("2d");
    if (context === null || this.projection === null) return;
    context.clearRect(0, 0, this.overlay.width, this.overlay.height);
    if (this.grid === null) return;
    const scale = this.pixels_per_css_px();
    context.setTransform(scale, 0, 0, scale, 0, 0);
    if (this.trail !== null) draw_curve(context, this.projection, this.plot, this.trail, false);
    else if (this.look.region !== null) draw_curve(context, this.projection, this.plot, this.look.region, true);
    if (this.pointed !== null) draw_cross(context, this.projection, this.grid.nearest(this.pointed.azimuth_deg, this.pointed.elevation_deg));
    context.setTransform(1, 0, 0, 1, 0, 0);
  }

  private point_at(event: PointerEvent): void {
    const direction = this.projection?.direction_from_point(event.offsetX, event.offsetY) ?? null;
    this.set_pointed(direction !== null && direction.elevation_deg < 0 ? null : direction);
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
    const is_same = before?.azimuth_deg === this.pointed.azimuth_deg && before.elevation_deg === this.pointed.elevation_deg;
    if (is_same) this.close_curve();
    else this.draw_on();
  }

  private announce(): void {
    const { pointed, grid } = this;
    this.events.pointed(pointed === null || grid === null ? null : grid.nearest(pointed.azimuth_deg, pointed.elevation_deg));
  }

  private key_pressed(event: KeyboardEvent): void {
    const { grid } = this;
    if (event.key === "Escape") {
      if (this.trail === null) this.set_pointed(null);
      else this.end_drawing(null);
      return;
    }
    if (grid === null) return;
    if (this.look.projection === "perspective" && (event.key === "+" || event.key === "-")) {
      this.zoom(event.key === "-" ? ZOOM_STEP : 1 / ZOOM_STEP);
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
    const ahead = this.look.projection === "perspective" ? this.gaze() : { azimuth_deg: 180, elevation_deg: 45 };
    const from = this.pointed ?? ahead;
    const nearest = grid.nearest(from.azimuth_deg, from.elevation_deg);
    const azimuth_deg = (nearest.azimuth_deg + move[0] * steps * grid.azimuth_step_deg + 360) % 360;
    const last_deg = grid.elevation_first_deg + (grid.elevation_count - 1) * grid.elevation_step_deg;
    const elevation_deg = Math.min(
      Math.max(nearest.elevation_deg + move[1] * steps * grid.elevation_step_deg, grid.elevation_first_deg),
      last_deg,
    );
    this.keep_cross_in_view({ azimuth_deg, elevation_deg });
    this.set_pointed({ azimuth_deg, elevation_deg });
  }
}
