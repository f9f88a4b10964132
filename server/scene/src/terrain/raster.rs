//! One terrain raster: its grid, a mipmap pyramid (Williams 1983) of packed tiles, and a cache of unpacked ones.

use super::border::Border;
use super::max_mipmap::MaxMipmap;
use super::tile::{self, Blob, SAMPLES, SIDE, TileEntry};
use crate::grid::Grid;
use crate::grid_sections;
use crate::sections::{Flaw, Sections};
use skyglow_physics::GeoPoint;
use std::borrow::Cow;
use std::collections::HashMap;
use std::fs::File;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

/// Unpacked tiles by level and number.
type TileCache = HashMap<(usize, usize), Arc<Vec<f32>>>;
/// Maximum number of unpacked tiles in the cache, 64 kB each.
const MAX_CACHED_TILES: usize = 512;

/// Rasters with more samples stay in their file: those of 8 192 × 8 192, and larger.
const MAX_SAMPLES_IN_MEMORY: u64 = (1 << 26) - 1;

/// One raster of elevations.
#[derive(Debug)]
pub(crate) struct TerrainRaster {
    grid: Grid,
    sample_size_m: f64,
    levels: Vec<LevelIndex>,
    blob: Blob,
    cache: Mutex<TileCache>,
    /// Built at the first horizon query, which takes a pass over all samples, where it is not stored.
    maxima: OnceLock<MaxMipmap>,
    /// Whether its tiles stay in their file: each has a checksum, and the maxima are stored.
    stays_in_file: bool,
}

#[derive(Debug, Clone)]
struct LevelIndex {
    width: usize,
    height: usize,
    tiles: Vec<TileEntry>,
    border: Option<Border>,
}

impl LevelIndex {
    fn tile_columns(&self) -> usize {
        self.width.div_ceil(SIDE)
    }
}

impl TerrainRaster {
    /// The raster's grid.
    pub(crate) fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Bytes of memory that it takes, about, once it was asked for horizons: packed and unpacked tiles, and maxima.
    pub(crate) fn byte_count(&self) -> u64 {
        let tiles: usize = self.levels.iter().map(|level| level.tiles.len()).sum();
        let unpacked = tiles.min(MAX_CACHED_TILES) * SAMPLES * size_of::<f32>();
        let samples = u64::from(self.grid.width) * u64::from(self.grid.height);
        (self.blob.byte_count() + unpacked) as u64 + samples / 12
    }

    /// Side of a sample in the middle of the raster, metres.
    pub(crate) fn sample_size_m(&self) -> f64 {
        self.sample_size_m
    }

    /// A sample of a level, metres; `None` for voids and outside.
    pub(crate) fn sample_m(&self, level: usize, column: i64, row: i64) -> Option<f64> {
        self.sample_of_tile_m(level, column, row, &mut None)
    }

    /// The same with the tile that was looked into last: neighbours are mostly in one.
    fn sample_of_tile_m(
        &self,
        level: usize,
        column: i64,
        row: i64,
        last: &mut Option<(usize, Arc<Vec<f32>>)>,
    ) -> Option<f64> {
        let index = &self.levels[level];
        let (column, row) = (usize::try_from(column).ok()?, usize::try_from(row).ok()?);
        if column >= index.width || row >= index.height {
            return None;
        }
        let number = row / SIDE * index.tile_columns() + column / SIDE;
        if index.tiles[number].length == 0 {
            return None;
        }
        let (_, samples) = match last {
            Some(known) if known.0 == number => known,
            other => other.insert((number, self.tile(level, number))),
        };
        let value = samples[row % SIDE * SIDE + column % SIDE];
        value.is_finite().then_some(f64::from(value))
    }

    /// The highest samples by blocks. The first call takes a pass over all samples.
    pub(super) fn maxima(&self) -> &MaxMipmap {
        let border = self.levels[0].border.as_ref();
        self.maxima.get_or_init(|| MaxMipmap::new(&self.grid, border, |number| self.unpacked(number)))
    }

    /// Whether [`Self::maxima`] was built.
    #[cfg(test)]
    pub(super) fn has_maxima(&self) -> bool {
        self.maxima.get().is_some()
    }

    /// Tiles along a row of tiles of the finest level.
    pub(super) fn tile_columns(&self) -> usize {
        self.levels[0].tile_columns()
    }

