//! The store of what is kept, where several servers share one: a bucket of S3, or of what speaks as S3 does, of Google Cloud Storage or
//! of Azure Blob Storage, or a folder that all of them mount.

use axum::body::Bytes;
use futures_util::TryStreamExt;
use object_store::{
    ClientConfigKey, Error, GetOptions, GetRange, ObjectMeta, ObjectStore, ObjectStoreExt, PutMode,
    PutPayload, RetryConfig,
    aws::{AmazonS3Builder, AmazonS3ConfigKey},
    azure::{AzureConfigKey, MicrosoftAzureBuilder},
    gcp::{GoogleCloudStorageBuilder, GoogleConfigKey},
    local::LocalFileSystem,
    path::Path,
};
use skyglow_scene::{DocumentStore, StoreAway, StoredObject};
use std::{
    future::Future,
    io::{Read as _, Write as _},
    sync::{Arc, mpsc},
    time::{Duration, SystemTime},
};
use tokio::runtime::{Builder, Runtime};

/// How long a try of a question to the store may take, and how long all tries of it.
const TRY_TIMEOUT: &str = "10s";
const CONNECT_TIMEOUT: &str = "2s";
const TIMEOUT: Duration = Duration::from_secs(15);
const MAX_RETRIES: usize = 3;
/// How long a whole file of a scene may take.
const FILE_TIMEOUT: Duration = Duration::from_secs(3600);
/// How long a part of a file may take that somebody waits for.
const PART_TIMEOUT: Duration = Duration::from_secs(5);
/// Files are sent in parts of so many bytes.
const PIECE_BYTES: usize = 16 << 20;

/// Why there is no store.
#[derive(Debug, thiserror::Error)]
pub enum KeptStoreError {
    /// Not an address of one.
    #[error(
        "{address:?} is no store: s3://BUCKET/PREFIX, gs://BUCKET/PREFIX, az://CONTAINER/PREFIX, or file:///FOLDER that all servers mount"
    )]
    BadAddress {
        /// What was said.
        address: String,
    },
    /// It cannot be had as it is described.
    #[error("{address}: {reason}")]
    Refused {
        /// Its address.
        address: String,
        /// What is wrong.
        reason: String,
    },
}

/// An object store behind calls that wait, on threads of its own.
#[derive(Debug)]
pub struct KeptStore {
    address: String,
    prefix: Path,
    store: Arc<dyn ObjectStore>,
    /// Taken only when this is dropped.
    runtime: Option<Runtime>,
}

