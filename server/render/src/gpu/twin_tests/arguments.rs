//! What functions are given and answer, as words and as WGSL.

use crate::synthetic::Noise;

/// One argument: its WGSL expression over the words `in[at]`, how many words it takes, and a random value.
#[derive(Clone, Copy)]
pub(super) enum Argument {
    /// f32 in a range.
    Real(f64, f64),
    /// f32 evenly in the logarithm.
    Logarithmic(f64, f64),
    /// u32 below a bound.
    Whole(u32),
    /// vec2, vec3 or vec4 of f32 in a range.
    Vector(usize, f64, f64),
    /// bool.
    Flag,
    /// Two complex numbers side by side, four times.
    Legs,
    /// The same sixteen times.
    Sixteen,
}

impl Argument {
    pub(super) fn words(self) -> usize {
        match self {
            Argument::Vector(size, ..) => size,
            Argument::Legs => 16,
            Argument::Sixteen => 64,
            _ => 1,
        }
    }

    pub(super) fn draw(self, noise: &mut Noise, words: &mut Vec<u32>) {
        let mut real = |low: f64, high: f64| ((low + (high - low) * noise.unit()) as f32).to_bits();
        match self {
            Argument::Real(low, high) => words.push(real(low, high)),
            Argument::Logarithmic(low, high) => {
                let log = f32::from_bits(real(low.ln(), high.ln()));
                words.push((f64::from(log).exp() as f32).to_bits());
            }
            Argument::Whole(bound) => words.push((noise.unit() * f64::from(bound)) as u32),
            Argument::Vector(size, low, high) => words.extend((0..size).map(|_| real(low, high))),
            Argument::Flag => words.push(u32::from(noise.unit() < 0.5)),
            Argument::Legs | Argument::Sixteen => {
                words.extend((0..self.words()).map(|_| real(-2.0, 2.0)));
            }
        }
    }

    pub(super) fn expression(self, at: usize) -> String {
        let real = |offset: usize| format!("bitcast<f32>(inputs[first + {}u])", at + offset);
        let vector = |at: usize, size: usize| {
            let parts: Vec<String> = (0..size).map(|offset| real(at + offset)).collect();
            format!("vec{size}<f32>({})", parts.join(", "))
        };
        match self {
            Argument::Real(..) | Argument::Logarithmic(..) => real(0),
            Argument::Whole(_) => format!("inputs[first + {at}u]"),
            Argument::Vector(size, ..) => vector(0, size),
            Argument::Flag => format!("(inputs[first + {at}u] != 0u)"),
            Argument::Legs => {
                let legs: Vec<String> = (0..4).map(|leg| vector(4 * leg, 4)).collect();
                format!("Legs({})", legs.join(", "))
            }
            Argument::Sixteen => {
                // Point j + 4m is member m of row j.
                let rows: Vec<String> = (0..4)
                    .map(|j| {
                        let legs: Vec<String> = (0..4).map(|m| vector(4 * (j + 4 * m), 4)).collect();
                        format!("Legs({})", legs.join(", "))
                    })
                    .collect();
                format!("Sixteen({})", rows.join(", "))
            }
        }
    }
}

/// What a function answers, as words.
#[derive(Clone, Copy)]
pub(super) enum Answer {
    Real,
    Whole,
    RealVector(usize),
    WholeVector(usize),
    Legs,
    Sixteen,
}
