//! Several sites: a linear programme of as many rows as sites and as many columns as lights, by an interior-point solver.
//!
//! Most lights are clearly worth their cut or clearly not, whatever the exact prices. So a few thousand near the edge are solved
//! for, the others are held where the prices put them, and whoever the new prices prove wrong joins the few: in the end no light
//! contradicts the prices, and the cut is that of the whole programme. Where time or room runs out before, cuts are filled up greedily:
//! they meet the needs, and the bound says how far from the least they may be.

use super::problem::Reduction;
use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, SolverStatus, SupportedConeT};
use std::time::{Duration, Instant};

/// Lights that are solved for at first.
const INITIAL_LIGHTS: usize = 6_000;
/// A light is held wrongly if its worth differs from its flux by more than this part of the flux.
const WRONG: f64 = 1e-7;
/// Solving over; the few at least double each time, so this is never met.
const MAX_ROUNDS: usize = 40;
/// Time that all rounds may take together; after it, cuts are filled up greedily.
const LONGEST: Duration = Duration::from_secs(10);
/// Entries that are solved for at most: each of the few has one for each site, and so many beside.
const MAX_ENTRIES: usize = 1_000_000;
const ENTRIES_PER_LIGHT: usize = 12;
/// Bytes that the solver takes for each (measured: 105).
const BYTES_PER_ENTRY: usize = 128;
/// A cut this near its end is there.
const AT_END: f64 = 1e-6;
/// What a need may miss by rounding, of itself.
const ROUNDING: f64 = 1e-12;

/// Bytes that solving takes at most, about, beside what lights do.
pub(crate) fn programme_bytes(lights: usize, sites: usize) -> usize {
    BYTES_PER_ENTRY * lights.saturating_mul(ENTRIES_PER_LIGHT + sites).min(MAX_ENTRIES)
}

/// Cuts and prices. Every need must be in reach.
pub(super) fn solve(problem: &Reduction) -> (Vec<f64>, Vec<f64>) {
    solve_within(problem, LONGEST, MAX_ENTRIES)
}

/// The same within a time and room.
pub(super) fn solve_within(
    problem: &Reduction,
    longest: Duration,
    most_entries: usize,
) -> (Vec<f64>, Vec<f64>) {
    let deadline = Instant::now() + longest;
    let lights = problem.flux.len();
    let can_help =
        |light: &usize| problem.most_cut[*light] > 0.0 && problem.gain.iter().any(|gain| gain[*light] > 0.0);
    let useful: Vec<usize> = (0..lights).filter(can_help).collect();
    let mut cut = vec![0.0; lights];
    let mut prices = first_prices(problem, &useful, deadline);
    let mut is_free = vec![useful.len() <= INITIAL_LIGHTS; lights];
    if useful.len() > INITIAL_LIGHTS {
        nearest(problem, &useful, &prices, INITIAL_LIGHTS)
            .into_iter()
            .for_each(|light| is_free[light] = true);
    }
    for _ in 0..MAX_ROUNDS {
        if Instant::now() >= deadline {
            break;
        }
        let (free, held): (Vec<usize>, Vec<usize>) = useful.iter().partition(|light| is_free[**light]);
        if free.len() * (ENTRIES_PER_LIGHT + problem.need.len()) > most_entries {
            break;
        }
        for &light in &held {
            let is_worth_it = problem.worth(light, &prices) > problem.flux[light];
            cut[light] = if is_worth_it { problem.most_cut[light] } else { 0.0 };
        }
        let left: Vec<f64> = (0..problem.need.len())
            .map(|site| {
                let fallen: f64 = held.iter().map(|&light| problem.gain[site][light] * cut[light]).sum();
                problem.need[site] - fallen
            })
            .collect();
        let reach = |site: usize| -> f64 {
            free.iter().map(|&light| problem.gain[site][light].max(0.0) * problem.most_cut[light]).sum()
        };
        let is_short =
            (0..left.len()).any(|site| left[site] > reach(site) * (1.0 - 1e-9)) && !held.is_empty();
        let solved = (!is_short).then(|| solve_few(problem, &free, &left, deadline)).flatten();
        let Some((of_free, new_prices)) = solved else {
            // The few cannot do it by themselves: twice as many.
            let more = nearest(problem, &held, &prices, free.len().max(INITIAL_LIGHTS));
            if more.is_empty() {
                break;
            }
            more.into_iter().for_each(|light| is_free[light] = true);
            continue;
        };
        free.iter().zip(of_free).for_each(|(&light, of_light)| cut[light] = of_light);
        prices = new_prices;
        let is_wrong = |light: &&usize| {
            let surplus = problem.worth(**light, &prices) - problem.flux[**light];
            let should_be_cut = surplus > WRONG * problem.flux[**light];
            let should_stay = surplus < -WRONG * problem.flux[**light];
            if cut[**light] > 0.0 { should_stay } else { should_be_cut }
        };
        let wrong: Vec<usize> = held.iter().filter(is_wrong).copied().collect();
        if wrong.is_empty() {
            break;
        }
        let count = wrong.len();
        wrong.into_iter().for_each(|light| is_free[light] = true);
        // Their neighbours are likely to be next.
        nearest(problem, &held, &prices, count.max(INITIAL_LIGHTS / 4))
            .into_iter()
            .for_each(|light| is_free[light] = true);
    }
    fill_up(problem, &useful, &mut cut);
    (cut, prices)
}

