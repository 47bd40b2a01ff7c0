//! Parses the address of a bucket, refuses one that contains a secret, and opens the store.

use super::{CloudError, names, store_errors};
use object_store::{
    ClientConfigKey, ObjectStore, ObjectStoreScheme, RetryConfig,
    aws::{AmazonS3Builder, AmazonS3ConfigKey},
    azure::{AzureConfigKey, MicrosoftAzureBuilder},
    gcp::{GoogleCloudStorageBuilder, GoogleConfigKey},
    local::LocalFileSystem,
    path::Path,
};
use std::{fs, sync::Arc, time::Duration};
use url::Url;

/// The beginnings of addresses that name an object store, and not a folder.
const ADDRESS_SCHEMES: [&str; 10] = ["s3", "s3a", "gs", "az", "adl", "azure", "abfs", "abfss", "https", "file"];

/// The schemes in which the part before the `@` is a container and not a user.
const CONTAINER_SCHEMES: [&str; 5] = ["az", "adl", "azure", "abfs", "abfss"];

const ADDRESS_HINT: &str = "write s3://BUCKET/PREFIX, gs://BUCKET/PREFIX, az://CONTAINER/PREFIX or file:///FOLDER";

/// How long one request may take. A part of a file is at most 64 MiB.
const REQUEST_TIMEOUT: &str = "300 seconds";

/// Whether a text is an address of an object store, and not a folder.
fn is_url(text: &str) -> bool {
    text.split_once("://")
        .is_some_and(|(scheme, _)| ADDRESS_SCHEMES.iter().any(|known| known.eq_ignore_ascii_case(scheme)))
}

/// A store, the prefix in it, and the address as messages may show it.
pub(super) struct OpenedStore {
    pub(super) store: Arc<dyn ObjectStore>,
    pub(super) prefix: Path,
    pub(super) shown: String,
}

fn address_error(problem: &'static str, hint: &'static str) -> CloudError {
    CloudError::Address { problem, hint }
}

/// Opens the store at an address, without sending a request. A folder is made.
pub(super) fn open_store(text: &str) -> Result<OpenedStore, CloudError> {
    let url = parse_address(text)?;
    let Ok((scheme, prefix)) = ObjectStoreScheme::parse(&url) else {
        return Err(address_error("is of no store that is known", ADDRESS_HINT));
    };
    if !prefix.as_ref().is_empty() {
        names::check_name(prefix.as_ref())?;
    }
    // Messages show the address as it was parsed and checked, not as it was typed.
    let shown = url.as_str().trim_end_matches('/').escape_debug().to_string();
    let store: Arc<dyn ObjectStore> = match scheme {
        ObjectStoreScheme::Local => return open_folder(&url, shown),
        ObjectStoreScheme::AmazonS3 => {
            Arc::new(open_s3(&url).map_err(|error| store_errors::from_settings_error(&shown, &error))?)
        }
        ObjectStoreScheme::GoogleCloudStorage => {
            Arc::new(open_google(&url).map_err(|error| store_errors::from_settings_error(&shown, &error))?)
        }
        ObjectStoreScheme::MicrosoftAzure => {
            Arc::new(open_azure(&url).map_err(|error| store_errors::from_settings_error(&shown, &error))?)
        }
        _ => return Err(address_error("is of a server whose kind is not known", ADDRESS_HINT)),
    };
    Ok(OpenedStore { store, prefix, shown })
}

/// Parses an address and refuses parts that could contain a secret.
fn parse_address(text: &str) -> Result<Url, CloudError> {
    if text.len() > 2048 || text.chars().any(char::is_control) {
        return Err(address_error("is too long or has control characters", ADDRESS_HINT));
    }
    if !is_url(text) {
        return Err(address_error("is of no store that is known", ADDRESS_HINT));
    }
    // `..` would be resolved before it can be seen.
    if text.split(['/', '\\']).any(|part| matches!(part, "." | "..")) {
        return Err(address_error("has a part `.` or `..`", ADDRESS_HINT));
    }
    let url = Url::parse(text).map_err(|_| address_error("cannot be read", ADDRESS_HINT))?;
    let is_user = !url.username().is_empty() && !CONTAINER_SCHEMES.contains(&url.scheme());
    if url.password().is_some() || is_user {
        let hint =
            "take it out, and set the variables of the provider, such as AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY";
        return Err(address_error("has a user or a password in it, which others could read", hint));
    }
    // A port may be the beginning of a password that was cut off. An endpoint belongs in a variable.
    if url.port().is_some() {
        let hint = "take it out; the address of a server stands in a variable, such as AWS_ENDPOINT_URL";
        return Err(address_error("has a port in it", hint));
    }
    if url.query().is_some() || url.fragment().is_some() {
        let hint =
            "take out what follows `?` or `#`; a signature belongs in a variable, such as AZURE_STORAGE_SAS_TOKEN";
        return Err(address_error("has a query in it, where signatures stand", hint));
    }
    Ok(url)
}

/// Opens a folder of this machine as a store, and makes it if it does not exist.
fn open_folder(url: &Url, shown: String) -> Result<OpenedStore, CloudError> {
    let path = url.to_file_path().map_err(|()| address_error("is no folder of this machine", ADDRESS_HINT))?;
    fs::create_dir_all(&path).map_err(CloudError::for_local_file(&path, "make this folder"))?;
    let store =
        LocalFileSystem::new_with_prefix(&path).map_err(|error| store_errors::from_settings_error(&shown, &error))?;
    Ok(OpenedStore { store: Arc::new(store.with_fsync(true)), prefix: Path::default(), shown })
}

/// At most twelve more tries, within two and a half minutes. If a store is down for longer, the worker ends and has to be
/// started again.
fn retry_config() -> RetryConfig {
    RetryConfig { max_retries: 12, retry_timeout: Duration::from_secs(150), ..RetryConfig::default() }
}

fn open_s3(url: &Url) -> Result<impl ObjectStore, object_store::Error> {
    AmazonS3Builder::from_env()
        .with_url(url.as_str())
        .with_config(AmazonS3ConfigKey::Client(ClientConfigKey::Timeout), REQUEST_TIMEOUT)
        .with_retry(retry_config())
        .build()
}

fn open_google(url: &Url) -> Result<impl ObjectStore, object_store::Error> {
    GoogleCloudStorageBuilder::from_env()
        .with_url(url.as_str())
        .with_config(GoogleConfigKey::Client(ClientConfigKey::Timeout), REQUEST_TIMEOUT)
        .with_retry(retry_config())
        .build()
}

fn open_azure(url: &Url) -> Result<impl ObjectStore, object_store::Error> {
    MicrosoftAzureBuilder::from_env()
        .with_url(url.as_str())
        .with_config(AzureConfigKey::Client(ClientConfigKey::Timeout), REQUEST_TIMEOUT)
        .with_retry(retry_config())
        .build()
}
