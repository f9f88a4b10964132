// How fine a sky is drawn while it moves: as fine as the machine manages thirty times a second.

/** Device pixels of a CSS pixel, finest first. */
const SCALES = [2, 1.5, 1, 0.75, 0.5, 0.35] as const;
/** Slower than this is made coarser, and what is drawn as fast as the screen goes may be made finer. */
const SLOW_MS = 31;
const FAST_MS = 19;
/** Frames that a step down and a step up are decided by. */
const FRAMES_DOWN = 4;
const FRAMES_UP = 30;
/** A longer pause is no frame; two of them in a row, neither very long, are frames of a machine that is very slow. */
const PAUSE_MS = 400;
const VERY_SLOW_MS = 4000;
/** A larger picture begins coarser than by one pixel a CSS pixel, in device pixels: a card has made it finer in half a second. */
const FIRST_PIXELS = 1.6e6;

export class Pace {
  private step = SCALES.indexOf(1);
  /** No finer than this: it was tried, and was too slow. */
  private finest = 0;
  private lastMs: number | null = null;
  private wasVerySlow = false;
  private isBegun = false;
  private times: number[] = [];

  /** Device pixels of a CSS pixel of the next frame, on a screen that has so many; the picture has `cssPixels`. */
  scale(pixelsPerCssPx: number, cssPixels: number): number {
    if (!this.isBegun) {
      this.isBegun = true;
      const fits = SCALES.findIndex((scale) => scale <= 1 && scale ** 2 * cssPixels <= FIRST_PIXELS);
      this.step = fits < 0 ? SCALES.length - 1 : fits;
    }
    return Math.min(SCALES[this.step] ?? 1, pixelsPerCssPx);
  }

  /** A frame was begun. */
  frame(nowMs: number): void {
    const tookMs = this.lastMs === null ? Infinity : nowMs - this.lastMs;
    this.lastMs = nowMs;
    if (tookMs > PAUSE_MS) {
      this.times = [];
      const isVerySlow = tookMs < VERY_SLOW_MS;
      if (isVerySlow && this.wasVerySlow) {
        this.finest = Math.min(this.step + 1, SCALES.length - 1);
        this.moveTo(this.finest);
      }
      this.wasVerySlow = isVerySlow;
      return;
    }
    this.wasVerySlow = false;
    this.times.push(tookMs);
    const { times } = this;
    const mean = times.reduce((sum, ms) => sum + ms, 0) / times.length;
    if (times.length >= FRAMES_DOWN && mean > SLOW_MS) {
      this.finest = Math.min(this.step + 1, SCALES.length - 1);
      this.moveTo(this.finest);
    } else if (times.length >= FRAMES_UP) {
      this.moveTo(mean < FAST_MS ? Math.max(this.step - 1, this.finest) : this.step);
    }
  }

  private moveTo(step: number): void {
    this.step = step;
    this.times = [];
  }
}
