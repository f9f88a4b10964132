//! Errors by group, with what noise explains taken off.

/// Relative errors of one group, and the noise of what they are relative to.
#[derive(Default)]
struct Statistics {
    errors: Vec<f64>,
    beyond_noise: Vec<f64>,
    noise: Vec<f64>,
    signed: f64,
}

impl Statistics {
    fn add(&mut self, error: f64, noise: f64) {
        self.errors.push(error.abs());
        self.beyond_noise.push((error.abs() - 2.0 * noise).max(0.0));
        self.noise.push(noise);
        self.signed += error;
    }

    fn print(&self, name: &str) {
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
        let percentile = |values: &[f64]| {
            let mut sorted = values.to_vec();
            sorted.sort_by(f64::total_cmp);
            sorted
                .get((sorted.len().saturating_sub(1) as f64 * 0.99).round() as usize)
                .copied()
                .unwrap_or(0.0)
        };
        println!(
            "{name:28} n {:4}  bias {:+6.2} %  mean {:5.2} %  p99 {:6.2} %  MC noise {:5.2} %  beyond 2 sigma: mean {:5.2} %  p99 {:6.2} %",
            self.errors.len(),
            100.0 * self.signed / self.errors.len().max(1) as f64,
            100.0 * mean(&self.errors),
            100.0 * percentile(&self.errors),
            100.0 * mean(&self.noise),
            100.0 * mean(&self.beyond_noise),
            100.0 * percentile(&self.beyond_noise),
        );
    }
}

/// Statistics by name, in the order of their first error.
#[derive(Default)]
pub(crate) struct Groups(Vec<(String, Statistics)>);

impl Groups {
    /// Adds an error, and its noise, to the group of that name.
    pub(crate) fn add(&mut self, name: String, error: f64, noise: f64) {
        let index = self.0.iter().position(|(known, _)| *known == name).unwrap_or_else(|| {
            self.0.push((name, Statistics::default()));
            self.0.len() - 1
        });
        self.0[index].1.add(error, noise);
    }

    /// A line each.
    pub(crate) fn print(&self) {
        for (name, statistics) in &self.0 {
            statistics.print(name);
        }
    }
}
