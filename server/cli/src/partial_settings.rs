//! One source of settings: the TOML file, or the flags with the environment. All use the names of [`PartialSettings`].

use crate::{
    device::Device,
    failure::Failure,
    settings::{Settings, line_of},
};
use clap::{Args, builder::BoolishValueParser};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::{
    net::SocketAddr,
    path::{Path, PathBuf},
};
use toml::Table;

/// One source of settings: the file, or the flags with their environment variables. What is not said is left to
/// the source below.
#[derive(Clone, Debug, Default, PartialEq, Args, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
#[schemars(title = "Configuration of the Skyglow server")]
pub(crate) struct PartialSettings {
    /// Address and port to listen on; port 0 takes a free one and logs it [default: 127.0.0.1:8080]
    #[arg(long, env = "SKYGLOW_LISTEN", value_name = "ADDRESS:PORT")]
    pub(crate) listen: Option<SocketAddr>,
    /// Folder of the scenes [default: $XDG_DATA_HOME/skyglow, else ~/.local/share/skyglow]
    #[arg(long, env = "SKYGLOW_DATA", value_name = "DIR")]
    pub(crate) data: Option<PathBuf>,
    /// Folder of the table packs [default: those that come with the program]
    #[arg(long, env = "SKYGLOW_PACKS", value_name = "DIR")]
    pub(crate) packs: Option<PathBuf>,
    /// What renders: a GPU, Mesa's lavapipe, plain Rust, or the best there is [default: auto]
    #[arg(long, env = "SKYGLOW_DEVICE", value_enum)]
    pub(crate) device: Option<Device>,
    /// Do not make the demo scene (`--no-demo=false` overrides a file)
    #[arg(long, env = "SKYGLOW_NO_DEMO", value_parser = BoolishValueParser::new(), value_name = "BOOL",
          num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    pub(crate) no_demo: Option<bool>,
    /// Requests that make something, those that wait for their turn included; more are answered 503 [default: 128]
    #[arg(long, env = "SKYGLOW_CONCURRENT_REQUESTS", value_name = "N", help_heading = "Limits")]
    pub(crate) concurrent_requests: Option<usize>,
    /// Longest time for one answer, seconds; then 503 [default: 30]
    #[arg(long, env = "SKYGLOW_REQUEST_TIMEOUT_S", value_name = "SECONDS", help_heading = "Limits")]
    pub(crate) request_timeout_s: Option<f64>,
    /// Longest request body, bytes; then 413 [default: 2097152]
    #[arg(long, env = "SKYGLOW_BODY_LIMIT_BYTES", value_name = "BYTES", help_heading = "Limits")]
    pub(crate) body_limit_bytes: Option<usize>,
    /// Longest upload of a scene's rasters together, bytes; then 413 [default: 2147483648]
    #[arg(long, env = "SKYGLOW_UPLOAD_LIMIT_BYTES", value_name = "BYTES", help_heading = "Limits")]
    pub(crate) upload_limit_bytes: Option<usize>,
    /// Longest time for an upload to arrive and be checked, seconds [default: 1800]
    #[arg(long, env = "SKYGLOW_UPLOAD_TIMEOUT_S", value_name = "SECONDS", help_heading = "Limits")]
    pub(crate) upload_timeout_s: Option<f64>,
    /// Pixels that an uploaded raster may have [default: 400000000]
    #[arg(long, env = "SKYGLOW_UPLOAD_PIXELS", value_name = "N", help_heading = "Limits")]
    pub(crate) upload_pixels: Option<u64>,
    /// Requests a second from one client on average, 0 for no limit; more are answered 429 [default: 100]
    #[arg(long, env = "SKYGLOW_REQUESTS_PER_SECOND", value_name = "N", help_heading = "Limits")]
    pub(crate) requests_per_second: Option<f64>,
    /// Requests that one client may send at once [default: 1000]
    #[arg(long, env = "SKYGLOW_REQUEST_BURST", value_name = "N", help_heading = "Limits")]
    pub(crate) request_burst: Option<u32>,
    /// Scenarios and plans, counted by 16 kB, that one client may have kept in a day; 0 for no limit [default: 500]
    #[arg(long, env = "SKYGLOW_KEPT_PER_DAY", value_name = "N", help_heading = "Limits")]
    pub(crate) kept_per_day: Option<u32>,
    /// Seconds of long work (influences, plans, rasters of layers) a minute that one client may have on average; 0 for no limit
    /// [default: 60]
    #[arg(long, env = "SKYGLOW_WORK_PER_MINUTE_S", value_name = "SECONDS", help_heading = "Limits")]
    pub(crate) work_per_minute_s: Option<f64>,
    /// Seconds of long work that one client may have at once [default: 600]
    #[arg(long, env = "SKYGLOW_WORK_BURST_S", value_name = "SECONDS", help_heading = "Limits")]
    pub(crate) work_burst_s: Option<f64>,
    /// Longest time for the answers under way when the server is told to end, seconds [default: 10]
    #[arg(long, env = "SKYGLOW_DRAIN_TIMEOUT_S", value_name = "SECONDS", help_heading = "Limits")]
    pub(crate) drain_timeout_s: Option<f64>,
    /// Most bytes of computed skies that are kept for the next request [default: 67108864]
    #[arg(long, env = "SKYGLOW_CACHE_BYTES", value_name = "BYTES", help_heading = "Limits")]
    pub(crate) cache_bytes: Option<u64>,
    /// Most bytes of pictures, rasters and map tiles that are kept as they were sent [default: 268435456]
    #[arg(long, env = "SKYGLOW_ANSWER_CACHE_BYTES", value_name = "BYTES", help_heading = "Limits")]
    pub(crate) answer_cache_bytes: Option<u64>,
    /// Most bytes of maps of influences that are kept for the next request and for map tiles [default: 268435456]
    #[arg(long, env = "SKYGLOW_INFLUENCE_CACHE_BYTES", value_name = "BYTES", help_heading = "Limits")]
    pub(crate) influence_cache_bytes: Option<u64>,
    /// Most bytes of maps of the zenith's brightness that are kept for map tiles [default: 67108864]
    #[arg(long, env = "SKYGLOW_BRIGHTNESS_CACHE_BYTES", value_name = "BYTES", help_heading = "Limits")]
    pub(crate) brightness_cache_bytes: Option<u64>,
    /// Bytes of memory for what is under way: pictures, answers until they are sent, plans, bodies of requests; 0 for a fourth of
    /// what the control group or the machine has beside packs [default: 0]
    #[arg(long, env = "SKYGLOW_MEMORY_BUDGET_BYTES", value_name = "BYTES", help_heading = "Limits")]
    pub(crate) memory_budget_bytes: Option<u64>,
    /// Places in a map of the zenith's brightness at most; in larger scenes pixels share one by blocks [default: 1200000]
    #[arg(long, env = "SKYGLOW_BRIGHTNESS_PLACES", value_name = "N", help_heading = "Limits")]
    pub(crate) brightness_places: Option<usize>,
    /// Object store where servers share scenes, scenarios and plans: s3://BUCKET/PREFIX, gs://BUCKET/PREFIX or
    /// az://CONTAINER/PREFIX (with AWS_*, GOOGLE_* or AZURE_* variables), or file:///FOLDER that all of them mount [default: none, and they are kept in the data folder]
    #[arg(long, env = "SKYGLOW_STORE", value_name = "URL")]
    pub(crate) store: Option<String>,
    /// Valkey or Redis where servers share limits and drafts: redis://:PASSWORD@HOST:6379 [default: none, each has its own]
    #[arg(long, env = "SKYGLOW_VALKEY", value_name = "URL", hide_env_values = true)]
    pub(crate) valkey: Option<String>,
    /// Scenarios and as many plans that are kept; the oldest go first [default: 5000]
    #[arg(long, env = "SKYGLOW_KEPT_PLANS", value_name = "N", help_heading = "Limits")]
    pub(crate) kept_plans: Option<usize>,
    /// Bytes on disk of scenarios, and as many of plans, that are kept [default: 1073741824]
    #[arg(long, env = "SKYGLOW_KEPT_PLANS_BYTES", value_name = "BYTES", help_heading = "Limits")]
    pub(crate) kept_plans_bytes: Option<u64>,
    /// Days that scenarios and plans are kept [default: 90]
    #[arg(long, env = "SKYGLOW_KEPT_PLANS_DAYS", value_name = "DAYS", help_heading = "Limits")]
    pub(crate) kept_plans_days: Option<u32>,
    /// File with the operator's token, 20 characters or more: it lets PUT and DELETE scenes [default: none, and nobody may]
    #[arg(long, env = "SKYGLOW_OPERATOR_TOKEN_FILE", value_name = "FILE")]
    pub(crate) operator_token_file: Option<PathBuf>,
    /// TOML file of [[key]] tables: name, blake3 of the key, requests_per_second, request_burst, requests_per_day
    #[arg(long, env = "SKYGLOW_API_KEYS_FILE", value_name = "FILE")]
    pub(crate) api_keys_file: Option<PathBuf>,
    /// Do not start where the kernel lacks Landlock or seccomp, that uploads are read behind [default: a warning]
    #[arg(long, env = "SKYGLOW_UPLOAD_SANDBOX_REQUIRED", value_parser = BoolishValueParser::new(), value_name = "BOOL",
          num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    pub(crate) upload_sandbox_required: Option<bool>,
    /// Collector that spans of requests are sent to, by OTLP over HTTP, as http://HOST:4318; OTEL_* variables hold [default: none]
    #[arg(long, env = "SKYGLOW_OTLP_ENDPOINT", value_name = "URL")]
    pub(crate) otlp_endpoint: Option<String>,
    /// Connections at a time, a fourth of them from one address [default: 2048]
    #[arg(long, env = "SKYGLOW_CONNECTIONS", value_name = "N", help_heading = "Limits")]
    pub(crate) connections: Option<usize>,
    /// Longest wait for the head of a request, and for a client to take what it is sent, seconds [default: 30]
    #[arg(long, env = "SKYGLOW_IDLE_TIMEOUT_S", value_name = "SECONDS", help_heading = "Limits")]
    pub(crate) idle_timeout_s: Option<f64>,
    /// Networks of proxies that are believed in X-Forwarded-* and Forwarded, as 10.0.0.7/32,fd00::7/128 [default: none]
    #[arg(long, env = "SKYGLOW_TRUSTED_PROXIES", value_name = "NETWORKS", value_delimiter = ',')]
    pub(crate) trusted_proxies: Option<Vec<String>>,
    /// How much of a client's address the log has: nothing, its network (/24 of IPv4, /48 of IPv6), or all of it [default: off]
    #[arg(long, env = "SKYGLOW_LOG_CLIENT_ADDRESS", value_name = "HOW", value_parser = ["off", "truncated", "full"])]
    pub(crate) log_client_address: Option<String>,
    /// Where clients reach the server, for links in answers [default: as trusted proxies and the Host header say]
    #[arg(long, env = "SKYGLOW_PUBLIC_URL", value_name = "URL")]
    pub(crate) public_url: Option<String>,
    /// PMTiles file of vector tiles with Protomaps' layers, which the viewer's map shows below the lights [default: none]
    #[arg(long, env = "SKYGLOW_BASEMAP", value_name = "FILE")]
    pub(crate) basemap: Option<PathBuf>,
    /// PMTiles files of maps of brightness that skyglow atlas made, whose tiles are shown in place of the same maps computed: paths, or
    /// s3://BUCKET/NAME.pmtiles, gs:// or az:// [default: none]
    #[arg(long, env = "SKYGLOW_ATLASES", value_name = "FILES", value_delimiter = ',')]
    pub(crate) atlases: Option<Vec<String>>,
    /// Origins of other sites whose pages may have scenarios and plans stored, as https://maps.example.org, or * [default: none]
    #[arg(long, env = "SKYGLOW_CORS_ORIGINS", value_name = "ORIGINS", value_delimiter = ',')]
    pub(crate) cors_origins: Option<Vec<String>>,
}

