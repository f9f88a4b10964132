//! Interpolation between uneven nodes.

/// Lagrange interpolation at `x` over the `taps` nodes nearest to it (fewer where there are fewer): pairs
/// (node, weight), weights summing to 1. `x` is clamped to the range of the nodes, which must ascend.
pub fn lagrange_taps(nodes: &[f64], x: f64, taps: usize) -> Vec<(usize, f64)> {
    let taps = taps.min(nodes.len());
    let (first, last) = (nodes[0], nodes[nodes.len() - 1]);
    let x = x.clamp(first, last);
    let upper = nodes.partition_point(|&node| node <= x).clamp(1, nodes.len().max(2) - 1);
    let start = upper.saturating_sub(taps.div_ceil(2)).min(nodes.len() - taps);
    (start..start + taps)
        .map(|j| {
            let weight = (start..start + taps)
                .filter(|&k| k != j)
                .map(|k| (x - nodes[k]) / (nodes[j] - nodes[k]))
                .product();
            (j, weight)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn taps_clamp_at_the_ends_and_use_what_nodes_there_are() {
        assert_eq!(lagrange_taps(&[1.0, 2.0], 5.0, 4), vec![(0, 0.0), (1, 1.0)]);
        assert_eq!(lagrange_taps(&[3.0], 5.0, 4), vec![(0, 1.0)]);
    }
}
