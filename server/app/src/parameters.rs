//! The query parameters: one table that both the parser and the OpenAPI document read.

use skyglow_celestial::time;
use skyglow_physics::Turbidity;
use utoipa::openapi::{
    Required, Type,
    path::{Parameter as ApiParameter, ParameterBuilder, ParameterIn},
    schema::{KnownFormat, ObjectBuilder, SchemaFormat},
};

/// What values a parameter takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A finite number in a range.
    Number {
        /// Smallest allowed.
        minimum: f64,
        /// Largest allowed.
        maximum: f64,
        /// Unit, with its leading space; empty for pure numbers.
        unit: &'static str,
    },
    /// A whole number in a range.
    Integer {
        /// Smallest allowed.
        minimum: u32,
        /// Largest allowed.
        maximum: u32,
    },
    /// One of some words.
    Choice(&'static [&'static str]),
    /// Text with a form of its own.
    Text {
        /// The form, in words.
        allowed: &'static str,
        /// The form as a regular expression: whatever is allowed matches it, and most of what is not does not.
        pattern: &'static str,
    },
}

/// One query parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Its name.
    pub name: &'static str,
    /// What values it takes.
    pub kind: Kind,
    /// Its default as text; empty where there is none.
    pub default: &'static str,
    /// Whether it must be given.
    pub required: bool,
    /// What it means.
    pub description: &'static str,
}

impl Parameter {
    /// What is allowed, in words.
    pub fn allowed(&self) -> String {
        match self.kind {
            Kind::Number { minimum, maximum, unit } => format!("{minimum} to {maximum}{unit}"),
            Kind::Integer { minimum, maximum } => format!("a whole number from {minimum} to {maximum}"),
            Kind::Choice(words) => words.join(", "),
            Kind::Text { allowed, .. } => allowed.to_owned(),
        }
    }

    /// The same without a default of its own in the document, whose words say it instead: clients that were generated from the
    /// document send every default, and this one is refused beside some of the others.
    pub(crate) fn with_default_in_words(&self) -> ApiParameter {
        let mut parameter = Parameter { default: "", ..*self }.openapi();
        if !self.default.is_empty() {
            let words = parameter.description.unwrap_or_default();
            parameter.description = Some(format!("{words} Default: {}.", self.default));
        }
        parameter
    }

    /// The parameter as OpenAPI says it.
    pub fn openapi(&self) -> ApiParameter {
        if !self.default.is_empty() && CONDITIONAL.iter().any(|other| other.name == self.name) {
            return self.with_default_in_words();
        }
        let default = (!self.default.is_empty()).then(|| match self.kind {
            Kind::Number { .. } => {
                self.default.parse::<f64>().map_or_else(|_| self.default.into(), serde_json::Value::from)
            }
            Kind::Integer { .. } => {
                self.default.parse::<u32>().map_or_else(|_| self.default.into(), serde_json::Value::from)
            }
            _ => serde_json::Value::from(self.default),
        });
        let schema = match self.kind {
            Kind::Number { minimum, maximum, .. } => ObjectBuilder::new()
                .schema_type(Type::Number)
                .format(Some(SchemaFormat::KnownFormat(KnownFormat::Double)))
                .minimum(Some(minimum))
                .maximum(Some(maximum)),
            Kind::Integer { minimum, maximum } => ObjectBuilder::new()
                .schema_type(Type::Integer)
                .minimum(Some(f64::from(minimum)))
                .maximum(Some(f64::from(maximum))),
            Kind::Choice(words) => {
                ObjectBuilder::new().schema_type(Type::String).enum_values(Some(words.iter().copied()))
            }
            Kind::Text { pattern, .. } => {
                ObjectBuilder::new().schema_type(Type::String).pattern(Some(pattern))
            }
        };
        ParameterBuilder::new()
            .name(self.name)
            .parameter_in(ParameterIn::Query)
            .required(if self.required { Required::True } else { Required::False })
            .description(Some(format!("{} Allowed: {}.", self.description, self.allowed())))
            .schema(Some(schema.default(default).build()))
            .build()
    }
}

