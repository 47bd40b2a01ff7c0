//! A bucket of an object store, and the operations on single objects: write, read, list, remove. All of them block.

use super::{CloudError, address, names, store_errors};
use futures_util::{StreamExt, TryStreamExt};
use object_store::{
    GetResult, ObjectMeta, ObjectStore, ObjectStoreExt, PutMode, PutOptions, PutPayload, memory::InMemory, path::Path,
};
use std::{fmt, sync::Arc, time::Duration};
use tokio::runtime::{Builder, Handle, Runtime};

/// The most objects that are listed; more are an error. A million names are about 200 MB.
pub const MAX_LISTED_OBJECTS: usize = 1_000_000;

/// How often a write is tried again after a conflict with another write of the same object.
const MAX_CONFLICT_RETRIES: u32 = 5;

/// The pause before such a retry, multiplied by the number of conflicts so far.
const CONFLICT_PAUSE: Duration = Duration::from_millis(50);

/// An object of a list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StoredObject {
    /// The name, below the bucket's prefix.
    pub name: String,
    /// How many bytes it has.
    pub bytes: u64,
    /// The ETag without quotes, if the store has one. It changes with the content.
    pub version: Option<String>,
}

/// A bucket, or the part of it below a prefix. It can be used by several threads at the same time.
pub struct CloudBucket {
    pub(super) store: Arc<dyn ObjectStore>,
    prefix: Path,
    /// The address, as messages show it.
    shown: String,
    /// Runs the store's asynchronous client.
    runtime: Runtime,
}

impl fmt::Debug for CloudBucket {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // The debug texts of the stores contain their settings, so they are left out.
        f.debug_struct("Bucket").field("address", &self.shown).finish_non_exhaustive()
    }
}

impl fmt::Display for CloudBucket {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.shown)
    }
}

fn start_runtime() -> Result<Runtime, CloudError> {
    Builder::new_current_thread()
        .enable_all()
        .build()
        .map_err(CloudError::for_local_file(".", "start the client of object stores"))
}

impl CloudBucket {
    /// Opens a bucket: `s3://BUCKET/PREFIX`, `gs://BUCKET/PREFIX`, `az://CONTAINER/PREFIX`, `file:///FOLDER`, and the
    /// `https://` addresses of Amazon, Cloudflare R2 and Azure. Sends no request to the store yet; a folder is made if it
    /// does not exist.
    ///
    /// # Errors
    /// When the address cannot be read or contains a user, a password, a port or a query; its text is not repeated. When a
    /// variable of the provider cannot be used.
    pub fn open(url: &str) -> Result<Self, CloudError> {
        // The client needs a provider of cryptography. Where the program has chosen one, that one stays.
        let _ = rustls::crypto::ring::default_provider().install_default();
        let opened = address::open_store(url)?;
        Ok(Self { store: opened.store, prefix: opened.prefix, shown: opened.shown, runtime: start_runtime()? })
    }

    /// A bucket in memory, for tests.
    ///
    /// # Errors
    /// When the system has no room for a client.
    pub fn in_memory() -> Result<Self, CloudError> {
        let store = Arc::new(InMemory::new());
        Ok(Self { store, prefix: Path::default(), shown: "memory:".to_owned(), runtime: start_runtime()? })
    }

    /// Waits until the store has done some work.
    pub(super) fn block_on_store<T>(&self, work: impl Future<Output = Result<T, CloudError>>) -> Result<T, CloudError> {
        if Handle::try_current().is_ok() {
            return Err(CloudError::InsideAsync);
        }
        self.runtime.block_on(work)
    }

    /// The address of an object, as it is shown.
    pub(super) fn shown_address(&self, name: &str) -> String {
        if name.is_empty() { self.shown.clone() } else { format!("{}/{}", self.shown, name.escape_debug()) }
    }

    /// The path of an object in the store, below the bucket's prefix. The name is checked.
    pub(super) fn object_path(&self, name: &str) -> Result<Path, CloudError> {
        names::check_name(name)?;
        names::path_below(&self.prefix, name)
    }

