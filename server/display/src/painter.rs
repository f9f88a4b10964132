//! From light to the colours of a style.

use crate::{
    colormap::TABLE_LEN,
    colour_bins::ColourBins,
    error::DisplayError,
    eye::{Eye, Seen, dazzle},
    glare::{Glare, Halo},
    ground::{DARK_TERRAIN_RGB, TERRAIN_RGB},
    ink::Ink,
    legend::Beyond,
    options::{PictureOptions, Style},
    realistic::ToneMap,
};
use rayon::prelude::*;
use skyglow_physics::{
    Direction, Response, SKY_RESPONSES, SeenSky,
    sampler::{Sampler, taps},
};

/// Colours a sky.
pub(crate) enum Painter<'a> {
    FalseColour {
        luminance_cd_m2: Vec<f64>,
        table: Box<[[u8; 3]; TABLE_LEN]>,
        bins: Box<ColourBins>,
        ends_cd_m2: (f64, f64),
    },
    Eye {
        sampler: Sampler<'a, 4>,
        glare: Box<Glare>,
        halos: Vec<Halo>,
        /// Linear sRGB that the eye makes of every sample of the grid: between them colours are interpolated.
        linear: Vec<[f32; 3]>,
        eye: Box<Eye>,
    },
    Realistic {
        sampler: Sampler<'a>,
        tone_map: Box<ToneMap>,
    },
}

impl<'a> Painter<'a> {
    pub(crate) fn new(
        seen: &'a SeenSky,
        response: &Response,
        options: &PictureOptions,
        halos: Vec<Halo>,
    ) -> Result<Self, DisplayError> {
        let plane =
            |of: &Response| seen.seen_by(of).ok_or_else(|| DisplayError::NotSeen { response: of.name() });
        Ok(match options.style {
            Style::FalseColour { colormap, range } => {
                let (dark, bright) = range.luminance_ends_cd_m2();
                Painter::FalseColour {
                    luminance_cd_m2: plane(response)?.iter().map(|value| f64::from(*value)).collect(),
                    table: Box::new(colormap.table()),
                    // With room for rounding: the ends themselves are inside.
                    ends_cd_m2: (dark * (1.0 - 1e-9), bright * (1.0 + 1e-9)),
                    bins: Box::new(ColourBins::new((dark, bright))),
                }
            }
            Style::Eye { exposure_ev, adaptation_cd_m2 } => {
                let [x, y, z, scotopic] = SKY_RESPONSES.each_ref().map(plane);
                let planes = [x?, y?, z?, scotopic?];
                let glare = Box::new(Glare::new(planes, &halos));
                let eye = Box::new(Eye::new(exposure_ev, adaptation_cd_m2.unwrap_or(glare.mean_cd_m2)));
                let of_sample = |at: usize| -> [f32; 3] {
                    let veil = glare.veil[at].map(f64::from);
                    let seen: Seen = std::array::from_fn(|i| f64::from(planes[i][at]) + veil[i]);
                    eye.linear(seen, dazzle(seen[1], veil[1])).map(|channel| channel as f32)
                };
                let linear = (0..planes[0].len()).into_par_iter().map(of_sample).collect();
                Painter::Eye { sampler: Sampler::new(planes), glare, halos, linear, eye }
            }
            Style::Realistic { exposure_ev } => {
                let [x, y, z, _] = &SKY_RESPONSES;
                Painter::Realistic {
                    sampler: Sampler::new([plane(x)?, plane(y)?, plane(z)?]),
                    tone_map: Box::new(ToneMap::new(exposure_ev)),
                }
            }
        })
    }

