//! The world's places of 1 000 or more inhabitants, as GeoNames has them (geonames.org, CC BY 4.0), for scenes that bring none of
//! their own and for searches by name. `scripts/gazetteer.py` writes the file.

use crate::metadata::{NamedPlace, is_within};
use serde::Serialize;
use skyglow_physics::{
    EARTH_RADIUS_M, GeoPoint,
    geometry::{Bearing, LocalFrame},
};
use std::sync::OnceLock;

/// Whom to credit for the places.
pub const GAZETTEER_CREDIT: &str = "GeoNames, CC BY 4.0";

/// A scene takes so many of its places at most, the most populous.
const MAX_PLACES_OF_A_SCENE: usize = 10_000;

static FILE: &[u8] = include_bytes!("../data/gazetteer.tsv.zst");

/// A place of the world.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct WorldPlace {
    /// Its name in Latin letters.
    pub name: String,
    /// Its country as ISO 3166 has it, two letters.
    pub country: String,
    /// Degrees north.
    pub latitude_deg: f64,
    /// Degrees east, −180..180.
    pub longitude_deg: f64,
    /// Inhabitants, where known.
    pub population: Option<u64>,
}

/// Places with the names by which they are found, the most populous first.
#[derive(Debug, Default)]
pub struct Gazetteer {
    places: Vec<WorldPlace>,
    /// Names in lower case, each between two bars, a line a place.
    names: String,
    /// Where the line of each place begins in `names`.
    starts: Vec<usize>,
}

