use super::*;
use proptest::prelude::*;
use std::time::Duration;

/// Every combination of fixed lights (at nothing or at the most) and as many free ones as there are sites: the corners of the
/// programme's polytope, one of which is best.
fn best_corner(problem: &Reduction) -> f64 {
    let (lights, sites) = (problem.flux.len(), problem.need.len());
    let mut best = f64::INFINITY;
    let mut states = vec![0u8; lights];
    loop {
        let free: Vec<usize> = (0..lights).filter(|&light| states[light] == 2).collect();
        if free.len() <= sites {
            for rows in 0u32..1 << sites {
                let rows: Vec<usize> = (0..sites).filter(|site| rows >> site & 1 == 1).collect();
                if rows.len() == free.len()
                    && let Some(flux) = corner(problem, &states, &free, &rows)
                {
                    best = best.min(flux);
                }
            }
        }
        let Some(next) = states.iter().position(|state| *state < 2) else { return best };
        states[next] += 1;
        states[..next].fill(0);
    }
}

/// The flux of a corner, where the needs of `rows` are met exactly by the free lights; None if that is no plan.
fn corner(problem: &Reduction, states: &[u8], free: &[usize], rows: &[usize]) -> Option<f64> {
    let mut cut: Vec<f64> = states
        .iter()
        .zip(&problem.most_cut)
        .map(|(state, most)| if *state == 1 { *most } else { 0.0 })
        .collect();
    let size = free.len();
    let mut system: Vec<Vec<f64>> = rows
        .iter()
        .map(|&site| {
            let mut row: Vec<f64> = free.iter().map(|&light| problem.gain[site][light]).collect();
            row.push(problem.need[site] - problem.fall(site, &cut));
            row
        })
        .collect();
    for pivot in 0..size {
        let best =
            (pivot..size).max_by(|a, b| system[*a][pivot].abs().total_cmp(&system[*b][pivot].abs()))?;
        system.swap(pivot, best);
        if system[pivot][pivot].abs() < 1e-12 {
            return None;
        }
        for row in (0..size).filter(|row| *row != pivot) {
            let factor = system[row][pivot] / system[pivot][pivot];
            let of_pivot = system[pivot].clone();
            system[row].iter_mut().zip(of_pivot).for_each(|(value, of_pivot)| *value -= factor * of_pivot);
        }
    }
    for (row, &light) in free.iter().enumerate() {
        cut[light] = system[row][size] / system[row][row];
    }
    let is_plan = cut.iter().zip(&problem.most_cut).all(|(cut, most)| (-1e-9..=most + 1e-9).contains(cut))
        && (0..problem.need.len()).all(|site| problem.fall(site, &cut) >= problem.need[site] - 1e-9);
    is_plan.then(|| cut.iter().zip(&problem.flux).map(|(cut, flux)| cut * flux).sum())
}

fn problem(lights: usize, sites: usize) -> impl Strategy<Value = Reduction> {
    let gains = prop::collection::vec(prop::collection::vec(0.01f64..10.0, lights), sites);
    let flux = prop::collection::vec(0.1f64..10.0, lights);
    let most = prop::collection::vec(prop_oneof![Just(0.0), Just(1.0), 0.1f64..1.0], lights);
    (gains, flux, most, prop::collection::vec(0.05f64..0.95, sites)).prop_map(
        |(gain, flux, most_cut, part)| {
            let mut problem = Reduction { flux, most_cut, gain: gain.into(), need: vec![0.0; part.len()] };
            problem.need = (0..part.len()).map(|site| part[site] * problem.reach(site)).collect();
            problem
        },
    )
}

