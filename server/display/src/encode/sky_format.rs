//! A compact panorama for programs that draw skies themselves: logarithms of 16 bits as differences to the gradient of their neighbours
//! (the planar predictor of lossless JPEG, Wallace 1992), low and high bytes apart, so that any compression finds runs.

use crate::bodies::PointLight;
use skyglow_physics::{AZIMUTH_COUNT, Horizon, SeenSky};
use std::f64::consts::{FRAC_PI_2, TAU};

/// What the file begins with; the last byte is the version of the layout.
const SKY_MAGIC: [u8; 8] = *b"SKYGLOW\x01";
/// Steps of the logarithm in a factor of e: values are kept to half a step, 2.5e-4 of them.
pub const STEPS_PER_E: f64 = 2048.0;
/// Code of the brightest value of a plane: others reach 14 decades down from it.
const BRIGHTEST_CODE: u16 = u16::MAX;
/// Steps of a whole turn of azimuth, and of the way from the horizon to the zenith.
const ANGLE_STEPS: f64 = 65_536.0;

/// Values as steps of their logarithm: code 0 is darkness, code `c` is `lowest · exp((c − 1) / STEPS_PER_E)`.
#[derive(Clone, Debug, PartialEq)]
pub struct LogPlane {
    codes: Vec<u16>,
    /// The value of code 1.
    pub lowest: f64,
}

impl LogPlane {
    /// Of values that are at least 0, in their order. What is more than 14 decades below the brightest is darkness.
    pub fn of(values: impl Iterator<Item = f64> + Clone) -> Self {
        let brightest = values.clone().fold(0.0, f64::max);
        let code = |value: f64| {
            let below = (STEPS_PER_E * (brightest / value).ln()).round();
            if value > 0.0 && below < f64::from(BRIGHTEST_CODE) { BRIGHTEST_CODE - below as u16 } else { 0 }
        };
        let lowest = brightest * (f64::from(1 - i32::from(BRIGHTEST_CODE)) / STEPS_PER_E).exp();
        Self { codes: values.map(code).collect(), lowest }
    }

    /// Of every response of a sky, `[row][column]`. Hidden samples have the value of the lowest visible one of their column.
    pub fn of_sky(seen: &SeenSky, horizon: &Horizon) -> Vec<Self> {
        let filled = seen.without_ground(horizon);
        let plane = |place| Self::of(filled.plane(place).iter().map(|value| f64::from(*value)));
        (0..seen.responses().len()).map(plane).collect()
    }
}

/// Points of light, the brightest first, and their illuminance by response as [`LogPlane`]s.
#[derive(Clone, Debug, PartialEq)]
pub struct PointTable {
    points: Vec<PointLight>,
    /// X, photopic, Z and scotopic illuminance, lx.
    pub planes: [LogPlane; 4],
}

impl PointTable {
    /// Of points in any order.
    pub fn new(mut points: Vec<PointLight>) -> Self {
        points.sort_by(|a, b| b.illuminance_lx[1].total_cmp(&a.illuminance_lx[1]));
        let planes =
            std::array::from_fn(|i| LogPlane::of(points.iter().map(|point| point.illuminance_lx[i])));
        Self { points, planes }
    }

    /// How many.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }
}

/// The file: `SKYGLOW` with the version 1, the header's length (u32, little-endian) and the header, then two bytes a sample of each group of planes,
/// then the points. In a group, planes after the second (photopic) one and the first are stored as differences to that one.
pub fn encode_sky(header: &[u8], groups: &[Vec<LogPlane>], points: &PointTable) -> Vec<u8> {
    let mut file = SKY_MAGIC.to_vec();
    file.extend_from_slice(&(header.len() as u32).to_le_bytes());
    file.extend_from_slice(header);
    groups.iter().for_each(|planes| put_group(&mut file, planes, AZIMUTH_COUNT));
    let azimuths = points.points.iter().map(|point| {
        let turns = point.direction.azimuth_rad / TAU;
        ((turns - turns.floor()) * ANGLE_STEPS).round() as u32 as u16
    });
    let elevations = points
        .points
        .iter()
        .map(|point| (point.direction.elevation_rad / FRAC_PI_2 * ANGLE_STEPS).clamp(0.0, 65_535.0) as u16);
    put_bytes(&mut file, azimuths);
    put_bytes(&mut file, elevations);
    put_group(&mut file, &points.planes, points.len().max(1));
    file
}