    /// The samples of a tile of the finest level, unpacked past the cache; `None` for one that is all void.
    fn unpacked(&self, number: usize) -> Option<Vec<f32>> {
        let entry = &self.levels[0].tiles[number];
        if entry.length == 0 { None } else { self.blob.unpack(entry).ok() }
    }

    /// A level, the coarsest where there are not so many, and its columns and rows.
    pub(super) fn level_size(&self, level: usize) -> (usize, (usize, usize)) {
        let level = level.min(self.levels.len() - 1);
        (level, (self.levels[level].width, self.levels[level].height))
    }

    /// The samples of a tile of a level, from the cache; `None` for one that is all void.
    pub(super) fn cached(&self, level: usize, number: usize) -> Option<Arc<Vec<f32>>> {
        (self.levels[level].tiles[number].length > 0).then(|| self.tile(level, number))
    }

    /// How many levels there are.
    pub(super) fn level_count(&self) -> usize {
        self.levels.len()
    }

    /// Sets what lies around each level; before anybody asks for [`Self::maxima`].
    pub(super) fn set_borders(&mut self, borders: Vec<Option<Border>>) {
        for (level, border) in self.levels.iter_mut().zip(borders) {
            level.border = border;
        }
    }

    /// Empties the cache of unpacked tiles.
    pub(super) fn forget_tiles(&self) {
        self.lock().clear();
    }

    /// A sample just outside of a level by the rasters around it, metres; NaN where there is none.
    pub(super) fn border_m(&self, level: usize, column: i64, row: i64) -> f32 {
        self.levels[level].border.as_ref().map_or(f32::NAN, |border| border.height_m(column, row))
    }

    fn lock(&self) -> MutexGuard<'_, TileCache> {
        // The map is valid whatever a panicking holder was doing.
        self.cache.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn tile(&self, level: usize, number: usize) -> Arc<Vec<f32>> {
        if let Some(samples) = self.lock().get(&(level, number)) {
            return Arc::clone(samples);
        }
        // The checksum of a file that was read whole was verified, so that a tile that does not unpack is not met; one that stays in
        // the file may have been altered since, and counts as void.
        let unpacked = self.blob.unpack(&self.levels[level].tiles[number]);
        let samples = Arc::new(unpacked.unwrap_or_else(|_| vec![f32::NAN; SAMPLES]));
        let mut cache = self.lock();
        if cache.len() >= MAX_CACHED_TILES {
            cache.clear();
        }
        cache.insert((level, number), Arc::clone(&samples));
        samples
    }

    /// [`Self::bilinear_m`] of an overview whose samples are not much finer than `resolution_m`.
    pub(crate) fn overview_m(&self, place: GeoPoint, resolution_m: f64) -> Option<f64> {
        let ratio = (resolution_m / self.sample_size_m).max(1.0);
        self.bilinear_m(ratio.log2().round() as usize, place)
    }

    /// Elevation at a place, metres, bilinear between the samples of a level and those around it (clamped to those there are).
    /// Voids are left out of the mean while they have less than half of the weight.
    pub(crate) fn bilinear_m(&self, level: usize, place: GeoPoint) -> Option<f64> {
        let level = level.min(self.levels.len() - 1);
        let (column, row) = self.grid.position_of(place)?;
        let size = f64::from(1u32 << level);
        let (x, y) = (column / size - 0.5, row / size - 0.5);
        let (x0, y0) = (x.floor(), y.floor());
        let (s, t) = (x - x0, y - y0);
        let (mut sum, mut total, mut last) = (0.0, 0.0, None);
        for (dc, dr, weight) in
            [(0, 0, (1.0 - s) * (1.0 - t)), (1, 0, s * (1.0 - t)), (0, 1, (1.0 - s) * t), (1, 1, s * t)]
        {
            if weight == 0.0 {
                continue;
            }
            let (column, row) = (x0 as i64 + dc, y0 as i64 + dr);
            let inside = self.clamped(level, column, row);
            let border_m = if inside == (column, row) { f32::NAN } else { self.border_m(level, column, row) };
            let elevation_m = if border_m.is_finite() {
                Some(f64::from(border_m))
            } else {
                // Where no raster lies, half a sample at the edge belongs to the edge sample.
                self.sample_of_tile_m(level, inside.0, inside.1, &mut last)
            };
            if let Some(elevation_m) = elevation_m {
                sum += weight * elevation_m;
                total += weight;
            }
        }
        (total >= 0.5).then(|| sum / total)
    }