macro_rules! parameters {
    ($($(#[doc = $doc:literal])+ $constant:ident = $name:literal, $kind:expr, $default:literal, $required:literal;)*) => {
        $($(#[doc = $doc])+ pub const $constant: Parameter = Parameter {
            name: $name, kind: $kind, default: $default, required: $required,
            description: parameters!(@trim $($doc)+),
        };)*
    };
    (@trim $first:literal $($rest:literal)*) => { concat!($first $(, $rest)*).trim_ascii() };
}

const DEGREES: &str = " degrees";
const A_NUMBER: &str = "^-?[0-9.]+([eE][+-]?[0-9]+)?$";
/// Most basis functions that a table pack is made with; the resident ones may have fewer.
pub const MAX_BASIS_FUNCTIONS: u32 = 256;
/// Highest number of a pattern of clouds.
pub const MAX_CLOUD_PATTERN: u32 = 65_535;

parameters! {
    /// Latitude of the place, WGS84.
    LAT = "lat", Kind::Number { minimum: -90.0, maximum: 90.0, unit: DEGREES }, "", true;
    /// Longitude of the place, WGS84.
    LON = "lon", Kind::Number { minimum: -180.0, maximum: 360.0, unit: DEGREES }, "", true;
    /// Height of the observer above the ground; the resident packs narrow the range.
    HEIGHT = "height", Kind::Number { minimum: 0.0, maximum: 100_000.0, unit: " m" }, "2", false;
    /// Altitude of the observer above sea level, instead of terrain and height; below 0 counts as 0. The resident packs narrow the range.
    ALTITUDE = "altitude", Kind::Number { minimum: -1000.0, maximum: 100_000.0, unit: " m" }, "", false;
    /// Turbidity at sea level: 1 is clean air, 2.5 a clear night, 6 haze. The resident packs of the scattering narrow the range.
    TURBIDITY = "turbidity", Kind::Number { minimum: Turbidity::MINIMUM, maximum: Turbidity::MAXIMUM, unit: "" }, "2.5", false;
    /// Orders of scattering: `multiple` counts all of them and the light that the ground sends back, `single` the first alone. The default is `multiple` where tables for it are resident, else `single`.
    SCATTERING = "scattering", Kind::Choice(&["single", "multiple"]), "", false;
    /// Lamp, whose spectrum decides how much of each colour goes with what the satellite saw: a named one; a mix of named ones by their shares of the lumens, `hps:0.7,led_4000k:0.3`; flux in R, G, B (600–700, 500–600, 400–500 nm) per flux that the satellite saw, `r,g,b`; or a spectrum of your own, relative power at ascending wavelengths, `400:0,450:1.2,500:0.4`.
    LAMP = "lamp", Kind::Text {
        allowed: "neutral, mixed, incandescent, hps, hps_colour_enhanced, lps, pc_amber, led_2700k, led_3000k, led_4000k, led_5000k, led_6500k, led_hybrid, led_rgb, led_violet_2700k, led_violet_4000k, metal_halide_3000k, metal_halide, metal_halide_ceramic, mercury, fluorescent, fluorescent_three_band, a mix of up to eight of them by shares of lumens (name:share,name:share), three numbers r,g,b from 0 to 100, not all 0, or a spectrum nm:power,nm:power,... that the satellite sees",
        pattern: "^(neutral|mixed|incandescent|hps|hps_colour_enhanced|lps|pc_amber|led_2700k|led_3000k|led_4000k|led_5000k|led_6500k|led_hybrid|led_rgb|led_violet_2700k|led_violet_4000k|metal_halide_3000k|metal_halide|metal_halide_ceramic|mercury|fluorescent|fluorescent_three_band|[0-9]+(,[0-9]+){2}|[a-z_]+[0-9]*k?:[0-9.]+(,[a-z_]+[0-9]*k?:[0-9.]+){0,7}|[0-9]{3}:[0-9.]+(,[0-9]{3}:[0-9.]+)+)$",
    }, "mixed", false;
    /// What sees the sky: the light-adapted eye (`photopic`), the dark-adapted one (`scotopic`), the filters B, V and R of Johnson and Cousins, a Sky Quality Meter (`sqm`), body clocks of mammals (`melanopic`), the satellite (`dnb`), or a curve of your own per energy, `400:0,500:1,600:0`. Numbers named after a luminance stay photopic; `seen` has the response's.
    RESPONSE = "response", Kind::Text {
        allowed: "photopic, scotopic, johnson_b, johnson_v, johnson_r, sqm, melanopic, dnb, or a curve nm:value,nm:value,... within 380 to 900 nm",
        pattern: "^(photopic|scotopic|johnson_b|johnson_v|johnson_r|sqm|melanopic|dnb|[0-9]{3}:[0-9.]+(,[0-9]{3}:[0-9.]+)+)$",
    }, "photopic", false;
    /// How lights spread over the zenith angle. `modern_city`, `garstang_1986` and `full_cutoff` are Garstang's law with 0.02, 0.15 and 0 of the lamps' light above the horizon directly, over ground that reflects 0.15; `lambert` is light from the ground alone. `garstang` and `shielded` are older names of `garstang_1986` and `full_cutoff`.
    EMISSION = "emission", Kind::Text {
        allowed: "modern_city, garstang_1986, full_cutoff, lambert, garstang, shielded, or three weights lambert,horizon,oblique that are not negative and not all 0",
        pattern: "^(modern_city|garstang_1986|full_cutoff|lambert|garstang|shielded|[0-9.]+(,[0-9.]+){2})$",
    }, "modern_city", false;
    /// Share F of the lamps' light that goes above the horizon directly, instead of that of the named emission: lobes have the weights G(1−F) of lambert and F of horizon.
    DIRECT_UPLIGHT = "direct_uplight", Kind::Number { minimum: 0.0, maximum: 1.0, unit: "" }, "", false;
    /// Share G of the rest of the lamps' light that the ground sends back, instead of that of the named emission.
    GROUND_REFLECTANCE = "ground_reflectance", Kind::Number { minimum: 0.0, maximum: 1.0, unit: "" }, "", false;
    /// What the satellite's radiance L says of a light, whatever its emission: its `flux`, which is then that of a Lambertian source with L at the nadir, π·L by area; or its `nadir_radiance`, and the flux is π·L over the weight of lambert, as no other lobe has light at the nadir. Lights with less than 0.01 of lambert have no such flux.
    EMISSION_KEEP = "emission_keep", Kind::Choice(&["flux", "nadir_radiance"]), "flux", false;
    /// Number of basis functions; the default is all that are resident, and no more can be had.
    BASIS = "basis", Kind::Integer { minimum: 1, maximum: MAX_BASIS_FUNCTIONS }, "", false;
    /// Clouds: none, or the base of a closed layer of cloud in metres above sea level, of those that tables are resident for.
    CLOUDS = "clouds", Kind::Text {
        allowed: "none, or a whole number from 200 to 12000 m",
        pattern: "^(none|[0-9]{3,5})$",
    }, "none", false;
    /// Share of that layer that is cloud, under a sky of gaps: the answer is the mean of all patterns of clouds, unless `cloud_pattern` names one. 1 is the closed layer. With `clouds` alone.
    CLOUD_COVER = "cloud_cover", Kind::Number { minimum: 0.0, maximum: 1.0, unit: "" }, "1", false;
    /// One pattern of clouds of that cover, instead of the mean of all. With `cloud_cover` alone.
    CLOUD_PATTERN = "cloud_pattern", Kind::Integer { minimum: 1, maximum: MAX_CLOUD_PATTERN }, "", false;
    /// Whether terrain hides: the sky below the observer's horizon is dark and numbers are of the visible sky, and of every source's light what leaves below its skyline towards the observer does not count.
    TERRAIN = "terrain", Kind::Choice(&["on", "off"]), "on", false;
    /// Relative difference to the sky of all basis functions that fewer may make, in the norm over the open sky and the worst band. The fewest are used whose bound is within it, all of them where none is, and between the turbidities of the packs; `basis_error_bound` says the bound. Not together with `basis`.
    TOLERANCE = "tolerance", Kind::Number { minimum: 0.0001, maximum: 0.5, unit: "" }, "", false;
    /// Which light: artificial alone, or with the natural sky, that of `time` or else the dark reference. The default is `total` where a time is given, else `artificial`.
    SKY = "sky", Kind::Choice(&["artificial", "total"]), "", false;
    /// When, for the natural sky of that time in place of the dark reference: Sun with twilight, Moon, planets, stars, Milky Way, zodiacal light and airglow, in the same air. Seconds are whole; a plus in a URL is `%2B`.
    TIME = "time", Kind::Text {
        allowed: time::TIMES,
        pattern: "^[0-9]{4}-[0-9]{2}-[0-9]{2}[Tt ][0-9]{2}:[0-9]{2}:[0-9]{2}([.][0-9]{1,9})?([Zz]|[+ -][0-9]{2}:[0-9]{2})$",
    }, "", false;
    /// The evening of a night, as the calendar there has it.
    DATE = "date", Kind::Text {
        allowed: time::DATES,
        pattern: "^[0-9]{4}-[0-9]{2}-[0-9]{2}$",
    }, "", true;
    /// The month of the evenings.
    MONTH = "month", Kind::Text {
        allowed: time::MONTHS,
        pattern: "^[0-9]{4}-[0-9]{2}$",
    }, "", true;
    /// Radio flux of the Sun at 10.7 cm, with which airglow gets brighter: 65 in a quiet year, 200 in an active one. With `time` alone.
    SOLAR_FLUX = "solar_flux", Kind::Number { minimum: 50.0, maximum: 400.0, unit: " sfu" }, "100", false;
    /// A name of a place, or how one begins, in any script.
    NAME = "name", Kind::Text {
        allowed: "1 to 100 characters, such as Nairobi",
        pattern: "^.{1,100}$",
    }, "", true;
    /// Id of a scenario or plan of the scene: its lights are as that says.
    SCENARIO = "scenario", Kind::Text {
        allowed: "s- or p- and 20 hexadecimal digits, as POST scenarios and POST plans answer",
        pattern: "^[sp]-[0-9a-f]{20}$",
    }, "", false;
    /// What of the sky lights have their part in: the mean luminance within 5° of the zenith, of the visible sky, or of the visible sky inside a region; the horizontal illuminance; or the norm of each light's own sky, open down to the horizontal plane, which does not add up. The default is `region` where one is given, else `zenith`.
    MEASURE = "measure", Kind::Choice(&["norm", "zenith", "mean", "horizontal", "region"]), "", false;
    /// Number of the most influential pixels that are listed.
    LIMIT = "limit", Kind::Integer { minimum: 0, maximum: 10_000 }, "100", false;
    /// A closed curve on the sky, corner by corner; its sides are great circles, the last corner is joined to the first. Directions that it winds around are inside: it may pass north, hold or touch the zenith, and cross itself.
    REGION = "region", Kind::Text {
        allowed: "3 to 1000 corners azimuth,elevation in degrees, elevation 0 to 90, with semicolons between, such as 10,20;50,20;30,60",
        pattern: "^-?[0-9.]+,[0-9.]+(;-?[0-9.]+,[0-9.]+){2,999}$",
    }, "", false;
    /// What of the sky places and areas have their shares of: as in influences, but for the norm, which does not add up.
    SHARED_MEASURE = "measure", Kind::Choice(&["zenith", "mean", "horizontal", "region"]), "", false;
    /// What of the open sky a map shows: the mean luminance within 5° of the zenith, or of the whole sky; or the illuminance of a surface: `horizontal` of level ground; `slope` of the ground as the terrain slopes, behind its own horizon; `vertical_…` of walls that face the four sides, and of the one that receives most; `cylindrical`, the mean over all walls; `spherical`, the mean over a small sphere.
    MAP_MEASURE = "measure", Kind::Choice(&["zenith", "mean", "horizontal", "slope", "vertical_north", "vertical_east", "vertical_south", "vertical_west", "vertical_largest", "cylindrical", "spherical"]), "zenith", false;
    /// What of the sky a layer shows: of brightness as in its maps, but for `norm` and `region`; of influences the first five.
    TILE_MEASURE = "measure", Kind::Choice(&["norm", "zenith", "mean", "horizontal", "region", "slope", "vertical_north", "vertical_east", "vertical_south", "vertical_west", "vertical_largest", "cylindrical", "spherical"]), "", false;
    /// Number of the named places with the largest shares that are listed; the others are summed up.
    LISTED_PLACES = "limit", Kind::Integer { minimum: 1, maximum: 10_000 }, "50", false;
    /// The property of the features that holds their names. The default is the first that is there of `name`, `name_en`, `nom`, `nombre`, `nome`, `naam`, `namn`, `label`, `title`, `municipality`, `gemeinde`, `commune`, `comune`, in upper or lower case.
    NAME_FIELD = "name_field", Kind::Text {
        allowed: "1 to 64 characters, the name of a property that features have",
        pattern: "^[^&=#]{1,64}$",
    }, "", false;
    /// How far from the place darker ones are looked for.
    WITHIN_KM = "within_km", Kind::Number { minimum: 2.0, maximum: 150.0, unit: " km" }, "60", false;
    /// Number of darker places that are named at most.
    DARKER_PLACES = "limit", Kind::Integer { minimum: 1, maximum: 20 }, "6", false;
    /// Whose horizon file: Stellarium's list of a polygonal horizon, or N.I.N.A.'s, which ends where it began.
    HORIZON_FORMAT = "format", Kind::Choice(&["stellarium", "nina"]), "stellarium", false;
    /// Projection: fisheye is zenithal equidistant with north up and east left.
    PROJECTION = "projection", Kind::Choice(&["equirectangular", "fisheye", "perspective"]), "equirectangular", false;
    /// Azimuth of the centre of a perspective, clockwise from north.
    AZIMUTH = "azimuth", Kind::Number { minimum: -360.0, maximum: 360.0, unit: DEGREES }, "0", false;
    /// Elevation of the centre of a perspective.
    ELEVATION = "elevation", Kind::Number { minimum: -90.0, maximum: 90.0, unit: DEGREES }, "20", false;
    /// Horizontal field of view of a perspective.
    FOV = "fov", Kind::Number { minimum: 1.0, maximum: 150.0, unit: DEGREES }, "90", false;
    /// False colour on a fixed scale, `realistic` as a camera at a fixed exposure has it, or `eye` as the eye sees it that is adapted to
    /// it: with the natural sky, unless `sky` says otherwise.
    STYLE = "style", Kind::Choice(&["false_colour", "realistic", "eye"]), "false_colour", false;
    /// Colour map of false colour, all readable without colour vision.
    COLORMAP = "colormap", Kind::Choice(&["inferno", "magma", "plasma", "viridis", "cividis", "grey"]), "inferno", false;
    /// Unit of min and max: luminance in cd m⁻² (logarithmic) or magnitude in mag arcsec⁻².
    SCALE = "scale", Kind::Choice(&["luminance", "magnitude"]), "luminance", false;
    /// Smaller end of the colour scale; default 1e-5 cd m⁻² or 15 mag arcsec⁻².
    MIN = "min", Kind::Text {
        allowed: "1e-9 to 1e6 cd/m2, or -5 to 40 mag/arcsec2, below max",
        pattern: A_NUMBER,
    }, "", false;
    /// Larger end of the colour scale; default 0.1 cd m⁻² or 25 mag arcsec⁻².
    MAX = "max", Kind::Text {
        allowed: "1e-9 to 1e6 cd/m2, or -5 to 40 mag/arcsec2, above min",
        pattern: A_NUMBER,
    }, "", false;
    /// Exposure of realistic and eye, stops; at 0 a sky of 0.001 cd m⁻² is middle grey in realistic, as at f/2, 15 s and ISO 3 200.
    EXPOSURE = "exposure", Kind::Number { minimum: -12.0, maximum: 12.0, unit: " EV" }, "0", false;
    /// Ground below the horizon: a silhouette; `lit` by the sky, the Moon and its own lamps, behind the air in between; the same under
    /// snow; or `water`: the same where water is calm: that of the scene's land cover, or without one all ground that is exactly level, as lakes
    /// and the sea are in most terrain models. A scene with land cover has its albedo, another 0.15 everywhere.
    GROUND = "ground", Kind::Choice(&["dark", "lit", "snow", "water"]), "dark", false;
    /// Luminance that the eye of `style=eye` is adapted to, so that two skies compare; default: the mean of the sky.
    ADAPTATION = "adaptation", Kind::Number { minimum: 1e-4, maximum: 1e5, unit: " cd/m2" }, "", false;
    /// `hdr` lets stars, planets, Moon, Sun and lamps go above white, up to 1 000 cd m⁻² on screens that can: a PNG of 16-bit samples in
    /// PQ and BT.2020, which its chunk `cICP` says. White is 203 cd m⁻². A program that does not know the chunk shows it too grey. These
    /// are luminances of a screen, none of the sky. With `style=realistic` or `style=eye`, as PNG.
    DYNAMIC_RANGE = "dynamic_range", Kind::Choice(&["standard", "hdr"]), "standard", false;
    /// Width of the sky in the picture; the default depends on projection and format.
    WIDTH = "width", Kind::Integer { minimum: 16, maximum: 4096 }, "", false;
    /// Height of the sky in the picture, without the legend; the default depends on projection and format. Width times
    /// height is at most 8 388 608 pixels.
    HEIGHT_PX = "height_px", Kind::Integer { minimum: 16, maximum: 4096 }, "", false;
    /// Whether a plan is kept, or only held for some ten minutes after it was last asked for: for trying one after the other.
    KEEP = "keep", Kind::Choice(&["on", "off"]), "on", false;
    /// Whether lists name what is kept to everybody. If `off`, only its owner sees it there, and its id follows from its owner too: whoever is not told it does not find it.
    LISTED = "listed", Kind::Choice(&["on", "off"]), "on", false;
    /// Whether what is kept stays whatever its age and however much others have kept; with a key, and half of the room at most.
    PINNED = "pinned", Kind::Choice(&["on", "off"]), "off", false;
    /// Entries that are answered at once.
    ENTRIES = "limit", Kind::Integer { minimum: 1, maximum: 1000 }, "500", false;
    /// Where the part of the list begins: as the link to it says, which comes with the part before it.
    AFTER = "after", Kind::Text {
        allowed: "what the Link header of the part before says",
        pattern: "^[0-9]{1,19}[.][sp]-[0-9a-f]{20}$",
    }, "", false;
    /// Compass letters and the strip that explains the colours.
    LEGEND = "legend", Kind::Choice(&["on", "off"]), "on", false;
}

/// Parameters that others exclude, or that mean something beside others alone.
const CONDITIONAL: [Parameter; 9] =
    [HEIGHT, SOLAR_FLUX, AZIMUTH, ELEVATION, FOV, COLORMAP, SCALE, EXPOSURE, ADAPTATION];

/// A set of parameters for `#[utoipa::path(params(…))]` and for the reader.
pub trait ParameterSet {
    /// The parameters, in the order of the document.
    const ALL: &'static [Parameter];
}

macro_rules! parameter_sets {
    ($($(#[$doc:meta])* $name:ident = [$($parameter:ident),* $(,)?];)*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub struct $name;

        impl ParameterSet for $name {
            const ALL: &'static [Parameter] = &[$($parameter),*];
        }

        impl utoipa::IntoParams for $name {
            fn into_params(_: impl Fn() -> Option<ParameterIn>) -> Vec<ApiParameter> {
                Self::ALL.iter().map(Parameter::openapi).collect()
            }
        }
    )*};
}

parameter_sets! {
    /// No parameters.
    NoParameters = [];
    /// Those of what shows a scene's lights.
    ScenarioParameters = [SCENARIO];
    /// Those of a place.
    PlaceParameters = [LAT, LON, SCENARIO];
    /// Those of a night, which needs no scene.
    NightParameters = [LAT, LON, DATE];
    /// Those of a night over a place of a scene, under a clear sky.
    SceneNightParameters = [
        LAT, LON, DATE, HEIGHT, ALTITUDE, TURBIDITY, SCATTERING, LAMP, EMISSION, DIRECT_UPLIGHT, GROUND_REFLECTANCE, EMISSION_KEEP, BASIS, TERRAIN, TOLERANCE, SOLAR_FLUX,
        SCENARIO,
    ];
    /// Those of a month of nights.
    NightsParameters = [LAT, LON, MONTH];
    /// Those of places of the world by name.
    WorldPlacesParameters = [NAME];
    /// Those of a plan beside its body: what all its sites have in common, and how much of the answer is listed.
    PlanParameters = [
        TURBIDITY, SCATTERING, LAMP, RESPONSE, EMISSION, DIRECT_UPLIGHT, GROUND_REFLECTANCE, EMISSION_KEEP, BASIS, CLOUDS, CLOUD_COVER, CLOUD_PATTERN, TERRAIN, TOLERANCE, SCENARIO, LIMIT,
    ];
    /// The same, and how it is kept.
    PlanPostParameters = [
        TURBIDITY, SCATTERING, LAMP, RESPONSE, EMISSION, DIRECT_UPLIGHT, GROUND_REFLECTANCE, EMISSION_KEEP, BASIS, CLOUDS, CLOUD_COVER, CLOUD_PATTERN, TERRAIN, TOLERANCE, SCENARIO, LIMIT, KEEP,
        LISTED, PINNED,
    ];
    /// Those of a scenario beside its body: how it is kept.
    ScenarioPostParameters = [LISTED, PINNED];
    /// Those of a list of what is kept.
    KeptListParameters = [ENTRIES, AFTER];
    /// Those of a plan that is looked at.
    PlanListParameters = [LIMIT];
    /// Those of a sky.
    SkyParameters = [
        LAT, LON, HEIGHT, ALTITUDE, TURBIDITY, SCATTERING, LAMP, RESPONSE, EMISSION, DIRECT_UPLIGHT, GROUND_REFLECTANCE, EMISSION_KEEP, BASIS, CLOUDS, CLOUD_COVER, CLOUD_PATTERN, TERRAIN, TOLERANCE,
        TIME, SOLAR_FLUX, SCENARIO,
    ];
    /// Those that many skies have in common; each place may have its own of all but the scenario.
    SkiesParameters = [
        HEIGHT, ALTITUDE, TURBIDITY, SCATTERING, LAMP, RESPONSE, EMISSION, DIRECT_UPLIGHT, GROUND_REFLECTANCE, EMISSION_KEEP, BASIS, CLOUDS, CLOUD_COVER, CLOUD_PATTERN, TERRAIN, TOLERANCE,
        TIME, SOLAR_FLUX, SCENARIO,
    ];
    /// Those of a sky that is summed over every light: it has no basis.
    ReferenceParameters = [
        LAT, LON, HEIGHT, ALTITUDE, TURBIDITY, SCATTERING, LAMP, RESPONSE, EMISSION, DIRECT_UPLIGHT, GROUND_REFLECTANCE, EMISSION_KEEP, CLOUDS, TERRAIN, SKY, SCENARIO,
    ];
    /// Those of influences as a list.
    InfluenceParameters = [
        LAT, LON, HEIGHT, ALTITUDE, TURBIDITY, SCATTERING, LAMP, RESPONSE, EMISSION, DIRECT_UPLIGHT, GROUND_REFLECTANCE, EMISSION_KEEP, BASIS, CLOUDS, CLOUD_COVER, CLOUD_PATTERN, TERRAIN, TOLERANCE,
        SCENARIO, MEASURE, REGION, LIMIT,
    ];
    /// Those of influences as a raster or map tile: all pixels are shown.
    InfluenceRasterParameters = [
        LAT, LON, HEIGHT, ALTITUDE, TURBIDITY, SCATTERING, LAMP, RESPONSE, EMISSION, DIRECT_UPLIGHT, GROUND_REFLECTANCE, EMISSION_KEEP, BASIS, CLOUDS, CLOUD_COVER, CLOUD_PATTERN, TERRAIN, TOLERANCE,
        SCENARIO, MEASURE, REGION,
    ];
    /// Those of shares by named places.
    SharesParameters = [
        LAT, LON, HEIGHT, ALTITUDE, TURBIDITY, SCATTERING, LAMP, RESPONSE, EMISSION, DIRECT_UPLIGHT, GROUND_REFLECTANCE, EMISSION_KEEP, BASIS, CLOUDS, CLOUD_COVER, CLOUD_PATTERN, TERRAIN, TOLERANCE,
        SCENARIO, SHARED_MEASURE, REGION, LISTED_PLACES,
    ];
    /// Those of shares by areas, all of which are listed.
    AreaSharesParameters = [
        LAT, LON, HEIGHT, ALTITUDE, TURBIDITY, SCATTERING, LAMP, RESPONSE, EMISSION, DIRECT_UPLIGHT, GROUND_REFLECTANCE, EMISSION_KEEP, BASIS, CLOUDS, CLOUD_COVER, CLOUD_PATTERN, TERRAIN, TOLERANCE,
        SCENARIO, SHARED_MEASURE, REGION, NAME_FIELD,
    ];
    /// Those of the zenith's brightness at every place.
    BrightnessParameters = [
        MAP_MEASURE, SKY, TIME, SOLAR_FLUX, TURBIDITY, SCATTERING, LAMP, RESPONSE, EMISSION, DIRECT_UPLIGHT, GROUND_REFLECTANCE, EMISSION_KEEP, CLOUDS, TERRAIN, SCENARIO,
    ];
    /// Those of darker places near a place.
    DarkerParameters = [
        LAT, LON, WITHIN_KM, DARKER_PLACES, TURBIDITY, SCATTERING, LAMP, RESPONSE, EMISSION, DIRECT_UPLIGHT, GROUND_REFLECTANCE, EMISSION_KEEP, TERRAIN, SCENARIO,
    ];
    /// Those of a horizon.
    HorizonParameters = [LAT, LON, HEIGHT, ALTITUDE, HORIZON_FORMAT];
    /// Those of a landscape for Stellarium, which has a horizon and light.
    LandscapeParameters = [
        LAT, LON, HEIGHT, ALTITUDE, TURBIDITY, SCATTERING, LAMP, EMISSION, DIRECT_UPLIGHT, GROUND_REFLECTANCE, EMISSION_KEEP, SCENARIO,
    ];
    /// Those of a panorama's raw grid.
    GridParameters = [
        LAT, LON, HEIGHT, ALTITUDE, TURBIDITY, SCATTERING, LAMP, RESPONSE, EMISSION, DIRECT_UPLIGHT, GROUND_REFLECTANCE, EMISSION_KEEP, BASIS, CLOUDS, CLOUD_COVER, CLOUD_PATTERN, TERRAIN, TOLERANCE,
        SKY, TIME, SOLAR_FLUX, SCENARIO,
    ];
    /// Those of a compact panorama, which holds artificial light and, at a time, all light.
    CompactParameters = [
        LAT, LON, HEIGHT, ALTITUDE, TURBIDITY, SCATTERING, LAMP, RESPONSE, EMISSION, DIRECT_UPLIGHT, GROUND_REFLECTANCE, EMISSION_KEEP, BASIS, CLOUDS, CLOUD_COVER, CLOUD_PATTERN, TERRAIN, TOLERANCE,
        TIME, SOLAR_FLUX, SCENARIO,
    ];
    /// Those of a panorama as a raster of radiance: what chooses colours means nothing there.
    RasterParameters = [
        LAT, LON, HEIGHT, ALTITUDE, TURBIDITY, SCATTERING, LAMP, RESPONSE, EMISSION, DIRECT_UPLIGHT, GROUND_REFLECTANCE, EMISSION_KEEP, BASIS, CLOUDS, CLOUD_COVER, CLOUD_PATTERN, TERRAIN, TOLERANCE,
        SKY, TIME, SOLAR_FLUX, SCENARIO, PROJECTION, AZIMUTH, ELEVATION, FOV, WIDTH, HEIGHT_PX,
    ];
    /// Those of a panorama as WebP, which has one dynamic range.
    WebPParameters = [
        LAT, LON, HEIGHT, ALTITUDE, TURBIDITY, SCATTERING, LAMP, RESPONSE, EMISSION, DIRECT_UPLIGHT, GROUND_REFLECTANCE, EMISSION_KEEP, BASIS, CLOUDS, CLOUD_COVER, CLOUD_PATTERN, TERRAIN, TOLERANCE,
        SKY, TIME, SOLAR_FLUX, SCENARIO, PROJECTION, AZIMUTH, ELEVATION, FOV, STYLE, COLORMAP, SCALE, MIN, MAX, EXPOSURE, ADAPTATION, GROUND, WIDTH,
        HEIGHT_PX, LEGEND,
    ];
    /// Those of a panorama as a picture.
    PanoramaParameters = [
        LAT, LON, HEIGHT, ALTITUDE, TURBIDITY, SCATTERING, LAMP, RESPONSE, EMISSION, DIRECT_UPLIGHT, GROUND_REFLECTANCE, EMISSION_KEEP, BASIS, CLOUDS, CLOUD_COVER, CLOUD_PATTERN, TERRAIN, TOLERANCE,
        SKY, TIME, SOLAR_FLUX, SCENARIO, PROJECTION, AZIMUTH, ELEVATION, FOV, STYLE, COLORMAP, SCALE, MIN, MAX, EXPOSURE, ADAPTATION, GROUND, DYNAMIC_RANGE, WIDTH,
        HEIGHT_PX, LEGEND,
    ];
}

pub(crate) use {parameter_sets, parameters};

#[cfg(test)]
#[path = "parameters_tests.rs"]
mod tests;
