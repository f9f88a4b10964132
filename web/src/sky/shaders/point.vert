// A star or planet as a square around where it is seen.

/** Azimuth and elevation. */
layout(location = 0) in vec2 direction;
/** X, Y, Z and scotopic illuminance, lx. */
layout(location = 1) in vec4 illuminance;
/** X, Y, Z and scotopic luminance of the sky there: the square is small beside its samples. */
layout(location = 2) in vec4 sky;
/** How much more the eye is adapted to there. */
layout(location = 3) in float dazzle_there;
flat out vec4 peak;
flat out vec4 before;
flat out float dazzled;
flat out float blur_px;
flat out float size_px;

/** Width of a star in the dark-adapted eye, standard deviation of a Gaussian. */
const float EYE_BLUR_RAD = 1.1e-3;
const float MIN_BLUR_PX = 0.6;
/** Light below this is not drawn, cd m-2: a tenth of the darkest sky. */
const float DARK_CD_M2 = 2e-5;
/** Nor what adds less than this part to the sky: no display shows it. */
const float UNSEEN_PART = 0.01;

void main() {
  blur_px = max(EYE_BLUR_RAD / pixel_rad(), MIN_BLUR_PX);
  peak = illuminance / (2.0 * PI * EYE_BLUR_RAD * EYE_BLUR_RAD);
  before = sky;
  dazzled = dazzle_there;
  float faintest = max(DARK_CD_M2, UNSEEN_PART * max(sky.y, sky.w));
  float brightest = max(max(peak.y, peak.w), faintest);
  size_px = 2.0 * ceil(blur_px * sqrt(2.0 * log(brightest / faintest)) + 0.5);
  gl_Position = clip_position(direction);
  gl_PointSize = size_px;
}
