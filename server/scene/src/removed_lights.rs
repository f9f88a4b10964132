//! The lights of a layer that a change removed, and the blocks of its pyramid that have some: bit sets.

use crate::light_pyramid::LightPyramid;

/// Lights that are removed, by index, and the blocks with such lights in them: a bit each.
#[derive(Clone, Debug)]
pub(crate) struct RemovedLights {
    count: usize,
    lights: Bits,
    /// Blocks with some lights removed, and those with all removed, from level 1 up.
    levels: Vec<(Bits, Bits)>,
}

#[derive(Clone, Debug)]
struct Bits(Vec<u64>);

impl Bits {
    fn new(count: usize) -> Self {
        Self(vec![0; count.div_ceil(64)])
    }

    fn set(&mut self, index: usize) {
        self.0[index / 64] |= 1 << (index % 64);
    }

    #[inline(always)]
    fn has(&self, index: usize) -> bool {
        self.0[index / 64] >> (index % 64) & 1 == 1
    }
}

impl RemovedLights {
    /// * `removed`: indices of lights, ascending; `light_count` of all.
    pub(crate) fn new(pyramid: &LightPyramid, light_count: usize, removed: &[usize]) -> Self {
        let mut lights = Bits::new(light_count);
        removed.iter().for_each(|&light| lights.set(light));
        let mut levels: Vec<(Bits, Bits)> = Vec::new();
        let mut touched_below = removed.to_vec();
        for number in 1..=pyramid.top() {
            let level = pyramid.level(number);
            let (mut some, mut all) = (Bits::new(level.blocks.len()), Bits::new(level.blocks.len()));
            // Blocks in the order of their children: one pass.
            let parent_of =
                |child: usize| level.blocks.partition_point(|block| block.first_child as usize <= child) - 1;
            let mut parents: Vec<usize> = touched_below.iter().map(|&child| parent_of(child)).collect();
            parents.dedup();
            for &parent in &parents {
                some.set(parent);
                let is_removed =
                    |child: usize| levels.last().map_or_else(|| lights.has(child), |(_, all)| all.has(child));
                if level.children(parent).all(is_removed) {
                    all.set(parent);
                }
            }
            levels.push((some, all));
            touched_below = parents;
        }
        Self { count: removed.len(), lights, levels }
    }

    /// Bytes held.
    pub(crate) fn byte_count(&self) -> usize {
        let bits = |bits: &Bits| bits.0.len() * size_of::<u64>();
        bits(&self.lights) + self.levels.iter().map(|(some, all)| bits(some) + bits(all)).sum::<usize>()
    }

    /// Number of lights removed.
    pub(crate) fn len(&self) -> usize {
        self.count
    }

    /// Whether a light is removed.
    pub(crate) fn is_removed(&self, light: usize) -> bool {
        self.lights.has(light)
    }

    /// Whether lights of a block are removed, some or all.
    pub(crate) fn is_touched(&self, level: usize, block: usize) -> bool {
        self.levels[level - 1].0.has(block)
    }

    /// Whether all lights of a block are removed.
    pub(crate) fn is_empty_block(&self, level: usize, block: usize) -> bool {
        self.levels[level - 1].1.has(block)
    }
}
