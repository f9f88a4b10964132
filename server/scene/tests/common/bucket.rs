//! An object store for tests.

use skyglow_scene::{DocumentStore, StoreAway, StoredObject};
use std::{
    collections::BTreeMap,
    path::Path,
    sync::{
        Mutex,
        atomic::{AtomicBool, Ordering},
    },
    time::SystemTime,
};

/// An object store in memory, which can be away.
#[derive(Debug, Default)]
pub(crate) struct Bucket {
    pub(crate) objects: Mutex<BTreeMap<String, (Vec<u8>, SystemTime)>>,
    pub(crate) is_away: AtomicBool,
}

impl Bucket {
    fn ask<T>(
        &self,
        answer: impl FnOnce(&mut BTreeMap<String, (Vec<u8>, SystemTime)>) -> T,
    ) -> Result<T, StoreAway> {
        match self.is_away.load(Ordering::Relaxed) {
            true => Err(StoreAway { reason: "planted".to_owned() }),
            false => Ok(answer(&mut self.objects.lock().unwrap())),
        }
    }

    pub(crate) fn names(&self) -> Vec<String> {
        self.objects.lock().unwrap().keys().cloned().collect()
    }
}

impl DocumentStore for Bucket {
    fn address(&self) -> String {
        "memory".to_owned()
    }

    fn get(&self, name: &str) -> Result<Option<(Vec<u8>, SystemTime)>, StoreAway> {
        self.ask(|objects| objects.get(name).cloned())
    }

    fn modified(&self, name: &str) -> Result<Option<SystemTime>, StoreAway> {
        self.ask(|objects| objects.get(name).map(|(_, time)| *time))
    }

    fn put(&self, name: &str, bytes: &[u8]) -> Result<(), StoreAway> {
        let object = (bytes.to_vec(), SystemTime::now());
        self.ask(|objects| drop(objects.insert(name.to_owned(), object)))
    }

    fn put_new(&self, name: &str, bytes: &[u8]) -> Result<bool, StoreAway> {
        let object = (bytes.to_vec(), SystemTime::now());
        self.ask(|objects| {
            let is_new = !objects.contains_key(name);
            objects.entry(name.to_owned()).or_insert(object);
            is_new
        })
    }

    fn remove(&self, name: &str) -> Result<(), StoreAway> {
        self.ask(|objects| drop(objects.remove(name)))
    }

    fn download(&self, name: &str, path: &Path) -> Result<bool, StoreAway> {
        let found = self.get(name)?;
        Ok(found.is_some_and(|(bytes, _)| std::fs::write(path, bytes).is_ok()))
    }

    fn upload(&self, name: &str, path: &Path) -> Result<(), StoreAway> {
        self.put(name, &std::fs::read(path).unwrap())
    }

    fn list(&self, folder: &str) -> Result<Vec<StoredObject>, StoreAway> {
        let inside = format!("{folder}/");
        self.ask(|objects| {
            let objects = objects.iter().filter(|(name, _)| name.starts_with(&inside));
            let object = |(name, (_, time)): (&String, &(_, SystemTime))| StoredObject {
                name: name.clone(),
                modified: *time,
            };
            objects.map(object).collect()
        })
    }
}
