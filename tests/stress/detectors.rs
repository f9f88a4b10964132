//! What the suite looks for in numbers: one function a fault, each tested on a planted one.

/// Values that no radiance may have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Faults {
    /// Not a number.
    pub(crate) nan: usize,
    /// Infinite, of either sign.
    pub(crate) infinite: usize,
    /// Below 0.
    pub(crate) negative: usize,
}

impl Faults {
    /// Counts the faults in values of any unit.
    pub(crate) fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let mut faults = Self::default();
        for value in values {
            faults.nan += usize::from(value.is_nan());
            faults.infinite += usize::from(value.is_infinite());
            faults.negative += usize::from(value < 0.0);
        }
        faults
    }

    /// The same of f32.
    pub(crate) fn of_f32(values: &[f32]) -> Self {
        Self::of(values.iter().map(|value| f64::from(*value)))
    }

    /// Faults of every kind together.
    pub(crate) fn total(self) -> usize {
        self.nan + self.infinite + self.negative
    }
}

impl std::ops::AddAssign for Faults {
    fn add_assign(&mut self, other: Self) {
        self.nan += other.nan;
        self.infinite += other.infinite;
        self.negative += other.negative;
    }
}

/// Lost digits: the largest |got − exact| / magnitude, where `magnitude` is what the value was summed from. Where that
/// is 0 any difference is infinite; what is no number is infinite too.
pub(crate) fn lost_digits(
    got: impl IntoIterator<Item = f64>,
    exact: impl IntoIterator<Item = f64>,
    magnitude: impl IntoIterator<Item = f64>,
) -> f64 {
    let share = |((got, exact), magnitude): ((f64, f64), f64)| {
        let error = (got - exact).abs();
        let share = if error == 0.0 { 0.0 } else { error / magnitude };
        if share.is_nan() { f64::INFINITY } else { share }
    };
    got.into_iter().zip(exact).zip(magnitude).map(share).fold(0.0, f64::max)
}

/// A jump: the largest amount by which a step of `walked` exceeds the largest of the three steps of `own` around it,
/// and where. Both are sampled at the same places of one walk; `own` changes as the reference does. A step is
/// |a − b| / max(a, b, `floor`); one with a value that is no number is infinite.
pub(crate) fn jump(walked: &[f64], own: &[f64], floor: f64) -> (f64, usize) {
    let step = |pair: &[f64]| {
        let step = (pair[0] - pair[1]).abs() / pair[0].max(pair[1]).max(floor);
        if step.is_nan() { f64::INFINITY } else { step }
    };
    let own: Vec<f64> = own.windows(2).map(step).collect();
    let mut largest = (0.0, 0);
    for (at, walked) in walked.windows(2).map(step).enumerate() {
        let around = &own[at.saturating_sub(1)..(at + 2).min(own.len())];
        let excess = walked - around.iter().copied().fold(0.0, f64::max);
        if excess > largest.0 || excess.is_nan() {
            largest = (if excess.is_nan() { f64::INFINITY } else { excess }, at);
        }
    }
    largest
}

/// Holes: how many values are below a thousandth of what they should be, where that is above `floor`. A NaN that a
/// later `max(0)` made black is seen by this and by nothing else.
pub(crate) fn holes(
    got: impl IntoIterator<Item = f64>,
    exact: impl IntoIterator<Item = f64>,
    floor: f64,
) -> usize {
    let is_hole = |(got, exact): &(f64, f64)| *exact > floor && (got.is_nan() || *got < 1e-3 * exact);
    got.into_iter().zip(exact).filter(is_hole).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    const CLEAN: [f64; 6] = [0.0, 1e-300, 3.0, 2.9, 2.8, 1e300];

    fn with(at: usize, value: f64) -> [f64; 6] {
        let mut values = CLEAN;
        values[at] = value;
        values
    }

    /// A planted NaN, infinity or negative value is counted, and clean values are not.
    #[test]
    fn planted_nan_and_negatives_are_counted() {
        assert_eq!(Faults::of(CLEAN), Faults::default());
        assert_eq!(Faults::of(with(2, f64::NAN)), Faults { nan: 1, ..Faults::default() });
        assert_eq!(Faults::of(with(0, f64::INFINITY)), Faults { infinite: 1, ..Faults::default() });
        assert_eq!(Faults::of(with(5, -1e-30)), Faults { negative: 1, ..Faults::default() });
        // An infinity below 0 is both.
        assert_eq!(Faults::of(with(5, f64::NEG_INFINITY)), Faults { nan: 0, infinite: 1, negative: 1 });
        assert_eq!(Faults::of_f32(&[1.0, f32::NAN, -2.0]).total(), 2);
        // −0 is dark, not negative.
        assert_eq!(Faults::of([-0.0]).total(), 0);
    }

    /// A planted loss of digits is measured, and exact values have none.
    #[test]
    fn a_planted_loss_of_digits_is_measured() {
        assert_eq!(lost_digits(CLEAN, CLEAN, CLEAN), 0.0);
        let loss = lost_digits(with(3, 2.9 * 1.000_01), CLEAN, CLEAN);
        assert!((loss - 1e-5).abs() < 1e-9, "{loss}");
        // Beside a magnitude of a thousand the same difference is a thousandth of it.
        assert!(lost_digits([1.001], [1.0], [1_000.0]) < 1.1e-6);
        assert_eq!(lost_digits([f64::NAN], [1.0], [1.0]), f64::INFINITY);
        assert_eq!(lost_digits([1e-30], [0.0], [0.0]), f64::INFINITY);
    }

    /// A planted jump is found where it is, and a steep reference is none.
    #[test]
    fn a_planted_jump_is_found_where_it_is() {
        let own: Vec<f64> = (0..100).map(|i| (-0.05 * f64::from(i)).exp()).collect();
        let (excess, _) = jump(&own, &own, 0.0);
        assert!(excess < 1e-12, "{excess}");
        let mut walked = own.clone();
        walked[60..].iter_mut().for_each(|value| *value *= 0.97);
        let (excess, at) = jump(&walked, &own, 0.0);
        assert!((excess - 0.03).abs() < 2e-3 && at == 59, "{excess} at {at}");
        // A spike of one sample is a jump, and so is a hole and a NaN.
        walked.clone_from(&own);
        walked[30] *= 1.02;
        assert!(jump(&walked, &own, 0.0).0 > 0.015);
        walked[30] = f64::NAN;
        assert_eq!(jump(&walked, &own, 0.0), (f64::INFINITY, 29));
        // Below the floor nobody sees it.
        walked[30] = 0.0;
        assert!(jump(&walked, &own, 1e3).0 < 1e-3);
    }

    /// A planted hole is counted, and a dim reference is none.
    #[test]
    fn a_planted_hole_is_counted() {
        assert_eq!(holes(CLEAN, CLEAN, 1e-9), 0);
        assert_eq!(holes(with(2, 0.0), CLEAN, 1e-9), 1);
        assert_eq!(holes(with(2, f64::NAN), CLEAN, 1e-9), 1);
        assert_eq!(holes(with(1, 0.0), CLEAN, 1e-9), 0);
    }
}
