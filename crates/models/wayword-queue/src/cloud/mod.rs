//! Results and data in object stores: S3 and compatible services, Google Cloud Storage, Azure Blob Storage, and folders
//! (`file://`) for shared disks and tests.
//!
//! A [`CloudBucket`] is a bucket, or the part of it below a prefix. All calls block. Inside an asynchronous task a call returns
//! an error instead of hanging.
//!
//! # Credentials
//! They come from the environment, and never from the address: an address gets into logs and process lists.
//!
//! | store | variables |
//! |---|---|
//! | S3 | `AWS_ACCESS_KEY_ID`, `AWS_SECRET_ACCESS_KEY`, `AWS_SESSION_TOKEN`, `AWS_REGION`, `AWS_ENDPOINT_URL`; else the role of the machine, pod or task |
//! | Google | `GOOGLE_APPLICATION_CREDENTIALS`, `GOOGLE_SERVICE_ACCOUNT`; else the account of the machine |
//! | Azure | `AZURE_STORAGE_ACCOUNT_NAME` with `AZURE_STORAGE_ACCOUNT_KEY` or `AZURE_STORAGE_SAS_TOKEN`; else the identity of the machine |
//!
//! The file `~/.aws/credentials` is not read. An endpoint without TLS needs the provider's own setting
//! (`AWS_ALLOW_HTTP=true`). Certificates are checked against the system's, or those of the file that `SSL_CERT_FILE`
//! names.
//!
//! # Who wins
//! [`CloudBucket::put_new`] makes one of several writers win. It holds on Amazon S3 (since 2024), Google Cloud Storage,
//! Azure and folders on a file system with hard links. A store that is compatible with S3 may refuse the condition with
//! an error, or ignore it silently: [`CloudBucket::check_put_new`] finds out.
//!
//! # Tested stores
//! The tests run on memory, on folders, and by `trials/scale/objects.sh` on two simulators, moto (S3) and Azurite
//! (Azure). **No test ran on Google Cloud Storage**, nor on the real services of Amazon and Microsoft.

mod address;
mod bucket;
mod error;
mod fetch;
mod index;
mod lock;
mod names;
mod send;
mod store_errors;
mod stored_run;

pub use bucket::{CloudBucket, MAX_LISTED_OBJECTS, StoredObject};
pub use error::CloudError;
pub use fetch::FetchSummary;
pub use index::FETCH_INDEX_FILE;
pub use send::SendSummary;
pub use stored_run::{CloudRun, SendingBoard};