impl KeptStore {
    /// Names of variables of the environment that have a store's credentials and endpoints begin so.
    pub const VARIABLES: [&'static str; 3] = ["AWS_", "AZURE_", "GOOGLE_"];

    /// The store at an address, with the credentials of the environment.
    ///
    /// # Errors
    /// [`KeptStoreError`].
    pub fn of_environment(address: &str) -> Result<Self, KeptStoreError> {
        let variables = std::env::vars_os()
            .filter_map(|(name, value)| Some((name.into_string().ok()?, value.into_string().ok()?)));
        let options: Vec<_> = variables
            .filter(|(name, _)| Self::VARIABLES.iter().any(|start| name.starts_with(start)))
            .collect();
        Self::open(address, &options)
    }

    /// The store at an address.
    ///
    /// * `options`: names and values of such variables.
    ///
    /// # Errors
    /// [`KeptStoreError`].
    pub fn open(address: &str, options: &[(String, String)]) -> Result<Self, KeptStoreError> {
        let bad = || KeptStoreError::BadAddress { address: address.to_owned() };
        let refused = |reason: String| KeptStoreError::Refused { address: address.to_owned(), reason };
        let (scheme, rest) = address.split_once("://").ok_or_else(bad)?;
        let (bucket, prefix) = rest.split_once('/').unwrap_or((rest, ""));
        if bucket.is_empty() && scheme != "file" {
            return Err(bad());
        }
        // The builders have the same methods and no trait in common.
        macro_rules! bucket {
            ($builder:ty, $key:ty, $with_name:ident) => {{
                let mut builder = <$builder>::new()
                    .with_config(<$key>::Client(ClientConfigKey::Timeout), TRY_TIMEOUT)
                    .with_config(<$key>::Client(ClientConfigKey::ConnectTimeout), CONNECT_TIMEOUT);
                for (name, value) in options {
                    // What else is in the environment is nothing to this store.
                    if let Ok(key) = name.to_ascii_lowercase().parse::<$key>() {
                        builder = builder.with_config(key, value);
                    }
                }
                let retry = RetryConfig {
                    max_retries: MAX_RETRIES,
                    retry_timeout: TIMEOUT,
                    ..RetryConfig::default()
                };
                let builder = builder.$with_name(bucket).with_retry(retry);
                Arc::new(builder.build().map_err(|error| refused(words(&error)))?)
            }};
        }
        let (store, prefix): (Arc<dyn ObjectStore>, &str) = match scheme {
            "s3" => (bucket!(AmazonS3Builder, AmazonS3ConfigKey, with_bucket_name), prefix),
            "gs" => (bucket!(GoogleCloudStorageBuilder, GoogleConfigKey, with_bucket_name), prefix),
            "az" => (bucket!(MicrosoftAzureBuilder, AzureConfigKey, with_container_name), prefix),
            "file" if rest.starts_with('/') && rest.len() > 1 => {
                std::fs::create_dir_all(rest).map_err(|error| refused(error.to_string()))?;
                let store = LocalFileSystem::new_with_prefix(rest).map_err(|error| refused(words(&error)))?;
                (Arc::new(store.with_fsync(true)), "")
            }
            _ => return Err(bad()),
        };
        let runtime = Builder::new_multi_thread().worker_threads(2).thread_name("store").enable_all().build();
        Ok(Self {
            address: address.to_owned(),
            prefix: Path::from(prefix),
            store,
            runtime: Some(runtime.map_err(|error| refused(error.to_string()))?),
        })
    }

    fn path(&self, name: &str) -> Path {
        Path::from(format!("{}/{name}", self.prefix))
    }

    fn no_bucket(&self) -> StoreAway {
        StoreAway { reason: format!("{}: there is no such bucket", self.address) }
    }

    /// Has a question answered on the store's own threads, and waits.
    fn wait<T: Send + 'static>(
        &self,
        at_most: Duration,
        question: impl Future<Output = Result<T, Error>> + Send + 'static,
    ) -> Result<Result<T, Error>, StoreAway> {
        let (send, receive) = mpsc::sync_channel(1);
        let away = |reason: &str| StoreAway { reason: format!("{}: {reason}", self.address) };
        let runtime = self.runtime.as_ref().ok_or_else(|| away("is closed"))?;
        runtime.spawn(async move {
            let answer = tokio::time::timeout(at_most, question).await;
            // Who asked waits for it.
            let _is_waited_for = send.send(answer);
        });
        match receive.recv() {
            Ok(Ok(answer)) => Ok(answer),
            Ok(Err(_)) => Err(away("took too long")),
            Err(_) => Err(away("a thread failed")),
        }
    }

    /// Bytes of an object from one on, and what tells its version; fewer where it ends, None where it is not there.
    pub(crate) fn part(
        &self,
        name: &str,
        (from, count): (u64, usize),
    ) -> Result<Option<(Bytes, String)>, StoreAway> {
        let (store, path) = (self.store.clone(), self.path(name));
        let range = GetRange::Bounded(from..from.saturating_add(count as u64));
        self.ask_for(PART_TIMEOUT, async move {
            let found =
                store.get_opts(&path, GetOptions { range: Some(range), ..GetOptions::default() }).await?;
            let modified = || format!("{} {}", found.meta.size, found.meta.last_modified);
            let version = found.meta.e_tag.clone().unwrap_or_else(modified);
            Ok((found.bytes().await?, version))
        })
    }

    fn ask<T: Send + 'static>(
        &self,
        question: impl Future<Output = Result<T, Error>> + Send + 'static,
    ) -> Result<Option<T>, StoreAway> {
        self.ask_for(2 * TIMEOUT, question)
    }

    fn ask_for<T: Send + 'static>(
        &self,
        at_most: Duration,
        question: impl Future<Output = Result<T, Error>> + Send + 'static,
    ) -> Result<Option<T>, StoreAway> {
        match self.wait(at_most, question)? {
            Ok(answer) => Ok(Some(answer)),
            Err(Error::NotFound { .. }) => Ok(None),
            Err(error) => Err(StoreAway { reason: format!("{}: {}", self.address, words(&error)) }),
        }
    }
}

impl Drop for KeptStore {
    fn drop(&mut self) {
        // Also where that is a thread that must not wait.
        if let Some(runtime) = self.runtime.take() {
            runtime.shutdown_background();
        }
    }
}