    /// The colour of a direction, in colours of light with that of a body before it; notes in `beyond` what false colours cannot tell
    /// apart from their ends.
    pub(crate) fn ink<I: Ink>(
        &self,
        direction: Direction,
        body: Option<&Seen>,
        beyond: &mut Beyond,
    ) -> Option<I> {
        match self {
            Painter::FalseColour { luminance_cd_m2, table, bins, ends_cd_m2 } => {
                let taps = taps(direction)?;
                let luminance: f64 =
                    (0..4).map(|tap| taps.weight[tap] * luminance_cd_m2[taps.offset[tap]]).sum();
                beyond.note(luminance, *ends_cd_m2);
                Some(I::of_bytes(table[bins.entry(luminance)]))
            }
            Painter::Eye { sampler, glare, halos, linear, eye } => {
                let taps = taps(direction)?;
                let mut near = halos.iter().filter_map(|halo| halo.near(direction)).peekable();
                if body.is_some() || near.peek().is_some() {
                    let (mut light, mut veil) = (sampler.values(direction)?, glare.at(&taps));
                    near.for_each(|more| veil.iter_mut().zip(more).for_each(|(veil, more)| *veil += more));
                    let body = body.copied().unwrap_or_default();
                    let dazzled = dazzle(light[1] + veil[1], veil[1]);
                    light.iter_mut().enumerate().for_each(|(i, light)| *light += veil[i] + body[i]);
                    return Some(I::of(eye.linear(light, dazzled), share(&body, &light), eye.bytes()));
                }
                let [a, b, c, d] = taps.offset.map(|at| linear[at]);
                let [of_a, of_b, of_c, of_d] = taps.weight.map(|weight| weight as f32);
                let channel = |i: usize| of_a * a[i] + of_b * b[i] + of_c * c[i] + of_d * d[i];
                Some(I::of(std::array::from_fn(|i| f64::from(channel(i))), 0.0, eye.bytes()))
            }
            Painter::Realistic { sampler, tone_map } => {
                let [x, y, z] = sampler.values(direction)?;
                let body = body.copied().unwrap_or_default();
                let light = [x + body[0], y + body[1], z + body[2], 0.0];
                let linear = tone_map.linear([light[0], light[1], light[2]]);
                Some(I::of(linear, share(&body, &light), tone_map.bytes()))
            }
        }
    }

    /// The colour of light from the ground in a direction, with that of lamps on it, behind the veil of the sky above it; None in false
    /// colours.
    pub(crate) fn ground_ink<I: Ink>(&self, direction: Direction, ground: &Seen, lamps: &Seen) -> Option<I> {
        let mut light: Seen = std::array::from_fn(|i| ground[i] + lamps[i]);
        match self {
            Painter::FalseColour { .. } => None,
            Painter::Eye { glare, halos, eye, .. } => {
                let above = Direction { elevation_rad: direction.elevation_rad.max(0.0), ..direction };
                let mut veil = glare.at(&taps(above)?);
                for halo in halos {
                    let more = halo.near(direction).unwrap_or_default();
                    // Of Moon and Sun the veil is as far from them as the ground is, not as its horizon.
                    let (here, there) = (halo.far(direction), halo.far(above));
                    for (i, veil) in veil.iter_mut().enumerate() {
                        *veil = (*veil + here[i] - there[i]).max(0.0) + more[i];
                    }
                }
                light.iter_mut().zip(veil).for_each(|(light, veil)| *light += veil);
                let linear = eye.linear(light, dazzle(light[1], veil[1]));
                Some(I::of(linear, share(lamps, &light), eye.bytes()))
            }
            Painter::Realistic { tone_map, .. } => {
                let linear = tone_map.linear([light[0], light[1], light[2]]);
                Some(I::of(linear, share(lamps, &light), tone_map.bytes()))
            }
        }
    }

    /// Whether stars are shown: false colours show none.
    pub(crate) fn has_stars(&self) -> bool {
        !matches!(self, Painter::FalseColour { .. })
    }

    /// Whether a line is drawn along the ground; by night it ends where the stars do.
    pub(crate) fn has_skyline(&self) -> bool {
        !matches!(self, Painter::Eye { .. })
    }

    /// The colour of ground that hides the sky.
    pub(crate) fn terrain_rgb(&self) -> [u8; 3] {
        if matches!(self, Painter::Eye { .. }) { DARK_TERRAIN_RGB } else { TERRAIN_RGB }
    }
}

/// How much of all light is that of lights, 0..=1, by luminance.
fn share(lights: &Seen, all: &Seen) -> f64 {
    if all[1] > 0.0 { (lights[1] / all[1]).clamp(0.0, 1.0) } else { 0.0 }
}
