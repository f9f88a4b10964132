//! What the server is told: a TOML file, over it the environment, over that flags.

use crate::{device::Device, failure::Failure, folders};
use serde::{Deserialize, Serialize};
use skyglow_http::{Access, ApiKey, Atlas, Basemap, HttpConfig, KeptStore, Valkey, access::AccessError};
use skyglow_scene::{ChangeLimits, ChangeStore, MAX_DRAFT_BYTES};
use std::{
    net::{Ipv4Addr, SocketAddr},
    path::{Path, PathBuf},
    sync::Arc,
    time::Duration,
};

/// What is in force.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Settings {
    /// Address and port to listen on.
    pub(crate) listen: SocketAddr,
    /// Folder of the scenes.
    pub(crate) data: PathBuf,
    /// Folder of the table packs.
    pub(crate) packs: PathBuf,
    /// What renders.
    pub(crate) device: Device,
    /// Whether to do without the demo scene.
    pub(crate) no_demo: bool,
    /// Places in a map of the zenith's brightness at most.
    pub(crate) brightness_places: usize,
    /// Object store of scenarios and plans, which servers share; None for the data folder.
    pub(crate) store: Option<String>,
    /// Valkey or Redis, where servers share limits and drafts.
    pub(crate) valkey: Option<String>,
    /// Scenarios and as many plans that are kept.
    pub(crate) kept_plans: usize,
    /// Bytes on disk of each.
    pub(crate) kept_plans_bytes: u64,
    /// Days that they are kept.
    pub(crate) kept_plans_days: u32,
    /// File with the operator's token.
    pub(crate) operator_token_file: Option<PathBuf>,
    /// File of known clients.
    pub(crate) api_keys_file: Option<PathBuf>,
    /// Whether no upload is read where the kernel lacks a part of the sandbox.
    pub(crate) upload_sandbox_required: bool,
    /// Collector of spans.
    pub(crate) otlp_endpoint: Option<String>,
    /// Limits of the interface.
    #[serde(flatten)]
    pub(crate) http: HttpConfig,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            listen: SocketAddr::from((Ipv4Addr::LOCALHOST, 8080)),
            data: folders::default_data_folder(),
            packs: folders::default_packs_folder(),
            device: Device::default(),
            no_demo: false,
            brightness_places: skyglow_observatory::MAX_PLACES,
            store: None,
            valkey: None,
            kept_plans: 5000,
            kept_plans_bytes: 1 << 30,
            kept_plans_days: 90,
            operator_token_file: None,
            api_keys_file: None,
            upload_sandbox_required: false,
            otlp_endpoint: None,
            http: HttpConfig::default(),
        }
    }
}

/// The file of known clients.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct KeysFile {
    #[serde(default)]
    key: Vec<ApiKey>,
}

impl Settings {
    /// What no server can run with, each setting by its name.
    ///
    /// # Errors
    /// [`Failure::Work`] with everything that is wrong.
    pub(crate) fn check(self) -> Result<Self, Failure> {
        let http = &self.http;
        let mut wrong = Vec::new();
        let mut require = |is_fine: bool, name: &str, allowed: &str| {
            if !is_fine {
                wrong.push(format!("{name} must be {allowed}"));
            }
        };
        let is_time = |seconds: f64| seconds > 0.0 && seconds <= 86_400.0;
        require(is_time(http.request_timeout_s), "request_timeout_s", "above 0 and at most 86400");
        require(is_time(http.upload_timeout_s), "upload_timeout_s", "above 0 and at most 86400");
        require((0.0..=86_400.0).contains(&http.drain_timeout_s), "drain_timeout_s", "0 to 86400");
        let rate = http.requests_per_second;
        require(
            rate.is_finite() && rate >= 0.0,
            "requests_per_second",
            "a number of 0 or more; 0 is no limit",
        );
        let is_share = |seconds: f64| seconds.is_finite() && seconds >= 0.0;
        let allowed = "a number of 0 or more; 0 is no limit";
        require(is_share(http.work_per_minute_s), "work_per_minute_s", allowed);
        require(is_time(http.work_burst_s), "work_burst_s", "above 0 and at most 86400");
        require(is_time(http.idle_timeout_s), "idle_timeout_s", "above 0 and at most 86400");
        require(http.connections >= 4, "connections", "4 or more");
        require(http.request_burst > 0, "request_burst", "1 or more");
        require(http.concurrent_requests > 0, "concurrent_requests", "1 or more");
        require(http.body_limit_bytes >= 1024, "body_limit_bytes", "1024 or more");
        let budget = http.memory_budget_bytes;
        let allowed = "0, which is a part of what there is, or 67108864 or more";
        require(budget == 0 || budget >= 64 << 20, "memory_budget_bytes", allowed);
        require(http.upload_pixels > 0, "upload_pixels", "1 or more");
        require(self.brightness_places > 0, "brightness_places", "1 or more");
        require(self.kept_plans > 0, "kept_plans", "1 or more");
        let map_bytes = self.brightness_map_bytes();
        let allowed = "6 times brightness_places or more: no map would be kept";
        require(http.brightness_cache_bytes >= map_bytes, "brightness_cache_bytes", allowed);
        let is_url = |url: &String| {
            let rest = url.strip_prefix("https://").or_else(|| url.strip_prefix("http://"));
            rest.is_some_and(|rest| {
                !rest.is_empty() && !rest.contains(|c: char| c.is_whitespace() || "?#<>\"".contains(c))
            })
        };
        let url = http.public_url.as_ref();
        require(url.is_none_or(is_url), "public_url", "an address such as https://sky.example.org");
        let is_origin = |origin: &String| origin == "*" || is_url(origin) && origin.matches('/').count() == 2;
        let allowed = "origins such as https://maps.example.org, without a path, or *";
        require(http.cors_origins.iter().all(is_origin), "cors_origins", allowed);
        if let Some(error) = http.basemap.as_ref().and_then(|path| Basemap::open(path).err()) {
            require(false, "basemap", &format!("a PMTiles file of vector tiles: {error}"));
        }
        for address in &http.atlases {
            let scheme = address.split_once("://").map(|(scheme, _)| scheme);
            let wrong = match scheme {
                // A store may be away now and there later.
                Some("s3" | "gs" | "az") => None,
                Some("file") | None => Atlas::open(address).err().map(|error| error.to_string()),
                Some(_) => {
                    Some("it is neither a path nor s3://BUCKET/NAME.pmtiles, gs:// or az://".to_owned())
                }
            };
            if let Some(reason) = wrong {
                require(false, "atlases", &format!("PMTiles files of maps: {address}: {reason}"));
            }
        }
        let collector = self.otlp_endpoint.as_ref();
        let is_plain = |url: &String| url.starts_with("http://") && is_url(url);
        require(collector.is_none_or(is_plain), "otlp_endpoint", "an address such as http://collector:4318");
        if wrong.is_empty() { Ok(self) } else { Err(Failure::Work(wrong.join("; "))) }
    }

