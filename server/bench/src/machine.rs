//! The machine: what it is, and how fast it streams and multiplies, measured in the same run as all else.

use crate::{options::Extent, report::Machine};
use rayon::prelude::*;
use skyglow_physics::{simd::multiply_add, simd_dispatch};
use std::{
    hint::black_box,
    time::{Duration, Instant},
};

/// Numbers side by side in a vector.
const LANES: usize = 8;
/// Independent chains of multiply-adds: enough to fill two units of a latency of four or five.
const CHAINS: usize = 12;
/// Values that a thread sums at a time.
const CHUNK: usize = 1 << 16;
/// Tries at least.
const MIN_TRIES: usize = 3;

/// Describes the machine and measures it: a sum over memory (more than its caches hold, or it is the cache that is
/// measured), and fused multiply-adds in registers, as much of both as the extent says.
pub fn measure(extent: &Extent) -> Machine {
    let stream_bytes = extent.stream_bytes;
    Machine {
        processor: processor(),
        logical_cores: std::thread::available_parallelism().map_or(1, usize::from),
        threads: rayon::current_num_threads(),
        load_average: load_average(),
        stream_bytes,
        bandwidth_gb_s: bandwidth_bytes_s(stream_bytes, extent.time_for_tries) / 1e9,
        multiply_adds_g_s: multiply_adds_per_s(extent.multiply_adds, extent.time_for_tries) / 1e9,
    }
}

/// Name of the processor, as the kernel gives it.
fn processor() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let line = text.lines().find(|line| line.starts_with("model name"));
    line.and_then(|line| line.split_once(':'))
        .map_or("unknown".to_owned(), |(_, name)| name.trim().to_owned())
}

/// Bytes a second of a sum over f32 on all threads.
fn bandwidth_bytes_s(stream_bytes: usize, time_for_tries: Duration) -> f64 {
    let values = vec![1.0f32; (stream_bytes / size_of::<f32>()).max(CHUNK)];
    let best_time_s = best_time_s(time_for_tries, || {
        black_box(values.par_chunks(CHUNK).map(sum).sum::<f32>());
    });
    size_of_val(values.as_slice()) as f64 / best_time_s
}

/// Fused multiply-adds of f32 a second on all threads together.
fn multiply_adds_per_s(per_thread: usize, time_for_tries: Duration) -> f64 {
    let rounds = (per_thread / (LANES * CHAINS)).max(1);
    let best_time_s = best_time_s(time_for_tries, || {
        black_box(rayon::broadcast(|context| multiply(rounds, black_box(context.index() as f32))));
    });
    (rounds * LANES * CHAINS * rayon::current_num_threads()) as f64 / best_time_s
}

/// Seconds of the fastest of as many tries as fit into a time, three at least: other work on the machine only ever slows.
pub(crate) fn best_time_s(time_for_tries: Duration, mut work: impl FnMut()) -> f64 {
    let (mut best_time_s, mut tries) = (f64::INFINITY, 0);
    let begin = Instant::now();
    while tries < MIN_TRIES || begin.elapsed() < time_for_tries {
        let start = Instant::now();
        work();
        best_time_s = best_time_s.min(start.elapsed().as_secs_f64());
        tries += 1;
    }
    best_time_s
}

/// Mean number of tasks that ran or waited in the last minute, as the kernel gives it.
fn load_average() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/loadavg").ok()?;
    text.split_whitespace().next()?.parse().ok()
}

simd_dispatch! {
    /// The sum of a slice.
    fn sum(values: &[f32]) -> f32 = sum_body;
}

#[inline(always)]
fn sum_body(values: &[f32]) -> f32 {
    let mut sums = [[0.0f32; LANES]; CHAINS];
    for block in values.as_chunks::<{ LANES * CHAINS }>().0 {
        for (chain, sums) in sums.iter_mut().enumerate() {
            for (lane, sum) in sums.iter_mut().enumerate() {
                *sum += block[chain * LANES + lane];
            }
        }
    }
    sums.iter().flatten().sum()
}

simd_dispatch! {
    /// Chains of multiply-adds that stay in registers.
    fn multiply(rounds: usize, start: f32) -> f32 = multiply_body::<FUSED>;
}

#[inline(always)]
fn multiply_body<const FUSED: bool>(rounds: usize, start: f32) -> f32 {
    let mut chains = [[start; LANES]; CHAINS];
    let (factor, addend) = (black_box(0.999_f32), black_box(1e-3_f32));
    for _ in 0..rounds {
        for chain in &mut chains {
            for value in chain.iter_mut() {
                *value = multiply_add::<FUSED>(*value, factor, addend);
            }
        }
    }
    chains.iter().flatten().sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_loops_compute_what_they_claim() {
        let values: Vec<f32> = (0..CHUNK).map(|i| (i % 7) as f32).collect();
        let exact: f32 = (0..CHUNK / (LANES * CHAINS) * LANES * CHAINS).map(|i| (i % 7) as f32).sum();
        assert_eq!(sum(&values), exact);
        // x ← 0.999 x + 0.001 goes to 1 from anywhere.
        assert!((multiply(20_000, 5.0) / (LANES * CHAINS) as f32 - 1.0).abs() < 1e-3);
        assert!((multiply(10, 5.0) / (LANES * CHAINS) as f32 - 1.0).abs() > 1.0);
    }

    #[test]
    fn more_work_takes_longer_and_rates_are_positive() {
        let machine = measure(&crate::run::tests::tiny());
        assert!(machine.bandwidth_gb_s > 0.01 && machine.multiply_adds_g_s > 0.01, "{machine:?}");
        let time = |rounds| {
            best_time_s(Duration::from_millis(50), || {
                black_box(multiply(rounds, 0.5));
            })
        };
        assert!(time(4_000_000) > 4.0 * time(100_000));
    }
}