/// An error with its causes, in one line.
fn words(error: &dyn std::error::Error) -> String {
    let mut words = error.to_string();
    let mut next = error.source();
    while let Some(cause) = next {
        let cause_words = cause.to_string();
        if !words.contains(&cause_words) {
            words = format!("{words}: {cause_words}");
        }
        next = cause.source();
    }
    words.split_whitespace().collect::<Vec<_>>().join(" ").chars().take(500).collect()
}

fn of_file(source: std::io::Error) -> Error {
    Error::Generic { store: "file", source: Box::new(source) }
}

/// Reads until a buffer is full or the file ends; the number of bytes.
fn read_whole(file: &mut std::fs::File, buffer: &mut [u8]) -> std::io::Result<usize> {
    let mut length = 0;
    while length < buffer.len() {
        match file.read(&mut buffer[length..])? {
            0 => break,
            more => length += more,
        }
    }
    Ok(length)
}

impl DocumentStore for KeptStore {
    fn address(&self) -> String {
        self.address.clone()
    }

    fn get(&self, name: &str) -> Result<Option<(Vec<u8>, SystemTime)>, StoreAway> {
        let (store, path) = (self.store.clone(), self.path(name));
        self.ask(async move {
            let found = store.get(&path).await?;
            let modified = found.meta.last_modified.into();
            Ok((found.bytes().await?.to_vec(), modified))
        })
    }

    fn modified(&self, name: &str) -> Result<Option<SystemTime>, StoreAway> {
        let (store, path) = (self.store.clone(), self.path(name));
        self.ask(async move { store.head(&path).await.map(|found| found.last_modified.into()) })
    }

    fn put(&self, name: &str, bytes: &[u8]) -> Result<(), StoreAway> {
        let (store, path) = (self.store.clone(), self.path(name));
        let payload = PutPayload::from(bytes.to_vec());
        self.ask(async move { store.put(&path, payload).await.map(drop) })?.ok_or_else(|| self.no_bucket())
    }

    fn put_new(&self, name: &str, bytes: &[u8]) -> Result<bool, StoreAway> {
        let (store, path) = (self.store.clone(), self.path(name));
        let payload = PutPayload::from(bytes.to_vec());
        let put = self.ask(async move {
            match store.put_opts(&path, payload, PutMode::Create.into()).await {
                Ok(_) => Ok(true),
                Err(Error::AlreadyExists { .. }) => Ok(false),
                Err(error) => Err(error),
            }
        })?;
        put.ok_or_else(|| self.no_bucket())
    }

    fn remove(&self, name: &str) -> Result<(), StoreAway> {
        let (store, path) = (self.store.clone(), self.path(name));
        self.ask(async move { store.delete(&path).await }).map(drop)
    }

    fn download(&self, name: &str, path: &std::path::Path) -> Result<bool, StoreAway> {
        let (store, from, to) = (self.store.clone(), self.path(name), path.to_owned());
        let download = async move {
            // Pieces of it, for a try has only so long.
            let size = store.head(&from).await?.size;
            let mut file = std::fs::File::create_new(to).map_err(of_file)?;
            let mut start = 0;
            while start < size {
                let end = size.min(start + PIECE_BYTES as u64);
                file.write_all(&store.get_range(&from, start..end).await?).map_err(of_file)?;
                start = end;
            }
            file.sync_all().map_err(of_file)
        };
        Ok(self.ask_for(FILE_TIMEOUT, download)?.is_some())
    }

    fn upload(&self, name: &str, path: &std::path::Path) -> Result<(), StoreAway> {
        let (store, from, to) = (self.store.clone(), path.to_owned(), self.path(name));
        let upload = async move {
            let mut file = std::fs::File::open(from).map_err(of_file)?;
            let mut piece = vec![0; PIECE_BYTES];
            let mut read = move || {
                let length = read_whole(&mut file, &mut piece).map_err(of_file)?;
                Ok::<_, Error>(PutPayload::from(piece[..length].to_vec()))
            };
            let mut next = read()?;
            if next.content_length() < PIECE_BYTES {
                return store.put(&to, next).await.map(drop);
            }
            let mut upload = store.put_multipart(&to).await?;
            // One part after another: memory is that of a piece.
            let sent = async {
                while next.content_length() > 0 {
                    upload.put_part(next).await?;
                    next = read()?;
                }
                upload.complete().await.map(drop)
            };
            let sent = sent.await;
            if sent.is_err() {
                // What a store does with the rest of it is its own affair.
                let _best_effort = upload.abort().await;
            }
            sent
        };
        self.ask_for(FILE_TIMEOUT, upload)?.ok_or_else(|| self.no_bucket())
    }

