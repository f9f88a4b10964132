//! Commands beside the same asked over HTTP.

use super::{Ground, PLACE, number, server};
use crate::common::{self, command, skyglow, text};
use serde_json::Value;
use std::{
    path::{Path, PathBuf},
    process::Stdio,
    time::Duration,
};

#[test]
fn the_command_line_gives_the_numbers_of_the_api() {
    let server = server();
    let ground = Ground::get();
    let (data, packs) = (ground.data(), ground.packs());
    let common = ["--scene", "demo", "--lat", "46.17", "--lon", "8.79", "--data", text(&data)];
    let engine = ["--packs", text(&packs), "--device", "lavapipe"];
    let printed = skyglow(&[&["sky", "--json"], &common[..], &engine[..]].concat()).expect_status(0).json();
    let answered = server.get(&format!("/api/v1/scenes/demo/sky?{PLACE}")).json();
    assert_eq!(printed, answered);
    assert_eq!((&printed["scattering"], &printed["ground_albedo"]), (&"single".into(), &Value::Null));

    let table = skyglow(&[&["sky"], &common[..], &engine[..]].concat()).expect_status(0);
    assert!(
        table.stdout.contains("Bortle class") && table.stdout.contains("illustrative"),
        "{}",
        table.stdout
    );

    let file = ground.folder.join("sky.json");
    skyglow(&[&["panorama", "-o", text(&file)], &common[..], &engine[..]].concat()).expect_status(0);
    let written: Value = serde_json::from_slice(&std::fs::read(&file).unwrap()).unwrap();
    assert_eq!(written, server.get(&format!("/api/v1/scenes/demo/panorama.json?{PLACE}")).json());

    for (arguments, status, word) in [
        (["--turbidity", "100"], 2, "turbidity"),
        (["--turbidity", "6"], 2, "2 to 3"),
        (["--altitude", "9000"], 2, "altitude"),
        (["--basis", "1000"], 2, "basis"),
        // The packs here hold light of the first order.
        (["--scattering", "multiple"], 2, "not resident; allowed: single"),
    ] {
        let refused = skyglow(&[&["sky"], &common[..], &engine[..], &arguments[..]].concat());
        let refused = refused.expect_status(status);
        println!("{}: {}", arguments.join(" "), refused.stderr.trim_end());
        assert!(refused.stderr.contains(word), "{arguments:?}: {}", refused.stderr);
    }
    for (scene, lat, lon, word) in
        [("demo", "-1.3", "36.8", "outside"), ("atlantis", "46.2", "8.8", "atlantis")]
    {
        let asked = ["sky", "--scene", scene, "--lat", lat, "--lon", lon, "--data", text(&data)];
        let refused = skyglow(&[&asked[..], &engine[..]].concat()).expect_status(1);
        println!("{scene} {lat} {lon}: {}", refused.stderr.trim_end());
        assert!(refused.stderr.contains(word), "{}", refused.stderr);
    }
}