    /// Bytes of a map of the zenith's brightness.
    pub(crate) fn brightness_map_bytes(&self) -> u64 {
        6 * self.brightness_places as u64
    }

    /// Who may do more than read: reads the files of secrets.
    ///
    /// # Errors
    /// [`Failure::Work`] naming the file and what is wrong with it; never what is in it.
    pub(crate) fn access(&self) -> Result<Access, Failure> {
        let read = |path: &PathBuf| std::fs::read_to_string(path).map_err(|error| Failure::file(path, error));
        let token = self.operator_token_file.as_ref().map(read).transpose()?;
        let keys = match &self.api_keys_file {
            Some(path) => {
                let text = read(path)?;
                // What the parser says would show what is there, which may be a key.
                let file: KeysFile = toml::from_str(&text).map_err(|error| {
                    let place = format!("{}:{}", path.display(), line_of(&text, &error));
                    Failure::Work(format!("{place}: is not as a file of keys is"))
                })?;
                file.key
            }
            None => Vec::new(),
        };
        Access::new(token.as_deref().map(str::trim), keys).map_err(|error| {
            let path = match error {
                AccessError::WeakToken => &self.operator_token_file,
                _ => &self.api_keys_file,
            };
            let path = path.as_deref().unwrap_or(Path::new("configuration"));
            Failure::Work(format!("{}: {error}", path.display()))
        })
    }

    /// The store that servers share, if there is one.
    ///
    /// # Errors
    /// [`Failure::Work`] where its address cannot be used.
    pub(crate) fn kept_store(&self) -> Result<Option<Arc<KeptStore>>, Failure> {
        self.store.as_ref().map(|address| open_store(address)).transpose()
    }

    /// Where scenarios and plans are kept.
    ///
    /// # Errors
    /// [`Failure::Work`] where it is a store that cannot be read and written.
    pub(crate) fn changes(
        &self,
        store: Option<Arc<KeptStore>>,
        limits: ChangeLimits,
    ) -> Result<ChangeStore, Failure> {
        let Some(store) = store else { return Ok(ChangeStore::new(&self.data, limits)) };
        ChangeStore::in_store(&self.data, limits, store).map_err(Failure::work)
    }

    /// Where limits and drafts are shared; it is not asked yet.
    ///
    /// # Errors
    /// [`Failure::Work`] where its address cannot be used.
    pub(crate) fn valkey(&self) -> Result<Option<Arc<Valkey>>, Failure> {
        let open = |address: &String| Valkey::new(address).map(Arc::new).map_err(Failure::work);
        self.valkey.as_ref().map(open).transpose()
    }

    /// What is kept of scenarios and plans.
    pub(crate) fn change_limits(&self) -> ChangeLimits {
        ChangeLimits {
            count: self.kept_plans.max(1),
            bytes: self.kept_plans_bytes,
            age: Duration::from_secs(86_400 * u64::from(self.kept_plans_days)),
            draft_bytes: MAX_DRAFT_BYTES,
        }
    }
}

/// The line that an error is in, from 1.
pub(crate) fn line_of(text: &str, error: &toml::de::Error) -> usize {
    error.span().map_or(1, |span| 1 + text[..span.start].matches('\n').count())
}

/// The store at an address, with the credentials of the environment.
///
/// # Errors
/// [`Failure::Work`] where the address cannot be used.
pub(crate) fn open_store(address: &str) -> Result<Arc<KeptStore>, Failure> {
    KeptStore::of_environment(address).map(Arc::new).map_err(Failure::work)
}