fn assert_meets(problem: &Reduction, found: &LeastCut) -> Result<(), TestCaseError> {
    for (cut, most) in found.cut.iter().zip(&problem.most_cut) {
        prop_assert!((0.0..=most + 1e-12).contains(cut));
    }
    for site in 0..problem.need.len() {
        let fall = problem.fall(site, &found.cut);
        prop_assert!(fall >= problem.need[site] * (1.0 - 1e-9), "{} {}", fall, problem.need[site]);
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_corner_is_better_for_one_site(problem in problem(7, 1)) {
        let found = least_cut(&problem);
        assert_meets(&problem, &found)?;
        let best = best_corner(&problem);
        prop_assert!((found.flux - best).abs() <= 1e-9 * best.max(1.0), "{} {}", found.flux, best);
        prop_assert!((found.least_flux - best).abs() <= 1e-9 * best.max(1.0));
    }

    #[test]
    fn the_programme_of_one_site_is_the_greedy_fill(problem in problem(40, 1)) {
        let greedy = least_cut(&problem);
        let (cut, _) = linear_programme::solve(&problem);
        let flux: f64 = cut.iter().zip(&problem.flux).map(|(cut, flux)| cut * flux).sum();
        prop_assert!((flux - greedy.flux).abs() <= 1e-5 * greedy.flux.max(1e-3), "{} {}", flux, greedy.flux);
    }

    #[test]
    fn no_corner_is_better_for_several_sites(problem in problem(6, 3)) {
        let found = least_cut(&problem);
        assert_meets(&problem, &found)?;
        let best = best_corner(&problem);
        prop_assert!(found.flux <= best * (1.0 + 1e-5) + 1e-9, "{} {}", found.flux, best);
        prop_assert!(found.least_flux <= best * (1.0 + 1e-9) + 1e-12, "{} {}", found.least_flux, best);
        prop_assert!(found.least_flux >= best * (1.0 - 1e-4) - 1e-9, "{} {}", found.least_flux, best);
    }

    #[test]
    fn brute_force_on_a_lattice_finds_nothing_better(problem in problem(5, 2)) {
        let found = least_cut(&problem);
        let steps = 8u32;
        for code in 0..(steps + 1).pow(5) {
            let cut: Vec<f64> = (0..5u32)
                .map(|light| {
                    let step = code / (steps + 1).pow(light) % (steps + 1);
                    problem.most_cut[light as usize] * f64::from(step) / f64::from(steps)
                })
                .collect();
            if (0..2).all(|site| problem.fall(site, &cut) >= problem.need[site]) {
                let flux: f64 = cut.iter().zip(&problem.flux).map(|(cut, flux)| cut * flux).sum();
                prop_assert!(found.flux <= flux * (1.0 + 1e-5) + 1e-9, "{} {}", found.flux, flux);
            }
        }
    }
}

/// Thousands of lights around a few places, brightness over four decades: more than are solved for at once.
fn large(lights: usize, sites: usize) -> Reduction {
    let mut state = 7u64;
    let mut random = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let places: Vec<(f64, f64)> = (0..lights).map(|_| (random(), random())).collect();
    let flux: Vec<f64> = (0..lights).map(|_| 10f64.powf(4.0 * random())).collect();
    let gain = (0..sites)
        .map(|_| {
            let (x, y) = (random(), random());
            let gain = |(at, flux): (&(f64, f64), &f64)| {
                flux / (0.01 + (at.0 - x).powi(2) + (at.1 - y).powi(2)).powf(1.25)
            };
            places.iter().zip(&flux).map(gain).collect()
        })
        .collect();
    let most_cut = (0..lights).map(|_| if random() < 0.1 { 0.0 } else { 0.8 }).collect();
    let mut problem = Reduction { flux, most_cut, gain, need: vec![0.0; sites] };
    problem.need = (0..sites).map(|site| (0.2 + 0.1 * site as f64) * problem.reach(site)).collect();
    problem
}

/// A plan of many lights is proved to be the least.
#[test]
fn a_plan_of_many_lights_is_the_least() {
    let problem = large(60_000, 4);
    let found = least_cut(&problem);
    for site in 0..4 {
        let fall = problem.fall(site, &found.cut);
        assert!(fall >= problem.need[site] * (1.0 - 1e-9), "{site}: {fall} {}", problem.need[site]);
    }
    assert!(found.flux >= found.least_flux * (1.0 - 1e-9));
    assert!(found.flux <= found.least_flux * (1.0 + 1e-5), "{} {}", found.flux, found.least_flux);
    // The bound is one: wrong prices prove less.
    let half = Reduction { need: problem.need.iter().map(|need| 0.5 * need).collect(), ..problem };
    assert!(least_cut(&half).flux < 0.6 * found.flux);
}

/// Where there is no room to solve for as many as it takes, cuts are filled up and the prices that are known prove how good they are.
#[test]
fn out_of_room_every_need_is_met_all_the_same() {
    let problem = large(60_000, 4);
    let (cut, prices) = linear_programme::solve_within(&problem, Duration::from_secs(60), 0);
    for site in 0..4 {
        let fall = problem.fall(site, &cut);
        assert!(fall >= problem.need[site] * (1.0 - 1e-9), "{site}: {fall} {}", problem.need[site]);
    }
    let flux: f64 = cut.iter().zip(&problem.flux).map(|(cut, flux)| cut * flux).sum();
    assert!((1e-9..=flux).contains(&problem.bound(&prices)), "{flux} {prices:?}");
}

#[test]
fn out_of_time_every_need_is_met_all_the_same() {
    let problem = large(60_000, 4);
    let (cut, prices) = linear_programme::solve_within(&problem, Duration::ZERO, usize::MAX);
    assert_eq!(prices, [0.0; 4]);
    for site in 0..4 {
        let fall = problem.fall(site, &cut);
        assert!(fall >= problem.need[site] * (1.0 - 1e-9), "{site}: {fall} {}", problem.need[site]);
    }
    assert!(cut.iter().zip(&problem.most_cut).all(|(cut, most)| (0.0..=*most).contains(cut)));
    let flux: f64 = cut.iter().zip(&problem.flux).map(|(cut, flux)| cut * flux).sum();
    let least = least_cut(&problem).flux;
    assert!((least..2.0 * least).contains(&flux), "{flux} {least}");
}

/// Sites that want nothing cost nothing and what is out of reach takes all.
#[test]
fn extreme_needs_take_nothing_or_all() {
    let problem = Reduction {
        flux: vec![1.0, 2.0, 3.0],
        most_cut: vec![1.0, 0.5, 0.0],
        gain: vec![vec![1.0, 1.0, 1.0], vec![2.0, 1.0, 0.5]].into(),
        need: vec![0.0, -1.0],
    };
    assert_eq!(least_cut(&problem).cut, [0.0; 3]);
    for need in [vec![9.0, 0.0], vec![9.0, 9.0]] {
        let found = least_cut(&Reduction { need, ..problem.clone() });
        for (cut, most) in found.cut.iter().zip(&problem.most_cut) {
            assert!((cut - most).abs() < 1e-6, "{:?}", found.cut);
        }
    }
    assert_eq!(least_cut(&Reduction::default()), LeastCut::default());
    // One site takes all that it sees; the other chooses among the rest.
    let problem = Reduction {
        flux: vec![1.0, 1.0, 1.0, 1.0],
        most_cut: vec![1.0; 4],
        gain: vec![vec![1.0, 1.0, 0.0, 0.0], vec![0.5, 0.0, 2.0, 1.0]].into(),
        need: vec![2.0, 1.5],
    };
    let found = least_cut(&problem);
    assert!(found.cut.iter().zip([1.0, 1.0, 0.5, 0.0]).all(|(a, b)| (a - b).abs() < 1e-9), "{:?}", found.cut);
    assert!((found.least_flux - 2.5).abs() < 1e-9);
}

#[test]
fn thresholds_are_a_ramp_or_a_step() {
    let influence = [0.0, 1.0, 2.0, 3.0, 4.0];
    assert_eq!(threshold_cuts(&influence, 1.0, 3.0, 0.8), [0.0, 0.0, 0.4, 0.8, 0.8]);
    assert_eq!(threshold_cuts(&influence, 2.0, 2.0, 1.0), [0.0, 0.0, 1.0, 1.0, 1.0]);
    assert_eq!(threshold_cuts(&influence, 0.0, 4.0, 0.0), [0.0; 5]);
}

#[test]
fn percentiles_are_linear_between_neighbours() {
    let values = [4.0, 1.0, 3.0, 2.0];
    for (percent, wanted) in [(0.0, 1.0), (100.0, 4.0), (50.0, 2.5), (25.0, 1.75)] {
        assert!((percentile(&values, percent) - wanted).abs() < 1e-12);
    }
    assert_eq!(percentile(&[], 50.0), 0.0);
    assert_eq!(percentile(&[7.0], 90.0), 7.0);
}
