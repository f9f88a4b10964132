//! Formats of the answers that come in several, and which one an Accept header prefers.

use crate::parameters::{
    CompactParameters, GridParameters, PanoramaParameters, Parameter, ParameterSet, RasterParameters,
    WebPParameters,
};

/// A format of a panorama.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// PNG.
    Png,
    /// Lossless WebP.
    WebP,
    /// OpenEXR.
    Exr,
    /// TIFF.
    Tiff,
    /// JSON.
    Json,
    /// The compact panorama.
    Sky,
}

/// All media types, for the refusal.
pub const OFFERED: &str =
    "image/png, image/webp, image/x-exr, image/tiff, application/json or application/vnd.skyglow.sky";

impl Format {
    /// In the order preferred where a client does not care.
    const ALL: [Format; 6] =
        [Format::Png, Format::WebP, Format::Json, Format::Exr, Format::Tiff, Format::Sky];

    /// Its media type.
    pub const fn media_type(self) -> &'static str {
        match self {
            Format::Png => "image/png",
            Format::WebP => "image/webp",
            Format::Exr => "image/x-exr",
            Format::Tiff => "image/tiff",
            Format::Json => "application/json",
            Format::Sky => "application/vnd.skyglow.sky",
        }
    }

    /// The parameters that mean something for it.
    pub const fn parameters(self) -> &'static [Parameter] {
        match self {
            Format::Png => PanoramaParameters::ALL,
            Format::WebP => WebPParameters::ALL,
            Format::Exr | Format::Tiff => RasterParameters::ALL,
            Format::Json => GridParameters::ALL,
            Format::Sky => CompactParameters::ALL,
        }
    }

    /// The end of its URL.
    pub const fn extension(self) -> &'static str {
        match self {
            Format::Png => "png",
            Format::WebP => "webp",
            Format::Exr => "exr",
            Format::Tiff => "tif",
            Format::Json => "json",
            Format::Sky => "sky",
        }
    }
}

/// A format of a map of influences.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InfluenceFormat {
    /// JSON: the most influential pixels and totals.
    Json,
    /// GeoTIFF of all pixels.
    Tiff,
    /// GeoJSON of the most influential pixels.
    GeoJson,
    /// CSV of the most influential pixels.
    Csv,
}

/// All media types of influences, for the refusal.
pub const INFLUENCES_OFFERED: &str = "application/json, image/tiff, application/geo+json or text/csv";

impl InfluenceFormat {
    /// In the order preferred where a client does not care.
    const ALL: [InfluenceFormat; 4] =
        [InfluenceFormat::Json, InfluenceFormat::GeoJson, InfluenceFormat::Csv, InfluenceFormat::Tiff];

    /// Its media type.
    pub const fn media_type(self) -> &'static str {
        match self {
            InfluenceFormat::Json => "application/json",
            InfluenceFormat::Tiff => "image/tiff",
            InfluenceFormat::GeoJson => "application/geo+json",
            InfluenceFormat::Csv => "text/csv",
        }
    }

    /// The end of its URL.
    pub const fn extension(self) -> &'static str {
        match self {
            InfluenceFormat::Json => "json",
            InfluenceFormat::Tiff => "tif",
            InfluenceFormat::GeoJson => "geojson",
            InfluenceFormat::Csv => "csv",
        }
    }

    /// The one whose URL ends so.
    pub fn from_extension(extension: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|format| format.extension() == extension)
    }

    /// Whether it says what some lights do together.
    pub const fn has_room_for_sums(self) -> bool {
        matches!(self, InfluenceFormat::Json | InfluenceFormat::GeoJson)
    }

    /// Whether it lists the most influential pixels instead of showing all.
    pub const fn is_list(self) -> bool {
        !matches!(self, InfluenceFormat::Tiff)
    }
}

/// The format of a panorama that an Accept header (RFC 9110) prefers; None where it takes none. No header takes anything.
pub fn negotiate(accept: &str) -> Option<Format> {
    preferred(accept, &Format::ALL, Format::media_type)
}

/// The same for influences.
pub fn negotiate_influence(accept: &str) -> Option<InfluenceFormat> {
    preferred(accept, &InfluenceFormat::ALL, InfluenceFormat::media_type)
}

/// The preferred one of some formats, which are in the order of those who do not care.
fn preferred<F: Copy>(accept: &str, formats: &[F], media_type: impl Fn(F) -> &'static str) -> Option<F> {
    if accept.trim().is_empty() {
        return formats.first().copied();
    }
    let ranges: Vec<(String, f64)> = accept
        .split(',')
        .filter_map(|part| {
            let mut pieces = part.split(';').map(str::trim);
            let range = pieces.next().filter(|range| !range.is_empty())?.to_ascii_lowercase();
            let quality = pieces
                .filter_map(|piece| piece.strip_prefix("q=").or_else(|| piece.strip_prefix("Q=")))
                .find_map(|text| text.parse::<f64>().ok())
                .unwrap_or(1.0);
            Some((range, if quality.is_nan() { 0.0 } else { quality.clamp(0.0, 1.0) }))
        })
        .collect();
    let mut best: Option<(F, f64)> = None;
    for &format in formats {
        let media_type = media_type(format);
        let (kind, _) = media_type.split_once('/').unwrap_or_default();
        // The most specific range that covers the format decides.
        let quality = [media_type.to_owned(), format!("{kind}/*"), "*/*".to_owned()]
            .iter()
            .find_map(|covering| ranges.iter().find(|(range, _)| range == covering))
            .map_or(0.0, |(_, quality)| *quality);
        if quality > 0.0 && best.is_none_or(|(_, best)| quality > best) {
            best = Some((format, quality));
        }
    }
    best.map(|(format, _)| format)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The preferred format wins and nothing acceptable is none.
    #[test]
    fn the_preferred_format_wins() {
        for (accept, format) in [
            ("", Some(Format::Png)),
            ("*/*", Some(Format::Png)),
            ("application/json", Some(Format::Json)),
            ("image/png;q=0.1, image/webp", Some(Format::WebP)),
            ("image/*;q=0.5, application/json;q=0.9", Some(Format::Json)),
            ("IMAGE/X-EXR", Some(Format::Exr)),
            ("application/vnd.skyglow.sky, image/png;q=0.9", Some(Format::Sky)),
            ("image/*, image/png;q=0", Some(Format::WebP)),
            ("text/html", None),
            ("image/png;q=0", None),
            (";;;,,,q=", None),
            ("text/html,application/xhtml+xml,image/avif,image/webp,*/*;q=0.8", Some(Format::WebP)),
        ] {
            assert_eq!(negotiate(accept), format, "{accept}");
        }
    }

    /// Influences are json unless another is preferred.
    #[test]
    fn influences_are_json_by_default() {
        for (accept, format) in [
            ("", Some(InfluenceFormat::Json)),
            ("*/*", Some(InfluenceFormat::Json)),
            ("text/*", Some(InfluenceFormat::Csv)),
            ("application/geo+json, application/json;q=0.9", Some(InfluenceFormat::GeoJson)),
            ("image/tiff", Some(InfluenceFormat::Tiff)),
            ("image/png", None),
        ] {
            assert_eq!(negotiate_influence(accept), format, "{accept}");
        }
    }
}
