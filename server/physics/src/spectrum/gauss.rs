//! Gauss rules of a discrete weight by the Stieltjes procedure (Gautschi 2004, section 2.2).

/// A point and its weight.
pub(super) type Point = (f64, f64);

/// The Gauss rule of `count` points for weights at places: exact for polynomials up to the degree 2·`count` − 1. Fewer points where
/// fewer places have a weight.
pub(super) fn rule(places: &[f64], weights: &[f64], count: usize) -> Vec<Point> {
    let lit: Vec<Point> =
        places.iter().copied().zip(weights.iter().copied()).filter(|(_, weight)| *weight > 0.0).collect();
    if lit.len() <= count {
        return lit;
    }
    let (alpha, beta) = recurrence(&lit, count);
    let low = lit.iter().map(|point| point.0).fold(f64::INFINITY, f64::min);
    let high = lit.iter().map(|point| point.0).fold(f64::NEG_INFINITY, f64::max);
    // Zeros of a polynomial lie between those of the one a degree higher: each has an interval of its own.
    let mut zeros: Vec<f64> = Vec::new();
    for degree in 1..=count {
        let mut ends = vec![low];
        ends.extend(&zeros);
        ends.push(high);
        zeros = ends.windows(2).map(|pair| zero(&alpha, &beta, degree, pair[0], pair[1])).collect();
    }
    zeros
        .into_iter()
        .map(|at| {
            // Christoffel's numbers: 1 / Σ p_k² of the orthonormal polynomials.
            let mut sum = 0.0;
            let mut norm = beta[0];
            for degree in 0..count {
                if degree > 0 {
                    norm *= beta[degree];
                }
                sum += polynomial(&alpha, &beta, degree, at).powi(2) / norm;
            }
            (at, 1.0 / sum)
        })
        .collect()
}

/// Coefficients of π_{k+1} = (x − α_k) π_k − β_k π_{k−1}, the monic orthogonal polynomials; β_0 is the sum of the weights.
fn recurrence(lit: &[Point], count: usize) -> (Vec<f64>, Vec<f64>) {
    let (mut alpha, mut beta) = (Vec::new(), Vec::new());
    let mut last_norm = 1.0;
    for degree in 0..count {
        let (mut norm, mut moment) = (0.0, 0.0);
        for (at, weight) in lit {
            let square = weight * polynomial(&alpha, &beta, degree, *at).powi(2);
            norm += square;
            moment += square * at;
        }
        alpha.push(moment / norm);
        beta.push(norm / last_norm);
        last_norm = norm;
    }
    (alpha, beta)
}

/// π_degree at a place.
fn polynomial(alpha: &[f64], beta: &[f64], degree: usize, at: f64) -> f64 {
    let (mut before, mut value) = (0.0, 1.0);
    for k in 0..degree {
        let next = (at - alpha[k]) * value - if k > 0 { beta[k] * before } else { 0.0 };
        (before, value) = (value, next);
    }
    value
}

/// The one zero of π_degree between two places, by bisection.
fn zero(alpha: &[f64], beta: &[f64], degree: usize, mut low: f64, mut high: f64) -> f64 {
    let is_negative = |at: f64| polynomial(alpha, beta, degree, at) < 0.0;
    let low_is_negative = is_negative(low);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if is_negative(middle) == low_is_negative {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Up to the degree 2n − 1 sums over the points are those over all places.
        #[test]
        fn polynomials_are_summed_exactly(
            weights in prop::collection::vec(0.0..1.0_f64, 12..60),
            coefficients in prop::collection::vec(-1.0..1.0_f64, 8),
            count in 1_usize..=4,
        ) {
            prop_assume!(weights.iter().filter(|weight| **weight > 0.01).count() > 5);
            let places: Vec<f64> = (0..weights.len()).map(|k| -1.0 + 2.0 * k as f64 / weights.len() as f64).collect();
            let value = |x: f64| coefficients[..2 * count].iter().rev().fold(0.0, |sum, c| sum * x + c);
            let exact: f64 = places.iter().zip(&weights).map(|(x, w)| w * value(*x)).sum();
            let total: f64 = weights.iter().sum();
            let points = rule(&places, &weights, count);
            prop_assert_eq!(points.len(), count);
            prop_assert!(points.iter().all(|(_, weight)| *weight > 0.0));
            let found: f64 = points.iter().map(|(x, w)| w * value(*x)).sum();
            prop_assert!((found - exact).abs() < 1e-9 * total, "{} {}", found, exact);
        }
    }

    #[test]
    fn few_places_are_their_own_rule() {
        assert_eq!(rule(&[1.0, 2.0, 3.0], &[0.0, 0.5, 0.0], 3), vec![(2.0, 0.5)]);
        assert_eq!(rule(&[1.0], &[0.0], 3), vec![]);
    }
}
