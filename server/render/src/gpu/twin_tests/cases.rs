//! Every function with its arguments and its twin.

use super::arguments::{Answer, Argument};
use crate::{
    request::ExecutorKind,
    shaders::{self, LibraryFile},
    synthetic::tested_device,
    twin,
};
use skyglow_physics::{BAND_COUNT, LOBE_COUNT};

/// A function, and what it is compared with.
pub(super) struct Case {
    pub(super) function: &'static str,
    pub(super) files: &'static [LibraryFile],
    pub(super) arguments: Vec<Argument>,
    pub(super) answer: Answer,
    pub(super) twin: fn(&[u32]) -> Vec<u32>,
    /// Allowed |difference| / max(|value|, scale), by the rounding that the function's own steps may do.
    pub(super) tolerance: f64,
    pub(super) scale: f64,
}

pub(super) fn real(word: u32) -> f32 {
    f32::from_bits(word)
}

fn reals<const N: usize>(words: &[u32]) -> [f32; N] {
    std::array::from_fn(|position| real(words[position]))
}

fn bits<const N: usize>(values: [f32; N]) -> Vec<u32> {
    values.map(f32::to_bits).to_vec()
}

/// A twin's answers for two transforms whose points lie side by side.
fn both<const N: usize>(words: &[u32], twin: fn([[f32; 2]; N]) -> [[f32; 2]; N]) -> Vec<u32> {
    let [first, second] = [0, 2].map(|at| twin(std::array::from_fn(|point| reals(&words[4 * point + at..]))));
    let points = first.into_iter().zip(second).flat_map(|(first, second)| [first, second]);
    points.flatten().map(f32::to_bits).collect()
}