/// Planes of `width` columns, of which the second is the one that others are compared with.
fn put_group(file: &mut Vec<u8>, planes: &[LogPlane], width: usize) {
    for (place, plane) in planes.iter().enumerate() {
        let base = (place != 1).then(|| planes.get(1)).flatten();
        let above = |at: usize| plane.codes[at].wrapping_sub(base.map_or(0, |base| base.codes[at]));
        let differences = (0..plane.codes.len()).map(|at| {
            let (left, low) = (!at.is_multiple_of(width), at >= width);
            let predicted = match (left, low) {
                (true, true) => {
                    above(at - 1).wrapping_add(above(at - width)).wrapping_sub(above(at - width - 1))
                }
                (true, false) => above(at - 1),
                (false, true) => above(at - width),
                (false, false) => 0,
            };
            let difference = above(at).wrapping_sub(predicted) as i16;
            // Small ones of either sign become small numbers.
            ((difference << 1) ^ (difference >> 15)) as u16
        });
        put_bytes(file, differences);
    }
}

/// All low bytes, then all high bytes.
fn put_bytes(file: &mut Vec<u8>, values: impl Iterator<Item = u16> + Clone) {
    file.extend(values.clone().map(|value| value as u8));
    file.extend(values.map(|value| (value >> 8) as u8));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::lamp_sky;
    use proptest::prelude::*;
    use skyglow_physics::{Direction, ELEVATION_COUNT, LampPreset};

    const SAMPLES: usize = AZIMUTH_COUNT * ELEVATION_COUNT;

    /// The values of a group of planes at the start of `bytes`, as a reader finds them.
    fn read_group(bytes: &[u8], lowest: &[f64], (width, count): (usize, usize)) -> Vec<Vec<f64>> {
        let mut codes: Vec<Vec<u16>> = Vec::new();
        let unpredicted = |place: usize| {
            let bytes = &bytes[place * 2 * count..][..2 * count];
            let mut out = vec![0u16; count];
            for at in 0..count {
                let zigzag = u16::from(bytes[at]) | u16::from(bytes[count + at]) << 8;
                let difference = (zigzag >> 1) ^ (zigzag & 1).wrapping_neg();
                let (left, low) = (at % width > 0, at >= width);
                let before = |back: usize, is_there: bool| if is_there { out[at - back] } else { 0 };
                let predicted = match (left, low) {
                    (true, true) => {
                        out[at - 1].wrapping_add(out[at - width]).wrapping_sub(out[at - width - 1])
                    }
                    _ => before(1, left).wrapping_add(before(width, low)),
                };
                out[at] = predicted.wrapping_add(difference);
            }
            out
        };
        (0..lowest.len()).for_each(|place| codes.push(unpredicted(place)));
        let base = codes[1].clone();
        for (_, plane) in codes.iter_mut().enumerate().filter(|(place, _)| *place != 1) {
            plane.iter_mut().zip(&base).for_each(|(code, base)| *code = code.wrapping_add(*base));
        }
        let value = |code: u16, lowest: f64| {
            if code == 0 { 0.0 } else { lowest * ((f64::from(code) - 1.0) / STEPS_PER_E).exp() }
        };
        codes.iter().zip(lowest).map(|(plane, &low)| plane.iter().map(|&c| value(c, low)).collect()).collect()
    }

    fn sky() -> SeenSky {
        lamp_sky(LampPreset::Hps, |row, column| {
            2e-4 + 0.3 * (-(row as f64) / 9.0).exp() * (1.0 + (column as f64 / 40.0).sin()).max(0.0)
        })
    }

    /// Every value of a sky comes out of the file within 2.5e-4 of itself.
    #[test]
    fn values_are_within_their_stated_error() {
        let seen = sky();
        let planes = LogPlane::of_sky(&seen, &Horizon::flat());
        let lowest: Vec<f64> = planes.iter().map(|plane| plane.lowest).collect();
        let file = encode_sky(b"{}", &[planes], &PointTable::new(Vec::new()));
        assert_eq!(file.len(), 8 + 4 + 2 + 4 * 2 * SAMPLES);
        assert_eq!((&file[..8], &file[8..14]), (&SKY_MAGIC[..], &b"\x02\0\0\0{}"[..]));
        let read = read_group(&file[14..], &lowest, (AZIMUTH_COUNT, SAMPLES));
        for (place, values) in read.iter().enumerate() {
            for (value, wanted) in values.iter().zip(seen.plane(place)) {
                let wanted = f64::from(*wanted);
                assert!((value - wanted).abs() <= 2.5e-4 * wanted, "{place}: {value} {wanted}");
            }
        }
    }

    /// A smooth sky takes less than a third of its bytes once it is compressed fast.
    #[test]
    fn smooth_skies_compress_well() {
        use std::io::Write;
        let file =
            encode_sky(b"{}", &[LogPlane::of_sky(&sky(), &Horizon::flat())], &PointTable::new(Vec::new()));
        let mut gzip = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        gzip.write_all(&file).unwrap();
        let bytes = gzip.finish().unwrap().len();
        assert!(bytes < file.len() / 3, "{bytes} of {}", file.len());
    }

    /// Hidden samples have the lowest visible value.
    #[test]
    fn hidden_samples_are_filled() {
        let horizon = Horizon::new(vec![0.3; AZIMUTH_COUNT]).unwrap();
        let plane = &LogPlane::of_sky(&sky(), &horizon)[1];
        let lowest = horizon.first_visible_row(7);
        assert!(
            lowest > 0
                && (0..lowest).all(|row| {
                    plane.codes[row * AZIMUTH_COUNT + 7] == plane.codes[lowest * AZIMUTH_COUNT + 7]
                })
        );
    }

    /// Points come brightest first with their directions and light.
    #[test]
    fn points_are_read_back() {
        let point = |azimuth_rad: f64, lux: f64| PointLight {
            direction: Direction { azimuth_rad, elevation_rad: 0.7 },
            illuminance_lx: [0.9 * lux, lux, 1.1 * lux, 2.3 * lux],
            limit_mag: 3.0,
        };
        let table = PointTable::new(vec![point(1.0, 1e-7), point(6.2, 2e-6), point(-0.5, 3e-8)]);
        let file = encode_sky(b"", &[], &table);
        let bytes = &file[12..];
        let angle = |at: usize| u16::from_le_bytes([bytes[at], bytes[3 + at]]);
        let azimuths: Vec<f64> = (0..3).map(|at| f64::from(angle(at)) / ANGLE_STEPS * TAU).collect();
        for (found, wanted) in azimuths.iter().zip([6.2, 1.0, TAU - 0.5]) {
            assert!((found - wanted).abs() < 1e-4, "{azimuths:?}");
        }
        let light = read_group(&bytes[12..], &table.planes.each_ref().map(|plane| plane.lowest), (3, 3));
        for (place, factor) in [0.9, 1.0, 1.1, 2.3].into_iter().enumerate() {
            for (found, wanted) in light[place].iter().zip([2e-6, 1e-7, 3e-8]) {
                assert!((found / (factor * wanted) - 1.0).abs() < 2.5e-4, "{light:?}");
            }
        }
    }

    proptest! {
        /// Any values at all, darkness with them, come out within their error.
        #[test]
        fn any_values_are_read_back(exponents in prop::collection::vec(prop::option::of(-11.0..2.0_f64), 2..60)) {
            let values: Vec<f64> = exponents.iter().map(|e| e.map_or(0.0, |e| 10f64.powf(e))).collect();
            let planes = [LogPlane::of(values.iter().copied()), LogPlane::of(values.iter().rev().copied())];
            let mut bytes = Vec::new();
            put_group(&mut bytes, &planes, 7);
            let lowest = planes.each_ref().map(|plane| plane.lowest);
            let read = read_group(&bytes, &lowest, (7, values.len()));
            for (found, wanted) in read[0].iter().zip(&values).chain(read[1].iter().zip(values.iter().rev())) {
                prop_assert!((found - wanted).abs() <= 2.5e-4 * wanted, "{} {}", found, wanted);
            }
        }
    }
}
