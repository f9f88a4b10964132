// A curve that is being drawn over the sky, by pointer or corner by corner.

import type { SkyDirection } from "./projection.ts";
import { type Region, regionFromTrail } from "./region.ts";

export class RegionDrawing {
  private directions: SkyDirection[] | null = null;

  /** What is drawn so far; null while nothing is to be drawn. */
  get trail(): Region | null {
    return this.directions;
  }

  /** The next curve marks a region; or none does. */
  set(on: boolean): void {
    this.directions = on ? [] : null;
  }

  /** Begins the curve anew. */
  restart(): void {
    if (this.directions !== null) this.directions = [];
  }

  extend(direction: SkyDirection | null): void {
    if (direction !== null) this.directions?.push(direction);
  }

  /** Closes the curve; null where it encloses nothing, as a click does: then drawing goes on. */
  close(): Region | null {
    if (this.directions === null || this.directions.length === 0) return null;
    const region = regionFromTrail(this.directions);
    this.directions = [];
    return region;
  }

  /** Sets a corner; a second one in the same place closes the curve. */
  setCorner(direction: SkyDirection | null): Region | null {
    if (direction === null) return null;
    const before = this.directions?.at(-1);
    if (before?.azimuthDeg === direction.azimuthDeg && before.elevationDeg === direction.elevationDeg) return this.close();
    this.extend(direction);
    return null;
  }
}