    fn clamped(&self, level: usize, column: i64, row: i64) -> (i64, i64) {
        let index = &self.levels[level];
        (column.clamp(0, index.width as i64 - 1), row.clamp(0, index.height as i64 - 1))
    }

    /// The sections to store for layer `number`.
    pub(super) fn to_sections(&self, number: usize) -> Vec<(String, Cow<'_, [u8]>)> {
        let mut sections = grid_sections::to_sections(&self.grid, &format!("{number}"));
        for (level, index) in self.levels.iter().enumerate() {
            sections
                .push((format!("tiles{number}.{level}"), Cow::Borrowed(bytemuck::cast_slice(&index.tiles))));
        }
        sections
            .push((format!("levels{number}"), Cow::Owned((self.levels.len() as u32).to_le_bytes().to_vec())));
        if self.levels.iter().any(|level| level.border.is_some()) {
            let mut around: Vec<f32> = Vec::new();
            for index in &self.levels {
                match &index.border {
                    Some(border) => around.extend(border.samples()),
                    None => around.resize(around.len() + Border::len((index.width, index.height)), f32::NAN),
                }
            }
            sections.push((format!("border{number}"), Cow::Owned(bytemuck::cast_slice(&around).to_vec())));
        }
        if let Blob::Memory(blob) = &self.blob {
            if self.stays_in_file {
                sections.push((format!("highest{number}"), Cow::Borrowed(self.maxima().lowest_bytes())));
                sections.push((format!("outside{number}"), Cow::Borrowed(blob)));
            } else {
                sections.push((format!("blob{number}"), Cow::Borrowed(blob)));
            }
        }
        sections
    }

    /// Undoes [`Self::to_sections`].
    ///
    /// * `file`: in which large sections stay.
    pub(super) fn from_sections(
        sections: &Sections<'_>,
        number: usize,
        file: Option<&File>,
    ) -> Result<Self, Flaw> {
        let grid = grid_sections::from_sections(sections, &format!("{number}"))?;
        let count = *sections.numbers::<u32>(&format!("levels{number}"))?.first().ok_or("has no levels")?;
        let mut levels = Vec::new();
        let (mut width, mut height) = (grid.width as usize, grid.height as usize);
        for level in 0..count as usize {
            let tiles = sections.numbers::<TileEntry>(&format!("tiles{number}.{level}"))?;
            if tiles.len() != width.div_ceil(SIDE) * height.div_ceil(SIDE) {
                return Err(format!("has a wrong number of tiles in level {level}"));
            }
            levels.push(LevelIndex { width, height, tiles, border: None });
            (width, height) = (width.div_ceil(2), height.div_ceil(2));
        }
        if levels.is_empty() {
            return Err("has no levels".to_owned());
        }
        if sections.has(&format!("border{number}")) {
            let around = sections.numbers::<f32>(&format!("border{number}"))?;
            let mut rest = &around[..];
            for level in &mut levels {
                let size = (level.width, level.height);
                let (own, others) =
                    rest.split_at_checked(Border::len(size)).ok_or("has too few samples around it")?;
                level.border = Border::of_samples(size, own.to_vec());
                rest = others;
            }
        }
        let name = format!("outside{number}");
        let blob = match (sections.outside(&name), file) {
            (Some(outside), Some(file)) => {
                let file = file.try_clone().map_err(|error| format!("cannot be opened ({error})"))?;
                Blob::File(file, outside.start)
            }
            _ if sections.has(&name) => Blob::Memory(sections.bytes(&name)?.into_owned()),
            _ => Blob::Memory(sections.bytes(&format!("blob{number}"))?.into_owned()),
        };
        let maxima = OnceLock::new();
        let highest = format!("highest{number}");
        if sections.has(&highest) {
            let lowest = MaxMipmap::of_lowest(&grid, sections.numbers(&highest)?);
            let _first = maxima.set(lowest.ok_or("holds bounds that do not fit its terrain")?);
        }
        let sample_size_m = grid.pixel_size_m();
        let stays_in_file = sections.has(&highest);
        Ok(Self { grid, sample_size_m, levels, blob, cache: Mutex::default(), maxima, stays_in_file })
    }
}