/// The reference solution needs no packs and names its directions.
#[test]
fn the_reference_needs_no_packs() {
    let folder = tempfile::tempdir().unwrap();
    let raster = folder.path().join("town.tif");
    common::geotiff::write_radiance(&raster, common::geotiff::Crs::Geographic, &common::geotiff::town());
    let data = text(folder.path());
    skyglow(&["ingest", text(&raster), "--data", data]).expect_status(0);
    let reference = |more: &[&str]| {
        let all = ["reference", "--scene", "town", "--lat", "-1.28", "--lon", "36.83", "--data", data];
        skyglow(&[&all[..], more].concat()).expect_status(0).json()
    };
    let few = reference(&["--directions", "16", "--scattering", "single"]);
    let directions = few["directions"].as_array().unwrap();
    assert!(directions.len() >= 16);
    for direction in directions {
        assert!(direction["radiance"].as_array().unwrap().iter().all(|value| value.as_f64().unwrap() > 0.0));
    }
    assert_eq!(few["unit"], "W m-2 sr-1");
    // The same JSON as panorama.json, but for the samples that were not computed and the basis that is not used.
    assert!(few.get("radiance").is_none() && few.get("basis_count").is_none(), "{few}");
    assert_eq!(few["horizon_deg"].as_array().map(Vec::len), Some(256));
    assert!(number(&few["sky"], "zenith_luminance_cd_m2") > 0.0);
    let warnings: Vec<&str> = few["warnings"].as_array().unwrap().iter().filter_map(|w| w.as_str()).collect();
    assert_eq!(warnings.len(), 3, "{warnings:?}");
    for (warning, said) in
        warnings.iter().zip(["of the 300 km around", "no terrain", "16 of 16384 directions"])
    {
        assert!(warning.contains(said), "{warnings:?}");
    }
    assert!((number(&few["observer"], "altitude_m") - 2.0).abs() < 1e-9);
    assert_eq!(few, reference(&["--directions", "16", "--scattering", "single"]));
    let highest =
        directions.iter().max_by(|a, b| number(a, "elevation_deg").total_cmp(&number(b, "elevation_deg")));
    let ratio = highest.unwrap()["radiance"][1].as_f64().unwrap()
        / few["sky"]["zenith_radiance_w_m2_sr"][1].as_f64().unwrap();
    assert!((0.8..1.25).contains(&ratio), "{ratio}");
    let blue = reference(&["--directions", "16", "--lamp", "0,0,1", "--scattering", "single"]);
    let bands = blue["directions"][0]["radiance"].as_array().unwrap();
    assert!(bands[0] == 0.0 && bands[1] == 0.0 && bands[2].as_f64().unwrap() > 0.0, "{bands:?}");
    // All orders unless asked otherwise, over the ground that is asked for: each a little brighter everywhere.
    let all_orders = reference(&["--directions", "16"]);
    let over_snow = reference(&["--directions", "16", "--ground-albedo", "0.8"]);
    assert_eq!((&few["scattering"], &all_orders["scattering"]), (&"single".into(), &"multiple".into()));
    assert_eq!((&all_orders["ground_albedo"], &over_snow["ground_albedo"]), (&0.15.into(), &0.8.into()));
    let green = |answer: &serde_json::Value, index: usize| {
        answer["directions"][index]["radiance"][1].as_f64().unwrap()
    };
    for index in 0..directions.len() {
        let (first, all, snow) = (green(&few, index), green(&all_orders, index), green(&over_snow, index));
        assert!(first < all && all < snow && snow < 20.0 * first, "{index}: {first} {all} {snow}");
    }
}

/// The reference solution hides lights behind a ridge in every order of scattering.
#[test]
fn the_reference_hides_lights_behind_a_ridge() {
    let folder = tempfile::tempdir().unwrap();
    let (raster, terrain) = (folder.path().join("town.tif"), folder.path().join("ridge.tif"));
    common::geotiff::write_radiance(&raster, common::geotiff::Crs::Geographic, &common::geotiff::town());
    common::geotiff::write_radiance(&terrain, common::geotiff::Crs::Geographic, &common::geotiff::ridge());
    let data = text(folder.path());
    skyglow(&["ingest", text(&raster), "--terrain", text(&terrain), "--data", data]).expect_status(0);
    // East of the town and the ridge.
    let common = ["--scene", "town", "--lat", "-1.2833", "--lon", "36.9104", "--data", data];
    let reference = |more: &[&str]| {
        let count = ["--directions", "16", "--turbidity", "2"];
        let finished = skyglow(&[&["reference"], &common[..], &count, more].concat()).expect_status(0);
        (finished.json(), finished.stderr)
    };
    for (scattering, fields, fields_open) in [("single", None, None), ("multiple", Some(5), Some(1))] {
        let (hidden, said) = reference(&["--scattering", scattering]);
        let (open, said_open) = reference(&["--scattering", scattering, "--terrain", "off"]);
        for (said, fields) in [(said, fields), (said_open, fields_open)] {
            let expected = fields.map(|count| format!("later orders: {count} fields"));
            assert!(said.contains("later orders") == expected.is_some(), "{said}");
            assert!(expected.is_none_or(|expected| said.contains(&expected)), "{said}");
        }
        assert_eq!((&hidden["hidden_lights"], &open["hidden_lights"]), (&true.into(), &false.into()));
        assert_eq!(hidden["flux_within_300_km_dnb_w"], open["flux_within_300_km_dnb_w"]);
        let warnings = hidden["warnings"].as_array().unwrap();
        assert_eq!(warnings.len(), 2, "{warnings:?}");
        assert!(warnings[1].as_str().unwrap().contains("directions"), "{warnings:?}");
        let (mut darker, mut seen) = (0.0, 0.0);
        let pairs =
            hidden["directions"].as_array().unwrap().iter().zip(open["directions"].as_array().unwrap());
        for (hidden, open) in pairs {
            assert_eq!(hidden["azimuth_deg"], open["azimuth_deg"]);
            let green = |direction: &Value| direction["radiance"][1].as_f64().unwrap();
            let (hidden, open) = (green(hidden), green(open));
            assert!(hidden < open, "{hidden} {open}");
            if hidden > 0.0 {
                darker += hidden / open;
                seen += 1.0;
            }
        }
        println!("{scattering}: {:.3} of the light is left in {seen} directions", darker / seen);
        assert!(seen > 8.0 && (0.5..0.97).contains(&(darker / seen)), "{scattering}: {}", darker / seen);
    }
    // The fast path says the same of what it does.
    let packs = Ground::get().packs();
    let fast = [&["sky", "--json", "--device", "cpu", "--packs", text(&packs)], &common[..]].concat();
    let fast = skyglow(&fast).expect_status(0).json();
    assert_eq!((&fast["hidden_lights"], &fast["terrain_occlusion"]), (&true.into(), &true.into()));
}

