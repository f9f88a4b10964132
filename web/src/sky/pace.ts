// How fine a sky is drawn while it moves: as fine as the machine manages thirty times a second.

/** Device pixels of a CSS pixel, finest first. */
const SCALES = [2, 1.5, 1, 0.75, 0.5, 0.35] as const;
/** Slower than this is made coarser, and what is drawn as fast as the screen goes may be made finer. */
const SLOW_MS = 31;
const FAST_MS = 19;
/** Frames that a step down and a step up are decided by. */
const FRAMES_DOWN = 4;
const FRAMES_UP = 30;
/** A longer pause is no frame. */
const PAUSE_MS = 400;

export class Pace {
  private step = SCALES.indexOf(1);
  /** No finer than this: it was tried, and was too slow. */
  private finest = 0;
  private lastMs: number | null = null;
  private times: number[] = [];

  /** Device pixels of a CSS pixel of the next frame, on a screen that has so many. */
  scale(pixelsPerCssPx: number): number {
    return Math.min(SCALES[this.step] ?? 1, pixelsPerCssPx);
  }

  /** A frame was begun. */
  frame(nowMs: number): void {
    const tookMs = this.lastMs === null ? Infinity : nowMs - this.lastMs;
    this.lastMs = nowMs;
    if (tookMs > PAUSE_MS) {
      this.times = [];
      return;
    }
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