impl Gazetteer {
    /// The one that comes with the program: read at the first use, in a tenth of a second.
    pub fn world() -> &'static Self {
        static WORLD: OnceLock<Gazetteer> = OnceLock::new();
        WORLD.get_or_init(|| {
            let text = zstd::decode_all(FILE).unwrap_or_default();
            Self::read(&String::from_utf8(text).unwrap_or_default())
        })
    }

    /// Lines of name, country, latitude and longitude (1e-4 degrees), population, further names between bars.
    fn read(text: &str) -> Self {
        let mut gazetteer = Self::default();
        for line in text.lines() {
            let mut fields = line.split('\t');
            let mut field = || fields.next().unwrap_or_default();
            let (name, country) = (field(), field());
            let (latitude, longitude) = (field().parse::<i32>(), field().parse::<i32>());
            let (population, further) = (field().parse().ok().filter(|count| *count > 0), field());
            let (Ok(latitude), Ok(longitude)) = (latitude, longitude) else { continue };
            gazetteer.starts.push(gazetteer.names.len());
            gazetteer.names.push('|');
            gazetteer.names.push_str(&name.to_lowercase());
            gazetteer.names.push('|');
            if !further.is_empty() {
                gazetteer.names.push_str(further);
                gazetteer.names.push('|');
            }
            gazetteer.names.push('\n');
            gazetteer.places.push(WorldPlace {
                name: name.to_owned(),
                country: country.to_owned(),
                latitude_deg: f64::from(latitude) / 1e4,
                longitude_deg: f64::from(longitude) / 1e4,
                population,
            });
        }
        gazetteer
    }

    /// Places whose name, or one of whose names, is `name`; then those with a name that begins so, then those with a word that does.
    /// The most populous come first among each; `limit` of them at most.
    pub fn search(&self, name: &str, limit: usize) -> Vec<&WorldPlace> {
        let name = name.trim().to_lowercase();
        let mut found: Vec<usize> = Vec::new();
        if name.is_empty() || name.contains(['|', '\n']) {
            return Vec::new();
        }
        for pattern in [format!("|{name}|"), format!("|{name}"), format!(" {name}")] {
            let mut at = 0;
            while found.len() < limit {
                let Some(hit) = self.names[at..].find(&pattern).map(|offset| at + offset) else { break };
                let place = self.starts.partition_point(|start| *start <= hit) - 1;
                if !found.contains(&place) {
                    found.push(place);
                }
                // One line counts once.
                at = self.starts.get(place + 1).copied().unwrap_or(self.names.len());
            }
        }
        found.into_iter().map(|place| &self.places[place]).collect()
    }

    /// The place that people would name one by: the most populous within 1.5 km, else the nearest within 150 km, with how far it is
    /// from there and in which direction.
    pub fn nearest(&self, at: GeoPoint) -> Option<(&WorldPlace, Bearing)> {
        const SAME_M: f64 = 1_500.0;
        const FAR_M: f64 = 150_000.0;
        let far_deg = (FAR_M / EARTH_RADIUS_M).to_degrees();
        let to = at.unit_vector();
        let mut nearest: Option<(&WorldPlace, Bearing)> = None;
        for place in &self.places {
            // Most places are not even of that latitude.
            if (place.latitude_deg - at.latitude_deg()).abs() > far_deg {
                continue;
            }
            let Ok(from) = GeoPoint::from_deg(place.latitude_deg, place.longitude_deg) else { continue };
            let bearing = LocalFrame::at(from).bearing_to(to);
            if bearing.distance_m <= SAME_M {
                return Some((place, bearing));
            }
            if bearing.distance_m <= nearest.as_ref().map_or(FAR_M, |(_, least)| least.distance_m) {
                nearest = Some((place, bearing));
            }
        }
        nearest
    }

    /// The most populous places inside bounds, west, south, east, north in degrees; west > east across the antimeridian.
    pub(crate) fn within(&self, bounds: [f64; 4]) -> Vec<NamedPlace> {
        let inside = |place: &&WorldPlace| is_within(bounds, place.latitude_deg, place.longitude_deg);
        let named = |place: &WorldPlace| NamedPlace {
            name: place.name.clone(),
            latitude_deg: place.latitude_deg,
            longitude_deg: place.longitude_deg,
            population: place.population,
        };
        self.places.iter().filter(inside).take(MAX_PLACES_OF_A_SCENE).map(named).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(found: &[&WorldPlace]) -> Vec<String> {
        found.iter().map(|place| format!("{} {}", place.name, place.country)).collect()
    }

    /// Nairobi and Zürich are found as people write them, in their letters and in plain ones.
    #[test]
    fn places_are_found_in_any_script() {
        let world = Gazetteer::world();
        assert!(world.places.len() > 150_000 && world.names.len() > 5_000_000);
        for name in ["Nairobi", "nairobi ", "Найроби", "ナイロビ", "内罗毕"] {
            let found = world.search(name, 5);
            assert_eq!((found[0].name.as_str(), found[0].population), ("Nairobi", Some(4_397_073)), "{name}");
            assert!((found[0].latitude_deg + 1.2833).abs() < 1e-3);
            assert!((found[0].longitude_deg - 36.8167).abs() < 1e-3);
        }
        for name in ["Zürich", "zurich", "ZÜRICH"] {
            assert_eq!(world.search(name, 1)[0].name, "Zürich", "{name}");
        }
        assert!(world.search("", 5).is_empty() && world.search("qqqq", 5).is_empty());
        assert!(world.search("a|b", 5).is_empty());
    }

    /// A whole name comes before a beginning, and that before a word within; then the most populous.
    #[test]
    fn whole_names_come_first() {
        let lines = "Yorkville\tUS\t1\t2\t900\t\nNew York\tUS\t1\t2\t800\t\nYork\tGB\t1\t2\t5\t\nYork\tUS\t1\t2\t3\teboracum";
        let few = Gazetteer::read(lines);
        assert_eq!(names(&few.search("york", 9)), ["York GB", "York US", "Yorkville US", "New York US"]);
        assert_eq!(names(&few.search("york", 1)), ["York GB"]);
        assert_eq!(names(&few.search("ebo", 9)), ["York US"]);
    }

    /// A place in a town is named by the town, not by one of its quarters; one in the country by the nearest place.
    #[test]
    fn a_place_is_named_by_what_is_near() {
        let near = |lat, lon| Gazetteer::world().nearest(GeoPoint::from_deg(lat, lon).unwrap());
        let (town, bearing) = near(-1.2833, 36.8167).unwrap();
        assert!(town.name == "Nairobi" && bearing.distance_m < 100.0, "{town:?} {bearing:?}");
        let (beside, bearing) = near(45.714, 9.44).unwrap();
        assert!(bearing.distance_m < 5_000.0 && beside.country == "IT", "{beside:?} {bearing:?}");
        assert!(near(-40.0, -145.0).is_none());
    }

    /// Bounds may cross the antimeridian.
    #[test]
    fn bounds_hold_their_places() {
        let world = Gazetteer::world();
        let around = |bounds| world.within(bounds);
        let kenya = around([34.0, -4.5, 41.5, 4.5]);
        assert!(kenya.len() > 100 && kenya[0].name == "Nairobi", "{}", kenya.len());
        let fiji = around([177.0, -20.0, -178.0, -15.0]);
        assert!(fiji.iter().any(|place| place.name == "Suva") && fiji.len() < 100, "{}", fiji.len());
        assert!(around([-150.0, -40.0, -140.0, -35.0]).is_empty());
        assert_eq!(around([-180.0, -90.0, 180.0, 90.0]).len(), MAX_PLACES_OF_A_SCENE);
    }
}