/// The command line writes the influences that the API answers.
#[test]
fn commands_write_the_influences_of_the_api() {
    let server = server();
    let ground = Ground::get();
    let (data, packs) = (ground.data(), ground.packs());
    let file = |name: &str| ground.folder.join(name);
    let write = |output: &std::path::Path, more: &[&str]| {
        let place = ["--scene", "demo", "--lat", "46.17", "--lon", "8.79", "--data", text(&data)];
        let engine = ["--packs", text(&packs), "--device", "lavapipe"];
        skyglow(&[&["influence", "-o", text(output)], &place[..], &engine[..], more].concat())
    };
    for end in ["json", "geojson", "csv", "tif"] {
        let output = file(&format!("influence.{end}"));
        write(&output, &["--measure", "horizontal"]).expect_status(0);
        let answered = server.get(&format!("/api/v1/scenes/demo/influence.{end}?{PLACE}&measure=horizontal"));
        assert_eq!(answered.status, 200);
        assert!(std::fs::read(&output).unwrap() == answered.body, "{end}");
    }
    let boundary = file("half.geojson");
    std::fs::write(
        &boundary,
        r#"{"type": "Polygon", "coordinates": [[[4, 40], [8.79, 40], [8.79, 50], [4, 50], [4, 40]]]}"#,
    )
    .unwrap();
    let output = file("influence-of-the-west.json");
    write(&output, &["--boundary", text(&boundary)]).expect_status(0);
    let written: Value = serde_json::from_slice(&std::fs::read(&output).unwrap()).unwrap();
    let share = number(&written["boundary"], "share");
    assert!(share > 0.05 && share < 0.95, "{share}");
    for (arguments, word) in [
        (vec!["--measure", "brightness"], "measure"),
        (vec!["--region", "1,2;3,4"], "region"),
        (vec!["--limit", "20000"], "limit"),
    ] {
        let refused = write(&file("none.json"), &arguments).expect_status(2);
        assert!(refused.stderr.contains(word), "{}", refused.stderr);
    }
    write(&file("influence.xlsx"), &[]).expect_status(2);
    assert!(!file("none.json").exists());
}