    fn list(&self, folder: &str) -> Result<Vec<StoredObject>, StoreAway> {
        let (store, path) = (self.store.clone(), self.path(folder));
        let found: Option<Vec<ObjectMeta>> =
            self.ask(async move { store.list(Some(&path)).try_collect().await })?;
        let prefix = format!("{folder}/");
        let object = |found: ObjectMeta| StoredObject {
            name: format!("{prefix}{}", found.location.filename().unwrap_or_default()),
            modified: found.last_modified.into(),
        };
        Ok(found.ok_or_else(|| self.no_bucket())?.into_iter().map(object).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is written is read, once; what is no address is refused.
    #[test]
    fn a_folder_is_a_store() {
        let folder = tempfile::tempdir().unwrap();
        let store = KeptStore::open(&format!("file://{}/kept", folder.path().display()), &[]).unwrap();
        assert_eq!(store.list("plans").unwrap(), []);
        assert!(store.put_new("plans/p-1.json", b"one").unwrap());
        assert!(!store.put_new("plans/p-1.json", b"two").unwrap());
        let (bytes, modified) = store.get("plans/p-1.json").unwrap().unwrap();
        assert_eq!(
            (bytes.as_slice(), Some(modified)),
            (&b"one"[..], store.modified("plans/p-1.json").unwrap())
        );
        store.put("plans/p-1.json", b"three").unwrap();
        assert_eq!(store.get("plans/p-1.json").unwrap().unwrap().0, b"three");
        // Files go and come whole, in one part and in several.
        for length in [0, 100, 2 * PIECE_BYTES + 7] {
            let (file, copy) = (folder.path().join("file"), folder.path().join(format!("copy-{length}")));
            let content: Vec<u8> = (0..length).map(|byte| (byte % 251) as u8).collect();
            std::fs::write(&file, &content).unwrap();
            store.upload("files/one.bin", &file).unwrap();
            assert!(store.download("files/one.bin", &copy).unwrap());
            assert!(std::fs::read(&copy).unwrap() == content, "{length}");
            assert!(store.download("files/one.bin", &copy).is_err(), "it is there already");
            assert!(!store.download("files/none.bin", &folder.path().join("none")).unwrap());
        }
        let names = store.list("plans").unwrap().into_iter().map(|object| object.name).collect::<Vec<_>>();
        assert_eq!(names, ["plans/p-1.json"]);
        store.remove("plans/p-1.json").unwrap();
        store.remove("plans/p-1.json").unwrap();
        assert_eq!((store.get("plans/p-1.json").unwrap(), store.modified("a").unwrap()), (None, None));
        for wrong in ["", "plans", "s3://", "gs:///a", "az://", "file://plans", "file:///", "ftp://a/b"] {
            assert!(matches!(KeptStore::open(wrong, &[]), Err(KeptStoreError::BadAddress { .. })), "{wrong}");
        }
    }

    /// What a store of a cloud lacks is said before anybody asks it.
    #[test]
    fn a_cloud_store_says_what_it_lacks() {
        let told = KeptStore::open("az://kept/prefix", &[]).unwrap_err().to_string();
        assert!(told.contains("az://kept/prefix") && told.to_ascii_lowercase().contains("account"), "{told}");
        let emulator = ("AZURE_STORAGE_USE_EMULATOR".to_owned(), "true".to_owned());
        assert!(KeptStore::open("az://kept/prefix", &[emulator]).is_ok());
        let key = ("GOOGLE_SERVICE_ACCOUNT_KEY".to_owned(), "{".to_owned());
        assert!(matches!(KeptStore::open("gs://kept", &[key]), Err(KeptStoreError::Refused { .. })));
    }

    /// It may be asked and dropped where nothing may wait.
    #[tokio::test]
    async fn a_store_works_beside_a_runtime() {
        let folder = tempfile::tempdir().unwrap();
        let store = KeptStore::open(&format!("file://{}", folder.path().display()), &[]).unwrap();
        assert!(store.get("kept.key").unwrap().is_none());
        drop(store);
    }
}