/// Takes the rows of a raster from the top and packs them.
pub(crate) struct TerrainRasterBuilder {
    layer: TerrainRaster,
    blob: Vec<u8>,
    rows: Vec<f32>,
}

impl TerrainRasterBuilder {
    pub(crate) fn new(grid: Grid) -> Self {
        let level = LevelIndex { width: grid.width as usize, height: 0, tiles: Vec::new(), border: None };
        let sample_size_m = grid.pixel_size_m();
        let stays_in_file = u64::from(grid.width) * u64::from(grid.height) > MAX_SAMPLES_IN_MEMORY;
        let layer = TerrainRaster {
            grid,
            sample_size_m,
            levels: vec![level],
            blob: Blob::Memory(Vec::new()),
            cache: Mutex::default(),
            maxima: OnceLock::new(),
            stays_in_file,
        };
        Self { layer, blob: Vec::new(), rows: Vec::new() }
    }

    /// Adds one row, metres; NaN is void.
    pub(crate) fn push_row(&mut self, row: &[f32]) -> Result<(), std::io::Error> {
        self.rows.extend_from_slice(row);
        self.layer.levels[0].height += 1;
        if self.layer.levels[0].height.is_multiple_of(SIDE) { self.pack_rows() } else { Ok(()) }
    }

    fn pack_rows(&mut self) -> Result<(), std::io::Error> {
        let width = self.layer.levels[0].width;
        for column in (0..width).step_by(SIDE) {
            let mut samples = [f32::NAN; SAMPLES];
            for (to, from) in samples.chunks_exact_mut(SIDE).zip(self.rows.chunks_exact(width)) {
                let count = SIDE.min(width - column);
                to[..count].copy_from_slice(&from[column..column + count]);
            }
            let entry = self.layer.pack_tile(&samples, &mut self.blob)?;
            self.layer.levels[0].tiles.push(entry);
        }
        self.rows.clear();
        Ok(())
    }

    /// Packs the rest and the overviews: each level's samples are the means of the valid ones of 2 × 2.
    pub(crate) fn finish(mut self) -> Result<TerrainRaster, std::io::Error> {
        if !self.rows.is_empty() {
            self.pack_rows()?;
        }
        let mut layer = self.layer;
        let mut blob = self.blob;
        loop {
            let level = layer.levels.len() - 1;
            let below = &layer.levels[level];
            if below.width <= SIDE && below.height <= SIDE {
                layer.blob = Blob::Memory(blob);
                return Ok(layer);
            }
            let (width, height) = (below.width.div_ceil(2), below.height.div_ceil(2));
            layer.blob = Blob::Memory(blob);
            let mut tiles = Vec::new();
            let mut fresh = Vec::new();
            let base = layer.blob.byte_count() as u64;
            for row in (0..height).step_by(SIDE) {
                for column in (0..width).step_by(SIDE) {
                    let mut entry = layer.pack_tile(&layer.halved(level, column, row), &mut fresh)?;
                    entry.start += base;
                    tiles.push(entry);
                }
            }
            blob = match std::mem::replace(&mut layer.blob, Blob::Memory(Vec::new())) {
                Blob::Memory(blob) => blob,
                Blob::File(..) => Vec::new(),
            };
            blob.append(&mut fresh);
            layer.levels.push(LevelIndex { width, height, tiles, border: None });
        }
    }
}

impl TerrainRaster {
    /// Packs a tile behind `blob`.
    fn pack_tile(&self, samples: &[f32], blob: &mut Vec<u8>) -> Result<TileEntry, std::io::Error> {
        let mut entry = tile::pack(samples, blob)?;
        if self.stays_in_file && entry.length > 0 {
            entry.checksum = tile::checksum(&blob[entry.start as usize..]);
        }
        Ok(entry)
    }