/// Scenarios and plans of the command line are those of the API.
#[test]
fn commands_and_api_share_scenarios_and_plans() {
    let server = server();
    let ground = Ground::get();
    let (data, packs) = (ground.data(), ground.packs());
    let file = |name: &str| ground.folder.join(name);
    let changes = file("changes.json");
    std::fs::write(
        &changes,
        r#"{"title": "amber", "edits": [{"brush": {"points": [[8.79, 46.17]], "radius_m": 6000}, "lamp": "pc_amber"}]}"#,
    )
    .unwrap();
    let painted = ["scenario", "--scene", "demo", "--changes", text(&changes), "--data", text(&data)];
    let painted = skyglow(&painted).expect_status(0).json();
    let id = painted["id"].as_str().unwrap();
    assert!(number(&painted, "changed_pixels") > 0.0);
    // The server finds it, and every query of the command line takes it.
    let answered = server.get(&format!("/api/v1/scenarios/{id}"));
    assert_eq!((answered.status, answered.json()["edits"].clone()), (200, painted["edits"].clone()));
    let engine = ["--data", text(&data), "--packs", text(&packs), "--device", "lavapipe"];
    let place = ["--scene", "demo", "--lat", "46.17", "--lon", "8.79"];
    let sky = |more: &[&str]| {
        skyglow(&[&["sky", "--json"], &place[..], &engine[..], more].concat()).expect_status(0).json()
    };
    let (amber, mixed) = (sky(&["--scenario", id]), sky(&[]));
    let blue = |sky: &Value| sky["sky"]["zenith_radiance_w_m2_sr"][2].as_f64().unwrap();
    assert!(blue(&amber) < 0.7 * blue(&mixed), "{} {}", blue(&amber), blue(&mixed));
    assert_eq!(amber["scenario"], painted["id"]);

    let request = file("request.json");
    std::fs::write(
        &request,
        r#"{"method": "target", "sites": [{"lat": 46.3, "lon": 8.79, "reduce_by": 0.25}], "max_cut": 0.8}"#,
    )
    .unwrap();
    let write = |output: &std::path::Path, request: &std::path::Path| {
        let what =
            ["plan", "--scene", "demo", "--request", text(request), "--scenario", id, "-o", text(output)];
        skyglow(&[&what[..], &engine[..]].concat())
    };
    let mut plan = String::new();
    for end in ["json", "tif", "geojson", "csv"] {
        let output = file(&format!("plan.{end}"));
        plan = write(&output, &request).expect_status(0).stdout.trim().to_owned();
        let answered = server.get(&format!("/api/v1/plans/{plan}.{end}"));
        assert_eq!(answered.status, 200);
        assert!(std::fs::read(&output).unwrap() == answered.body, "{end}");
    }
    let written: Value = serde_json::from_slice(&std::fs::read(file("plan.json")).unwrap()).unwrap();
    assert!((number(&written["sites"][0], "reduced_by") - 0.25).abs() < 1e-3);
    assert_eq!(written["id"], plan.as_str());
    // What is kept is listed as the server lists it.
    let lists =
        skyglow(&["kept", "--scene", "demo", "--json", "--data", text(&data)]).expect_status(0).json();
    for kind in ["scenarios", "plans"] {
        assert_eq!(lists[kind], server.get(&format!("/api/v1/scenes/demo/{kind}")).json(), "{kind}");
    }
    let listed = skyglow(&["kept", "--scene", "demo", "--data", text(&data)]).expect_status(0).stdout;
    let line =
        |id: &str| listed.lines().find(|line| line.starts_with(id)).unwrap_or_else(|| panic!("{listed}"));
    assert!(line(id).contains("amber, 1 edit") && line(&plan).contains("target, 1 site,"), "{listed}");
    let nothing = skyglow(&["kept", "--scene", "nowhere", "--data", text(&data)]).expect_status(1);
    assert!(nothing.stderr.contains("nowhere"), "{}", nothing.stderr);

    std::fs::write(&request, r#"{"method": "target"}"#).unwrap();
    let refused = write(&file("none.json"), &request).expect_status(2);
    assert!(refused.stderr.contains("sites"), "{}", refused.stderr);
    let refused = skyglow(&[&["sky", "--scenario", "s-0"], &place[..], &engine[..]].concat());
    assert!(refused.expect_status(2).stderr.contains("scenario"), "an id that is none");
}

/// A map of brightness that is killed goes on where it was and ends with the same numbers; archives and other layers are written too.
#[test]
fn a_killed_atlas_resumes_to_the_same_numbers() {
    // It makes the demo.
    let _server = server();
    let ground = Ground::get();
    let (data, packs) = (ground.data(), ground.packs());
    let program = ["--scene", "demo", "--data", text(&data), "--packs", text(&packs), "--device", "cpu"];
    let file = |name: &str| ground.folder.join(name);
    let atlas = |more: &[&str]| skyglow(&[&["atlas"], &program[..], more].concat());
    let (whole, resumed) = (file("whole.tif"), file("resumed.tif"));
    let map = ["--places", "300000", "--terrain", "off"];
    atlas(&[&map[..], &["-o", text(&whole)]].concat()).expect_status(0);
    assert!(!file("whole.tif.part").exists());
    let part = file("resumed.tif.part");
    let output = ["-o", text(&resumed)];
    let mut killed = command();
    killed.args([&["atlas"], &program[..], &map[..], &output[..]].concat()).stderr(Stdio::null());
    let mut killed = killed.spawn().unwrap();
    let bytes = || std::fs::metadata(&part).map_or(0, |part| part.len());
    while bytes() < 100_000 && killed.try_wait().unwrap().is_none() {
        std::thread::sleep(Duration::from_millis(5));
    }
    killed.kill().unwrap();
    killed.wait().unwrap();
    assert!(bytes() >= 100_000 && !resumed.exists(), "it was killed on its way");
    let again = atlas(&[&map[..], &output[..]].concat()).expect_status(0);
    let parts = again.stderr.split("parts=").nth(1).unwrap();
    let parts: u32 = parts.chars().take_while(char::is_ascii_digit).collect::<String>().parse().unwrap();
    assert!(parts > 0 && !part.exists(), "{}", again.stderr);
    assert!(std::fs::read(&whole).unwrap() == std::fs::read(&resumed).unwrap());

    let archive = file("elevation.pmtiles");
    let small = ["--places", "20000", "--max-zoom", "5", "-o", text(&archive)];
    atlas(&[&["--layer", "elevation"], &small[..]].concat()).expect_status(0);
    let bytes = std::fs::read(&archive).unwrap();
    // Version 3, PNG, zoom levels 0 to 5, clustered (PMTiles specification, header).
    assert_eq!((&bytes[..8], bytes[99], bytes[100], bytes[101]), (&b"PMTiles\x03"[..], 2, 0, 5));
    assert_eq!(bytes[96], 1, "tiles lie in the order of their ids");
    let refused = atlas(&["-o", "map.gif"]).expect_status(2);
    assert!(refused.stderr.contains(".pmtiles"), "{}", refused.stderr);
    let nowhere = atlas(&["-o", "/no/such/folder/map.tif"]).expect_status(1);
    assert!(nowhere.stderr.contains("/no/such/folder"), "{}", nowhere.stderr);
}

/// A part of a map by its bounds has the numbers of the whole map there, bit for bit, and lies where they lie.
#[test]
fn a_part_of_a_map_is_cut_out_of_the_whole() {
    let _server = server();
    let ground = Ground::get();
    let (data, packs) = (ground.data(), ground.packs());
    let program = ["--scene", "demo", "--data", text(&data), "--packs", text(&packs), "--device", "cpu"];
    let map = |layer: &str, name: &str, more: &[&str]| {
        let path = ground.folder.join(format!("{layer}-{name}"));
        let asked = ["atlas", "--layer", layer, "-o", text(&path)];
        skyglow(&[&asked[..], &program[..], more].concat()).expect_status(0);
        raster(&path)
    };
    let all: &[&str] = &["--places", "300000"];
    let slopes: &[&str] = &["--places", "20000", "--measure", "slope", "--sky", "total"];
    for (layer, asked, least) in
        [("brightness", all, 20), ("brightness", slopes, 5), ("radiance", all, 20), ("elevation", all, 20)]
    {
        let whole = map(layer, "whole-of-parts.tif", asked);
        let part = map(layer, "part.tif", &[asked, &["--bounds=8.5,46.1,9.1,46.5"]].concat());
        let [left, top] = [0, 1].map(|axis| {
            let apart = (part.first[axis] - whole.first[axis]) / whole.pixel[axis];
            assert!((apart - apart.round()).abs() < 1e-6, "{layer}: {apart} pixels");
            apart.round() as usize
        });
        assert_eq!(part.pixel, whole.pixel);
        assert!(part.width > least && part.height > least && part.width < whole.width / 2);
        // Pixels whose middles lie within the bounds.
        let ends = [0, 1].map(|axis| {
            let size = [part.width, part.height][axis] as f64;
            [0.5, size - 0.5].map(|at| part.first[axis] + at * part.pixel[axis])
        });
        assert!(ends[0][0] >= 8.5 && ends[0][1] <= 9.1 && ends[1][0] <= 46.5 && ends[1][1] >= 46.1);
        for row in 0..part.height {
            let of_whole = &whole.values[(top + row) * whole.width + left..][..part.width];
            let of_part = &part.values[row * part.width..][..part.width];
            let bits = |values: &[f32]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(of_part), bits(of_whole), "{layer}: row {row}");
        }
    }
    for (bounds, words) in
        [("0,0,1,1", "within --bounds"), ("9,46,8", "four numbers"), ("8,47,9,46", "four numbers")]
    {
        let asked = ["atlas", "-o", "part.tif", "--bounds", bounds];
        let refused = skyglow(&[&asked[..], &program[..]].concat()).expect_status(2);
        assert!(refused.stderr.contains(words), "{bounds}: {}", refused.stderr);
    }
}