/// All of them.
pub(super) fn cases() -> Vec<Case> {
    use Argument::*;
    let elementary: &'static [LibraryFile] = &[shaders::ELEMENTARY];
    let mixing: &'static [LibraryFile] = &[shaders::ELEMENTARY, shaders::MIXING];
    let blending: &'static [LibraryFile] = &[shaders::ELEMENTARY, shaders::BLENDING];
    let fft: &'static [LibraryFile] = &[shaders::FFT];
    let indexing: &'static [LibraryFile] = &[shaders::TYPES, shaders::INDEXING];
    let (bands, lobes) = (Whole(BAND_COUNT as u32), Whole(LOBE_COUNT as u32));
    let case = |function, files, arguments: &[Argument], answer, twin, tolerance, scale| Case {
        function,
        files,
        arguments: arguments.to_vec(),
        answer,
        twin,
        tolerance,
        scale,
    };
    let ulps = 4.0 * f64::from(f32::EPSILON);
    vec![
        case(
            "natural_exp",
            elementary,
            &[Real(-95.0, 90.0)],
            Answer::Real,
            |w| bits([twin::natural_exp(real(w[0]))]),
            ulps,
            0.0,
        ),
        case(
            "natural_log",
            elementary,
            &[Logarithmic(1e-37, 1e37)],
            Answer::Real,
            |w| bits([twin::natural_log(real(w[0]))]),
            ulps,
            0.1,
        ),
        case(
            "lobe_shares",
            mixing,
            &[Vector(3, 0.0, 1.0), Vector(3, -60.0, -10.0)],
            Answer::RealVector(4),
            |w| bits(twin::lobe_shares(reals(w), reals(&w[3..]))),
            2.0 * ulps,
            1e-6,
        ),
        case(
            "mixed_curvature",
            mixing,
            &[Vector(3, 0.0, 0.4), Vector(3, -42.0, -40.0), Vector(3, -42.0, -40.0), Vector(3, -42.0, -40.0)],
            Answer::Real,
            |w| bits([twin::mixed_curvature(reals(w), [reals(&w[3..]), reals(&w[6..]), reals(&w[9..])])]),
            ulps,
            // A sum of terms of a few units, which a GPU may contract.
            if tested_device() == ExecutorKind::Gpu { 1.0 } else { 1e-6 },
        ),
        case(
            "log_scale_between",
            mixing,
            &[Vector(2, -45.0, -20.0), Vector(2, -1.0, 1.0), Real(0.0, 1.0)],
            Answer::Real,
            |w| bits([twin::log_scale_between(reals(w), reals(&w[2..]), real(w[4]))]),
            ulps,
            0.0,
        ),
        case(
            "cell_weights",
            mixing,
            &[Logarithmic(1.0, 1e8), Vector(2, -45.0, -20.0), Vector(2, -1.0, 1.0), Real(0.0, 1.0)],
            Answer::RealVector(2),
            |w| bits(twin::cell_weights(real(w[0]), reals(&w[1..]), reals(&w[3..]), real(w[5]))),
            // The interpolated logarithm, up to 45, is rounded to 2e-6.
            1e-5,
            0.0,
        ),
        case(
            "blend_radiance",
            blending,
            &[Vector(4, 0.0, 1e-9), Vector(4, -0.2, 0.8), Vector(4, -0.2, 0.8)],
            Answer::Real,
            |w| bits([twin::blend_radiance(reals(w), reals(&w[4..]), reals(&w[8..]))]),
            1e-5,
            1e-12,
        ),
        case(
            "complex_multiply",
            fft,
            &[Vector(4, -2.0, 2.0), Vector(2, -2.0, 2.0)],
            Answer::RealVector(4),
            |w| {
                let [a, b] = [0, 2].map(|at| twin::complex_multiply(reals(&w[at..]), reals(&w[4..])));
                bits([a[0], a[1], b[0], b[1]])
            },
            ulps,
            1.0,
        ),
        case("radix4_butterfly", fft, &[Legs], Answer::Legs, |w| both(w, twin::radix4_butterfly), ulps, 1.0),
        case(
            "transform_16",
            fft,
            &[Sixteen],
            Answer::Sixteen,
            |w| both(w, twin::transform_16),
            2.0 * ulps,
            4.0,
        ),
        case(
            "split_pair_spectrum",
            fft,
            &[Vector(2, -2.0, 2.0), Vector(2, -2.0, 2.0)],
            Answer::RealVector(4),
            |w| bits(twin::split_pair_spectrum(reals(w), reals(&w[2..]))),
            ulps,
            1.0,
        ),
        case(
            "pair_from_spectra",
            fft,
            &[Vector(4, -2.0, 2.0), Flag],
            Answer::RealVector(2),
            |w| bits(twin::pair_from_spectra(reals(w), w[4] != 0)),
            ulps,
            1.0,
        ),
        case(
            "cell_texel",
            indexing,
            &[Whole(400_000), bands],
            Answer::WholeVector(2),
            |w| twin::cell_texel(w[0], w[1]).to_vec(),
            0.0,
            0.0,
        ),
        case(
            "list_texel",
            indexing,
            &[Whole(400_000)],
            Answer::WholeVector(2),
            |w| twin::list_texel(w[0]).to_vec(),
            0.0,
            0.0,
        ),
        case(
            "mixed_texel",
            indexing,
            &[Whole(20_000), bands, Whole(64), Whole(65)],
            Answer::WholeVector(2),
            |w| twin::mixed_texel(w[0], w[1], w[2], w[3]).to_vec(),
            0.0,
            0.0,
        ),
        case(
            "blocked_layer",
            indexing,
            &[Whole(8), Whole(7)],
            Answer::Whole,
            |w| vec![twin::blocked_layer(w[0], w[1])],
            0.0,
            0.0,
        ),
        case(
            "shape_texel",
            indexing,
            &[Whole(6_144), Whole(8), lobes, bands, Whole(32), Whole(33)],
            Answer::WholeVector(2),
            |w| twin::shape_texel(w[0], w[1], w[2], w[3], w[4], w[5]).to_vec(),
            0.0,
            0.0,
        ),
    ]
}