/// Prices by a sample of the lights, each standing for its share.
fn first_prices(problem: &Reduction, useful: &[usize], deadline: Instant) -> Vec<f64> {
    let step = useful.len().div_ceil(INITIAL_LIGHTS).max(1);
    let sample: Vec<usize> = useful.iter().copied().step_by(step).collect();
    if step == 1 {
        return vec![0.0; problem.need.len()];
    }
    let part = sample.len() as f64 / useful.len() as f64;
    let need = problem.need.iter().enumerate().map(|(site, need)| {
        let reach: f64 =
            sample.iter().map(|&light| problem.gain[site][light].max(0.0) * problem.most_cut[light]).sum();
        (need * part).min(0.99 * reach)
    });
    let need: Vec<f64> = need.collect();
    solve_few(problem, &sample, &need, deadline).map_or_else(|| vec![0.0; need.len()], |(_, prices)| prices)
}

/// The `count` lights whose worth is nearest to their flux, by ratio.
fn nearest(problem: &Reduction, lights: &[usize], prices: &[f64], count: usize) -> Vec<usize> {
    let off = |light: &usize| {
        let ratio = (problem.worth(*light, prices) / problem.flux[*light]).ln().abs();
        if ratio.is_finite() { ratio } else { f64::MAX }
    };
    let mut by_distance: Vec<(f64, usize)> = lights.iter().map(|light| (off(light), *light)).collect();
    if by_distance.len() > count && count > 0 {
        by_distance.select_nth_unstable_by(count - 1, |a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    }
    by_distance.truncate(count);
    by_distance.into_iter().map(|(_, light)| light).collect()
}

/// The programme over some lights, and the price of each site; None where the solver gives up.
fn solve_few(
    problem: &Reduction,
    lights: &[usize],
    need: &[f64],
    deadline: Instant,
) -> Option<(Vec<f64>, Vec<f64>)> {
    let rows: Vec<usize> = (0..need.len()).filter(|&site| need[site] > 0.0).collect();
    let mut prices = vec![0.0; need.len()];
    if rows.is_empty() {
        return Some((vec![0.0; lights.len()], prices));
    }
    let count = lights.len();
    let of_all: f64 = lights.iter().map(|&light| problem.flux[light] * problem.most_cut[light]).sum();
    // Each column: its gains, then its two bounds; the unknown is the part of what may go.
    let (mut starts, mut places, mut values) = (vec![0], Vec::new(), Vec::new());
    for (column, &light) in lights.iter().enumerate() {
        for (row, &site) in rows.iter().enumerate() {
            let gain = problem.gain[site][light];
            if gain > 0.0 {
                places.push(row);
                values.push(-gain * problem.most_cut[light] / need[site]);
            }
        }
        places.extend([rows.len() + column, rows.len() + count + column]);
        values.extend([1.0, -1.0]);
        starts.push(places.len());
    }
    let height = rows.len() + 2 * count;
    let matrix = CscMatrix::new(height, count, starts, places, values);
    let bounds: Vec<f64> = (0..height)
        .map(|row| {
            if row < rows.len() {
                -1.0
            } else if row < rows.len() + count {
                1.0
            } else {
                0.0
            }
        })
        .collect();
    let costs: Vec<f64> = lights
        .iter()
        .map(|&light| problem.flux[light] * problem.most_cut[light] * count as f64 / of_all)
        .collect();
    let time_limit = deadline.saturating_duration_since(Instant::now()).as_secs_f64();
    let settings = DefaultSettings { verbose: false, time_limit, ..DefaultSettings::default() };
    let cones = [SupportedConeT::NonnegativeConeT(height)];
    let no_squares = CscMatrix::zeros((count, count));
    let mut solver = DefaultSolver::new(&no_squares, &costs, &matrix, &bounds, &cones, settings).ok()?;
    solver.solve();
    let solution = &solver.solution;
    if !matches!(solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved) {
        return None;
    }
    for (row, &site) in rows.iter().enumerate() {
        prices[site] = (solution.z[row] * of_all / count as f64 / need[site]).max(0.0);
    }
    let cut = solution.x.iter().zip(lights).map(|(part, &light)| {
        let part = if *part < AT_END {
            0.0
        } else if *part > 1.0 - AT_END {
            1.0
        } else {
            *part
        };
        part * problem.most_cut[light]
    });
    Some((cut.collect(), prices))
}

/// Raises cuts until every need is met: what rounding took away, and all of it should a solver have given up.
fn fill_up(problem: &Reduction, useful: &[usize], cut: &mut [f64]) {
    for site in 0..problem.need.len() {
        let mut left = problem.need[site] - problem.fall(site, cut);
        if left <= ROUNDING * problem.need[site] {
            continue;
        }
        let gain = &problem.gain[site];
        let has_room = |light: &usize| gain[*light] > 0.0 && cut[*light] < problem.most_cut[*light];
        let mut order: Vec<usize> = useful.iter().copied().filter(has_room).collect();
        let worth = |light: &usize| gain[*light] / problem.flux[*light];
        order.sort_unstable_by(|a, b| worth(b).total_cmp(&worth(a)).then(a.cmp(b)));
        for light in order {
            if left <= 0.0 {
                break;
            }
            let more = (problem.most_cut[light] - cut[light]).min(left / gain[light]);
            cut[light] += more;
            left -= more * gain[light];
        }
    }
}