/// A GeoTIFF of one band in degrees.
struct Raster {
    width: usize,
    height: usize,
    /// Longitude and latitude of the north-western corner.
    first: [f64; 2],
    /// From one pixel to the next.
    pixel: [f64; 2],
    values: Vec<f32>,
}

fn raster(path: &Path) -> Raster {
    use tiff::{
        decoder::{Decoder, DecodingResult},
        tags::Tag,
    };
    let mut file = Decoder::new(std::fs::File::open(path).unwrap()).unwrap();
    let (width, height) = file.dimensions().unwrap();
    let scale = file.get_tag_f64_vec(Tag::ModelPixelScaleTag).unwrap();
    let tie = file.get_tag_f64_vec(Tag::ModelTiepointTag).unwrap();
    let DecodingResult::F32(values) = file.read_image().unwrap() else { panic!("not of floats") };
    Raster {
        width: width as usize,
        height: height as usize,
        first: [tie[3], tie[4]],
        pixel: [scale[0], -scale[1]],
        values,
    }
}

/// The worked examples of `deploy/examples`, as their README has them run: with a shell and curl, and with Python, requests and
/// rasterio, which `make test` installs.
#[test]
fn the_worked_examples_of_a_municipality_run() {
    let server = server();
    let examples = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../deploy/examples");
    let run = |program: &str, script: &str, folder: &str| {
        let folder = Ground::get().folder.join(folder);
        std::fs::create_dir_all(&folder).unwrap();
        let output = std::process::Command::new(program)
            .arg(examples.join(script))
            .args([server.url.as_str(), text(&folder)])
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(output.status.success(), "{script}: {said}{}", String::from_utf8_lossy(&output.stderr));
        (said, folder)
    };
    let (said, folder) = run("sh", "municipality.sh", "municipality-sh");
    let number = |line: &str, word: usize| -> f64 {
        let line =
            said.lines().find(|known| known.starts_with(line)).unwrap_or_else(|| panic!("{line}: {said}"));
        line.split(' ').nth(word).unwrap().parse().unwrap_or_else(|_| panic!("{line}"))
    };
    let (today, with_plan) = (number("zenith:", 1), number("with the plan:", 3));
    assert!(with_plan > today + 0.005 && (0.01..1.0).contains(&number("ours:", 1)), "{said}");
    for file in ["influence.tif", "plan.tif", "plan.geojson", "plan.csv"] {
        assert!(std::fs::metadata(folder.join(file)).unwrap().len() > 500, "{file}");
    }
    // Debian's packages belong to Debian's Python, which need not be the first on the path.
    let has_rasterio = |python: &&str| {
        let mut import = std::process::Command::new(python);
        import.args(["-c", "import rasterio, requests"]).output().is_ok_and(|output| output.status.success())
    };
    let python = ["python3", "/usr/bin/python3"].into_iter().find(has_rasterio);
    let python =
        python.expect("Python with rasterio and requests: scripts/system_packages.sh test installs them");
    let (said, _) = run(python, "municipality.py", "municipality-py");
    assert!(said.contains("plan and amber: "), "{said}");
}