    /// The error of an operation on an object.
    pub(super) fn object_error(&self, name: &str, doing: &'static str, error: &object_store::Error) -> CloudError {
        match store_errors::from_store_error(&self.shown_address(name), doing, error) {
            CloudError::NoBucket { .. } => CloudError::NoBucket { bucket: self.shown.clone() },
            other => other,
        }
    }

    /// Makes an object if there is none of that name, and returns whether it did. Of several writers one wins, on the
    /// stores that [the module](super) lists.
    ///
    /// If an answer gets lost, the client tries again and then finds its own object. So `false` can also mean that an
    /// earlier try of the same caller made it. A caller that must know this reads the object.
    ///
    /// # Errors
    /// When the store cannot be used, or has no put-if-absent ([`CloudError::NoPutNew`]).
    pub fn put_new(&self, name: &str, bytes: impl Into<Vec<u8>>) -> Result<bool, CloudError> {
        let place = self.object_path(name)?;
        let payload = PutPayload::from(bytes.into());
        self.block_on_store(async {
            let mut conflicts = 0;
            loop {
                let options = PutOptions::from(PutMode::Create);
                match self.store.put_opts(&place, payload.clone(), options).await {
                    Ok(_) => return Ok(true),
                    Err(error) if store_errors::is_conflict(&error) && conflicts < MAX_CONFLICT_RETRIES => {
                        conflicts += 1;
                        tokio::time::sleep(CONFLICT_PAUSE * conflicts).await;
                    }
                    Err(error) if store_errors::is_conflict(&error) => {
                        let problem = "others write the same object all the time".to_owned();
                        return Err(CloudError::Network { at: self.shown_address(name), doing: "write it", problem });
                    }
                    Err(error @ object_store::Error::AlreadyExists { .. }) if !store_errors::is_no_bucket(&error) => {
                        return Ok(false);
                    }
                    Err(error) if store_errors::is_not_implemented(&error) => {
                        return Err(self.no_put_new("it says so"));
                    }
                    Err(error) => return Err(self.object_error(name, "write it", &error)),
                }
            }
        })
    }

    /// The error of a store without put-if-absent. `problem` is how this became known.
    fn no_put_new(&self, problem: &'static str) -> CloudError {
        CloudError::NoPutNew { bucket: self.shown.clone(), problem }
    }

    /// Tests whether [`CloudBucket::put_new`] makes one writer win: writes one object twice and removes it again. A store that
    /// ignores the condition accepts both writes.
    ///
    /// # Errors
    /// [`CloudError::NoPutNew`], or when the store cannot be used.
    pub fn check_put_new(&self) -> Result<(), CloudError> {
        // Two programs that check at the same time must not use the same name.
        let number = std::collections::hash_map::RandomState::new();
        let name = format!(".wayword-check-{:016x}", std::hash::BuildHasher::hash_one(&number, std::process::id()));
        self.put_new(&name, *b"1")?;
        let second = self.put_new(&name, *b"2");
        let removed = self.remove_object(&name);
        if second? { Err(self.no_put_new("it took a second object of the same name")) } else { removed }
    }

    /// Writes an object, whether there is one of that name or not.
    ///
    /// # Errors
    /// When the store cannot be used.
    pub fn put_object(&self, name: &str, bytes: impl Into<Vec<u8>>) -> Result<(), CloudError> {
        let place = self.object_path(name)?;
        let payload = PutPayload::from(bytes.into());
        self.block_on_store(async {
            let put = self.store.put(&place, payload).await;
            put.map(drop).map_err(|error| self.object_error(name, "write it", &error))
        })
    }

    /// Reads an object of at most `most_bytes`; `None` if it does not exist.
    ///
    /// # Errors
    /// When the store or the bucket is not there, or the object is larger.
    pub fn get_object(&self, name: &str, most_bytes: u64) -> Result<Option<Vec<u8>>, CloudError> {
        let place = self.object_path(name)?;
        self.block_on_store(async {
            match self.store.get(&place).await {
                Ok(object) => self.read_bytes(name, object, most_bytes).await.map(Some),
                Err(error @ object_store::Error::NotFound { .. }) => match self.object_error(name, "read it", &error) {
                    no_bucket @ CloudError::NoBucket { .. } => Err(no_bucket),
                    _ => Ok(None),
                },
                Err(error) => Err(self.object_error(name, "read it", &error)),
            }
        })
    }