/// The file, the line and what is wrong there.
fn broken_toml(path: &Path, text: &str, error: &toml::de::Error) -> Failure {
    let reason = error.message().lines().next().unwrap_or_default().to_owned();
    Failure::Work(format!("{}:{}: {reason}", path.display(), line_of(text, error)))
}

impl PartialSettings {
    /// Reads a TOML file.
    ///
    /// # Errors
    /// [`Failure::Work`] with the file, the line and what is wrong there.
    pub(crate) fn from_file(path: &Path) -> Result<Self, Failure> {
        let text = std::fs::read_to_string(path).map_err(|e| Failure::file(path, e))?;
        toml::from_str(&text).map_err(|error| broken_toml(path, &text, &error))
    }

    /// This layer over that of a file, if any, over the defaults.
    ///
    /// # Errors
    /// [`Failure::Work`] naming the file and what is wrong with it.
    pub(crate) fn over_file(&self, file: Option<&Path>) -> Result<Settings, Failure> {
        let file = file.map(Self::from_file).transpose()?.unwrap_or_default();
        self.over(&file)
    }

    fn over(&self, below: &Self) -> Result<Settings, Failure> {
        let mut table = Table::try_from(Settings::default()).map_err(Failure::work)?;
        for layer in [below, self] {
            table.extend(Table::try_from(layer).map_err(Failure::work)?);
        }
        let mut settings: Settings = table.try_into().map_err(Failure::work)?;
        // An empty variable is an empty list, and blanks may stand after its commas.
        for list in [&mut settings.http.atlases, &mut settings.http.cors_origins] {
            list.iter_mut().for_each(|item| *item = item.trim().to_owned());
            list.retain(|item| !item.is_empty());
        }
        settings.check()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use skyglow_http::HttpConfig;
    use skyglow_scene::ChangeLimits;

    fn from_text(text: &str) -> Result<PartialSettings, String> {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), text).unwrap();
        let name = file.path().display().to_string();
        PartialSettings::from_file(file.path()).map_err(|failure| failure.to_string().replace(&name, "FILE"))
    }

    /// A flag wins over the file and the file over the default.
    #[test]
    fn flags_win_over_the_file_over_defaults() {
        let file = from_text("listen = \"0.0.0.0:80\"\ndevice = \"cpu\"\nrequest_timeout_s = 5\n").unwrap();
        let flags = PartialSettings {
            device: Some(Device::Lavapipe),
            cache_bytes: Some(7),
            ..PartialSettings::default()
        };
        let settings = flags.over(&file).unwrap();
        let expected = Settings {
            listen: "0.0.0.0:80".parse().unwrap(),
            device: Device::Lavapipe,
            http: HttpConfig { request_timeout_s: 5.0, cache_bytes: 7, ..HttpConfig::default() },
            ..Settings::default()
        };
        assert_eq!(settings, expected);
    }

    #[test]
    fn nothing_said_leaves_the_defaults() {
        assert_eq!(
            PartialSettings::default().over(&PartialSettings::default()).unwrap(),
            Settings::default()
        );
    }

    #[test]
    fn a_wrong_file_is_refused_with_its_line() {
        let unknown = from_text("device = \"cpu\"\nlisen = \"0.0.0.0:80\"\n").unwrap_err();
        assert!(unknown.starts_with("FILE:2: unknown field `lisen`"), "{unknown}");
        let device = from_text("device = \"tpu\"\n").unwrap_err();
        assert!(device.starts_with("FILE:1: unknown variant `tpu`"), "{device}");
        assert!(from_text("listen = \"port 80\"\n").is_err());
        assert!(from_text("request_burst = -1\n").is_err());
        assert!(from_text("listen").is_err());
    }

    /// Numbers that no server can run with are refused all at once by name.
    #[test]
    fn unusable_numbers_are_refused_by_name() {
        let file = "request_timeout_s = 0\nrequest_burst = 0\npublic_url = \"sky.example.org\"\nrequests_per_second = -1\ncors_origins = [\"https://a.example/path\"]\n";
        let refused = PartialSettings::default().over(&from_text(file).unwrap()).unwrap_err().to_string();
        for name in
            ["request_timeout_s", "request_burst", "public_url", "requests_per_second", "cors_origins"]
        {
            assert!(refused.contains(&format!("{name} must be")), "{refused}");
        }
        assert!(!refused.contains("drain"), "{refused}");
    }

    /// Lists may be empty in the environment, and have blanks; what is no address of an atlas is refused.
    #[test]
    fn lists_are_trimmed_and_addresses_checked() {
        let with = |atlases: &[&str]| {
            let atlases = Some(atlases.iter().map(|&text| text.to_owned()).collect());
            let flags = PartialSettings { atlases, ..PartialSettings::default() };
            flags.over(&PartialSettings::default()).map(|settings| settings.http.atlases)
        };
        assert_eq!(with(&[""]).unwrap(), Vec::<String>::new());
        assert_eq!(with(&["s3://maps/a.pmtiles", " gs://maps/b.pmtiles"]).unwrap()[1], "gs://maps/b.pmtiles");
        for (address, reason) in
            [("http://maps/a.pmtiles", "neither a path nor"), ("/no/a.pmtiles", "No such file")]
        {
            let refused = with(&[address]).unwrap_err().to_string();
            assert!(refused.contains(address) && refused.contains(reason), "{refused}");
        }
    }

    /// Secrets are read from files and what is wrong with them never shows them.
    #[test]
    fn secrets_are_read_and_never_shown() {
        let write = |text: &str| {
            let file = tempfile::NamedTempFile::new().unwrap();
            std::fs::write(file.path(), text).unwrap();
            file
        };
        let hash = skyglow_http::access::hash_of("key");
        let keys = write(&format!(
            "[[key]]\nname = \"city\"\nblake3 = \"{hash}\"\nrequests_per_second = 5\nrequest_burst = 10\n"
        ));
        let (token, weak) = (write("a-token-of-some-length-1234\n"), write("secret\n"));
        let settings = |token: &tempfile::NamedTempFile, keys: &tempfile::NamedTempFile| Settings {
            operator_token_file: Some(token.path().to_owned()),
            api_keys_file: Some(keys.path().to_owned()),
            ..Settings::default()
        };
        assert!(settings(&token, &keys).access().unwrap().has_operator());
        let refused = settings(&weak, &keys).access().unwrap_err().to_string();
        assert!(refused.contains("20 characters") && !refused.contains("secret"), "{refused}");
        let broken = write("[[key]]\nname = \"city\"\nsecret = 3\n");
        let refused = settings(&token, &broken).access().unwrap_err().to_string();
        assert!(refused.contains(":3: ") && !refused.contains("secret"), "{refused}");
    }

    #[test]
    fn what_print_writes_can_be_read_back() {
        let mut settings = Settings::default();
        settings.http.public_url = Some("https://sky.example.org".to_owned());
        let layer = from_text(&toml::to_string(&settings).unwrap()).unwrap();
        assert_eq!(layer.over(&PartialSettings::default()).unwrap(), settings);
    }

    /// File flags and schema have a name for every setting and no other.
    #[test]
    fn file_flags_and_schema_name_every_setting() {
        let schema = serde_json::to_value(schemars::schema_for!(PartialSettings)).unwrap();
        assert_eq!(schema["additionalProperties"], serde_json::json!(false));
        let mut settings = Settings::default();
        settings.http.public_url = Some(String::new());
        settings.http.basemap = Some(PathBuf::new());
        settings.otlp_endpoint = Some(String::new());
        settings.store = Some(String::new());
        settings.valkey = Some(String::new());
        let settings = serde_json::to_value(settings).unwrap();
        let names = |value: &serde_json::Value| {
            let mut names: Vec<String> = value.as_object().unwrap().keys().cloned().collect();
            names.sort();
            names
        };
        assert_eq!(names(&schema["properties"]), names(&settings));
    }

    #[test]
    fn defaults_in_the_help_are_those_in_force() {
        let settings = serde_json::to_value(Settings::default()).unwrap();
        let command = PartialSettings::augment_args(clap::Command::new("test"));
        let mut compared = 0;
        for flag in command.get_arguments() {
            let help = flag.get_help().unwrap().to_string();
            let Some((_, default)) = help.split_once("[default: ") else { continue };
            let value = &settings[flag.get_id().as_str()];
            if let Some(number) = value.as_f64() {
                assert_eq!(default.trim_end_matches(']').parse(), Ok(number), "{}", flag.get_id());
                compared += 1;
            }
        }
        assert_eq!(compared, 23);
        assert_eq!(Settings::default().change_limits(), ChangeLimits::default());
    }
}