    /// The tile of the next level up that starts at (column, row) there.
    fn halved(&self, level: usize, column: usize, row: usize) -> Vec<f32> {
        let mean = |i: usize| {
            let (c, r) = (2 * (column + i % SIDE) as i64, 2 * (row + i / SIDE) as i64);
            let four = [(c, r), (c + 1, r), (c, r + 1), (c + 1, r + 1)];
            let (sum, count) = four
                .iter()
                .filter_map(|&(c, r)| self.sample_m(level, c, r))
                .fold((0.0, 0.0), |(sum, count), h| (sum + h, count + 1.0));
            if count > 0.0 { (sum / count) as f32 } else { f32::NAN }
        };
        (0..SAMPLES).map(mean).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::GeographicAxes;
    use crate::sections::{self, Inside};
    use crate::terrain::Terrain;
    use std::io::Write;

    const SIZE: (u32, u32) = (300, 260);

    fn terrain() -> Terrain {
        let axes = GeographicAxes {
            first_longitude_deg: 7.0,
            first_latitude_deg: 47.0,
            longitude_step_deg: 0.01,
            latitude_step_deg: -0.01,
        };
        let mut builder = TerrainRasterBuilder::new(Grid::geographic(axes, SIZE.0, SIZE.1));
        builder.layer.stays_in_file = true;
        for row in 0..SIZE.1 {
            let height = |column: u32| 900.0 + 700.0 * ((column * row) as f32 / 999.0).sin();
            let row: Vec<f32> =
                (0..SIZE.0).map(|c| if (c + row) % 97 == 0 { f32::NAN } else { height(c) }).collect();
            builder.push_row(&row).unwrap();
        }
        Terrain::new(vec![builder.finish().unwrap()])
    }

    fn written(bytes: &[u8]) -> File {
        let mut file = tempfile::tempfile().unwrap();
        file.write_all(bytes).unwrap();
        file
    }

    fn opened(bytes: &[u8]) -> Result<Terrain, Flaw> {
        let file = written(bytes);
        let inside = Inside::read(&file).unwrap()?.unwrap();
        Terrain::from_sections(&inside.sections(), Some(&file))
    }

    /// All samples of all levels, row by row.
    fn samples(terrain: &Terrain) -> Vec<Option<u64>> {
        let raster = &terrain.rasters[0];
        let of_level = |level: usize| {
            let (width, height) = (raster.levels[level].width as i64, raster.levels[level].height as i64);
            (0..height).flat_map(move |row| {
                (0..width).map(move |column| raster.sample_m(level, column, row).map(f64::to_bits))
            })
        };
        (0..raster.levels.len()).flat_map(of_level).collect()
    }

    /// Terrain of which the tiles stay in the file is the same, with its bounds known from the start.
    #[test]
    fn terrain_in_its_file_is_the_same() {
        let terrain = terrain();
        let bytes = sections::pack(&terrain.to_sections()).unwrap();
        let in_file = opened(&bytes).unwrap();
        assert!(in_file.rasters[0].has_maxima() && in_file.byte_count() < terrain.byte_count());
        assert_eq!(samples(&in_file), samples(&terrain));
        let whole = Terrain::from_sections(&Sections::parse(&bytes).unwrap(), None).unwrap();
        assert_eq!(samples(&whole), samples(&terrain));
        let bounds = |terrain: &Terrain| {
            let maxima = terrain.rasters[0].maxima();
            let of = |at: usize| maxima.max_over_m(at..=at + 20, at..=at + 3).to_bits();
            (0..250).map(of).chain([maxima.highest_m().to_bits()]).collect::<Vec<_>>()
        };
        let fresh = TerrainRaster { maxima: OnceLock::new(), ..terrain.rasters.into_iter().next().unwrap() };
        assert_eq!(bounds(&in_file), bounds(&Terrain::new(vec![fresh])));
    }

    /// An altered tile is void, and the others are as they were; what is read at once is refused where it was altered.
    #[test]
    fn altered_tiles_are_void() {
        let terrain = terrain();
        let mut bytes = sections::pack(&terrain.to_sections()).unwrap();
        let file = written(&bytes);
        let inside = Inside::read(&file).unwrap().unwrap().unwrap();
        let at = inside.sections().outside("outside0").unwrap().start as usize;
        bytes[at + 9] ^= 1;
        let altered = samples(&opened(&bytes).unwrap());
        let differing = samples(&terrain).iter().zip(&altered).filter(|(a, b)| a != b).count();
        assert!(differing > SAMPLES / 2 && differing <= SAMPLES, "{differing}");
        assert!(opened(&bytes[..at + 20]).is_err());
        bytes[at - 3] ^= 1;
        assert!(opened(&bytes).unwrap_err().contains("altered"));
    }
}
