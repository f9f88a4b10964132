//! The reference of a sky with each lobe apart: one file serves every mix of lobes and every lamp.

use serde::{Deserialize, Serialize};
use skyglow_physics::{BAND_COUNT, EmissionMix, LOBE_COUNT, direct_sum::GridSample};
use std::{
    fs::File,
    io,
    path::{Path, PathBuf},
};

/// How the names of reference files end: JSON, packed.
const FILE_ENDING: &str = ".json.zst";

/// Lights of one sky, per watt of flux in the band as if all of the raster's were in it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct LobeReference {
    /// A class of places, or a scene.
    pub name: String,
    /// Latitude and longitude in the scene, degrees; None in a class.
    pub place_deg: Option<[f64; 2]>,
    /// Altitude of the observer's eye, metres.
    pub observer_altitude_m: f64,
    /// Turbidity.
    pub turbidity: f64,
    /// Lambertian albedo of the ground.
    pub ground_albedo: f64,
    /// How many point sources were summed.
    pub sources: usize,
    /// Their flux, DNB watts.
    pub flux_dnb_w: f64,
    /// How long it took, seconds.
    pub seconds: f64,
    /// Directions.
    pub samples: Vec<GridSample>,
    /// First order, W m⁻² sr⁻¹, `[direction][band × lobe]`.
    pub first_w_m2_sr: Vec<Vec<f64>>,
    /// All later orders, as `first_w_m2_sr`.
    pub later_w_m2_sr: Vec<Vec<f64>>,
}

impl LobeReference {
    /// Reads a file of [`Self::write`].
    ///
    /// # Errors
    /// What the file system, unpacking or JSON says.
    pub fn read(path: &Path) -> io::Result<Self> {
        Ok(serde_json::from_slice(&zstd::decode_all(File::open(path)?)?)?)
    }

    /// Writes a file whose name is one of [`file_name`].
    ///
    /// # Errors
    /// What the file system says.
    pub fn write(&self, path: &Path) -> io::Result<()> {
        std::fs::write(path, zstd::encode_all(serde_json::to_vec(self)?.as_slice(), 19)?)
    }

    /// Reference filess in a folder, by name.
    ///
    /// # Errors
    /// What the file system says.
    pub fn files_in(folder: &Path) -> io::Result<Vec<PathBuf>> {
        let entries = std::fs::read_dir(folder)?.map(|entry| Ok(entry?.path()));
        let mut files = entries.collect::<io::Result<Vec<PathBuf>>>()?;
        files.retain(|path| path.to_string_lossy().ends_with(FILE_ENDING));
        files.sort();
        Ok(files)
    }

    /// Radiance of all orders, W m⁻² sr⁻¹, of a mix of lobes and a lamp.
    pub fn mixed_w_m2_sr(
        &self,
        emission: EmissionMix,
        flux_per_dnb_flux: [f64; BAND_COUNT],
    ) -> Vec<[f64; BAND_COUNT]> {
        let sum = |(first, later): (&Vec<f64>, &Vec<f64>)| {
            std::array::from_fn(|band| {
                let lobes = emission.weights().into_iter().enumerate();
                let of_lobe = |lobe: usize| first[band * LOBE_COUNT + lobe] + later[band * LOBE_COUNT + lobe];
                flux_per_dnb_flux[band] * lobes.map(|(lobe, weight)| weight * of_lobe(lobe)).sum::<f64>()
            })
        };
        self.first_w_m2_sr.iter().zip(&self.later_w_m2_sr).map(sum).collect()
    }
}

/// What the file of a reference is called.
pub fn file_name(name: &str, observer_altitude_m: f64, turbidity: f64) -> String {
    format!("{name}-{observer_altitude_m:.0}m-t{turbidity:.2}{FILE_ENDING}")
}

/// A number as far as the reference is known.
pub fn seven_digits(value: f64) -> f64 {
    format!("{value:.6e}").parse().unwrap_or(value)
}