    /// The content of an object of at most `most` bytes.
    async fn read_bytes(&self, name: &str, object: GetResult, most: u64) -> Result<Vec<u8>, CloudError> {
        let too_large = |bytes| CloudError::TooLarge { at: self.shown_address(name), bytes, most };
        if object.meta.size > most {
            return Err(too_large(object.meta.size));
        }
        let mut bytes = Vec::new();
        let mut pieces = object.into_stream();
        while let Some(piece) = pieces.next().await {
            let piece = piece.map_err(|error| self.object_error(name, "read it", &error))?;
            bytes.extend_from_slice(&piece);
            // A server can send more than it announced.
            if bytes.len() as u64 > most {
                return Err(too_large(bytes.len() as u64));
            }
        }
        Ok(bytes)
    }

    /// The objects below a prefix, in the order of their names. An empty prefix is all.
    ///
    /// # Errors
    /// When the store cannot be used, or there are more than [`MAX_LISTED_OBJECTS`]. A name that [`CloudBucket::get_object`] would refuse is
    /// an error too: no object is left out silently.
    pub fn list_objects(&self, prefix: &str) -> Result<Vec<StoredObject>, CloudError> {
        if !prefix.is_empty() {
            names::check_name(prefix)?;
        }
        let place = names::path_below(&self.prefix, prefix)?;
        self.block_on_store(async {
            let mut entries = Vec::new();
            let mut objects = self.store.list(Some(&place));
            while let Some(about) = objects.try_next().await.map_err(|error| self.listing_error(prefix, &error))? {
                let Some(entry) = self.object_from_meta(&about)? else { continue };
                if entries.len() == MAX_LISTED_OBJECTS {
                    return Err(CloudError::TooMany { at: self.shown_address(prefix), most: MAX_LISTED_OBJECTS });
                }
                entries.push(entry);
            }
            entries.sort_by(|a: &StoredObject, b| a.name.cmp(&b.name));
            Ok(entries)
        })
    }

    /// The error of listing the objects below a prefix.
    fn listing_error(&self, prefix: &str, error: &object_store::Error) -> CloudError {
        // The client refuses some hostile names before they get here.
        if matches!(error, object_store::Error::InvalidPath { .. }) {
            return names::name_error(prefix, "has an object below it whose name is not allowed");
        }
        self.object_error(prefix, "list what is there", error)
    }

    /// The entry of a list for an object; `None` if the object only represents a folder. Its name is checked.
    fn object_from_meta(&self, about: &ObjectMeta) -> Result<Option<StoredObject>, CloudError> {
        let whole = about.location.as_ref();
        let name = match self.prefix.as_ref() {
            "" => Some(whole),
            prefix => whole.strip_prefix(prefix).and_then(|rest| rest.strip_prefix('/')),
        };
        // The web pages of stores represent a folder by an empty object. It is skipped here.
        let Some(name) = name.filter(|name| !name.is_empty()) else { return Ok(None) };
        names::check_name(name)?;
        Ok(Some(StoredObject { name: name.to_owned(), bytes: about.size, version: object_version(about) }))
    }

    /// Removes an object, if it exists.
    ///
    /// # Errors
    /// When the store cannot be used.
    pub fn remove_object(&self, name: &str) -> Result<(), CloudError> {
        let place = self.object_path(name)?;
        self.block_on_store(async {
            match self.store.delete(&place).await {
                Ok(()) | Err(object_store::Error::NotFound { .. }) => Ok(()),
                Err(error) => Err(self.object_error(name, "remove it", &error)),
            }
        })
    }
}

/// The ETag without quotes: Azure gives it with quotes in some answers and without in others.
pub(super) fn object_version(about: &ObjectMeta) -> Option<String> {
    let tag = about.e_tag.as_deref()?;
    let tag = tag.strip_prefix("W/").unwrap_or(tag).trim_matches('"');
    (!tag.is_empty() && tag.len() <= 256).then(|| tag.escape_debug().to_string())
}
