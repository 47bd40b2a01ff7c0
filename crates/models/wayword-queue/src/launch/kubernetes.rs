//! A manifest for Kubernetes: an Indexed Job with one index for each worker.
//!
//! It needs Kubernetes 1.33 or later, in which limits by index and policies of failure are stable.
//!
//! The manifest names secrets and does not contain them: `--password-env` reads an environment variable that comes from a secret
//! ([`SecretEnv`]), and PGPASSFILE names a password file that comes from a secret ([`SecretFile`]). The files of a secret belong to
//! root, so a worker that is not root reads them as a member of their group. Kubernetes lets the group read them even if the mode
//! forbids it (0440 instead of 0400). Wayword accepts these files; libpq refuses them.

use super::{
    LaunchError, LaunchWorker,
    check::{check_amount, check_dotted, check_label, check_text, check_variable, check_word, value_error},
    quote::render_template,
};
use serde::Serialize;

const KUBERNETES_TEMPLATE: &str = include_str!("kubernetes.j2");

/// Most characters of a DNS label, which most names in Kubernetes are.
const MAX_LABEL_CHARS: usize = 63;
/// How often an index is started again after its worker failed for a temporary reason.
const MAX_INDEX_RESTARTS: u32 = 3;
/// How long a worker may take to hand its work back before Kubernetes kills it, seconds.
const GRACE_S: u32 = 120;
/// Where the password file is mounted.
const SECRETS_FOLDER: &str = "/run/wayword";
/// The number of the user that Wayword's image runs as.
const IMAGE_USER_ID: u32 = 65532;

/// Workers in Kubernetes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KubernetesJob {
    /// What each worker runs.
    pub worker: LaunchWorker,
    /// The job's name.
    pub name: String,
    /// Its namespace; without it, the one that `kubectl` is set to.
    pub namespace: Option<String>,
    /// The image that has the program.
    pub image: String,
    /// CPUs of a worker: `2`, `500m`.
    pub cpus: String,
    /// Memory of a worker: `16Gi`.
    pub memory: String,
    /// GPUs of a worker.
    pub gpus: u32,
    /// The number of the user and the group that workers run as. Not root.
    pub user: u32,
    /// The folder that all workers share.
    pub shared: Option<SharedFolder>,
    /// Environment variables that come from secrets.
    pub secrets: Vec<SecretEnv>,
    /// The password file of PostgreSQL; `PGPASSFILE` names it.
    pub pass_file: Option<SecretFile>,
}

/// A folder that all workers share: a claim that many machines may write to.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct SharedFolder {
    /// The `PersistentVolumeClaim`.
    pub claim: String,
    /// Where workers see it.
    pub mount: String,
}

/// An environment variable that comes from a secret.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct SecretEnv {
    /// The variable.
    pub name: String,
    /// The `Secret`.
    pub secret: String,
    /// The key in it.
    pub key: String,
}

/// A file that comes from a secret.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct SecretFile {
    /// The `Secret`.
    pub secret: String,
    /// The key in it.
    pub key: String,
}

impl KubernetesJob {
    /// Workers with one CPU, 2 GiB and no GPU each.
    #[must_use]
    pub fn new(worker: LaunchWorker, image: &str) -> Self {
        Self {
            worker,
            name: "wayword".to_owned(),
            namespace: None,
            image: image.to_owned(),
            cpus: "1".to_owned(),
            memory: "2Gi".to_owned(),
            gpus: 0,
            user: IMAGE_USER_ID,
            shared: None,
            secrets: Vec::new(),
            pass_file: None,
        }
    }

    /// Checks every value of the job.
    fn check_job(&self) -> Result<(), LaunchError> {
        self.worker.check_worker()?;
        check_label("--name", &self.name, self.longest_name())?;
        self.namespace.as_deref().map_or(Ok(()), |name| check_label("--namespace", name, MAX_LABEL_CHARS))?;
        check_word("--image", &self.image, "./:@_-")?;
        check_amount("--cpus", &self.cpus, &["m"], "write a number, as in 2, 0.5 or 500m")?;
        let units = ["Ki", "Mi", "Gi", "Ti", "k", "M", "G", "T"];
        check_amount("--memory", &self.memory, &units, "write a number and a unit, as in 16Gi")?;
        if self.user == 0 {
            return Err(value_error("--user", "0", "is root", "give the number of another user; no worker needs root"));
        }
        self.shared.as_ref().map_or(Ok(()), SharedFolder::check_folder)?;
        self.check_secrets()
    }

    /// Most characters of the job's name. A pod's host is named after the job and the index, and that name is a label too.
    fn longest_name(&self) -> usize {
        let index = self.worker.workers.saturating_sub(1).to_string();
        MAX_LABEL_CHARS.saturating_sub(1 + index.len())
    }

    /// Checks the secrets, and that no environment variable is set twice.
    fn check_secrets(&self) -> Result<(), LaunchError> {
        let mut names = Vec::new();
        for secret in &self.secrets {
            check_variable("--secret", &secret.name)?;
            check_secret(&secret.secret, &secret.key)?;
            let is_taken =
                secret.name == "JOB_COMPLETION_INDEX" || (self.pass_file.is_some() && secret.name == "PGPASSFILE");
            if is_taken || names.contains(&&secret.name) {
                return Err(value_error("--secret", &secret.name, "would be set twice", "leave one of the two out"));
            }
            names.push(&secret.name);
        }
        self.pass_file.as_ref().map_or(Ok(()), |file| check_secret(&file.secret, &file.key))
    }
}

impl SharedFolder {
    fn check_folder(&self) -> Result<(), LaunchError> {
        check_dotted("--claim", &self.claim)?;
        check_text("--mount", &self.mount)?;
        let is_inner = self.mount.split('/').skip(1).all(|part| !matches!(part, "" | "." | ".."));
        let is_taken = self.mount == SECRETS_FOLDER || self.mount.starts_with(&format!("{SECRETS_FOLDER}/"));
        match self.mount.starts_with('/') && is_inner && !is_taken && !self.mount.contains(':') {
            true => Ok(()),
            false => Err(value_error(
                "--mount",
                &self.mount,
                "is no folder to mount at",
                "give a whole path without a colon, as in /data; /run/wayword is taken",
            )),
        }
    }
}

/// Checks the name of a secret and a key in it.
fn check_secret(secret: &str, key: &str) -> Result<(), LaunchError> {
    check_dotted("--secret", secret)?;
    match key.len() <= 253 && !matches!(key, "." | "..") {
        true => check_word("--secret", key, "._-"),
        false => {
            Err(value_error("--secret", key, "is no key of a secret", "see the keys with `kubectl describe secret`"))
        }
    }
}

/// The values of the template.
#[derive(Debug, Serialize)]
struct KubernetesTemplateValues<'a> {
    name: &'a str,
    namespace: Option<&'a str>,
    image: &'a str,
    cpus: &'a str,
    memory: &'a str,
    gpus: u32,
    user: u32,
    shared: Option<&'a SharedFolder>,
    secrets: &'a [SecretEnv],
    pass_file: Option<&'a SecretFile>,
    pass_folder: &'static str,
    program: &'a str,
    arguments: &'a [String],
    workers: u32,
    /// Whether the manifest adds each worker's part to its arguments.
    needs_part: bool,
    /// How many workers may fail for good before the whole job fails.
    lost_indexes: u32,
    /// How often a worker is started again.
    tries: u32,
    grace_s: u32,
}

/// The manifest: YAML for `kubectl apply`.
///
/// # Errors
/// When a value cannot or must not be in a manifest: see [`LaunchError`].
pub fn write_manifest(job: &KubernetesJob) -> Result<String, LaunchError> {
    job.check_job()?;
    let workers = job.worker.workers;
    render_template(
        KUBERNETES_TEMPLATE,
        KubernetesTemplateValues {
            name: &job.name,
            namespace: job.namespace.as_deref(),
            image: &job.image,
            cpus: &job.cpus,
            memory: &job.memory,
            gpus: job.gpus,
            user: job.user,
            shared: job.shared.as_ref(),
            secrets: &job.secrets,
            pass_file: job.pass_file.as_ref(),
            pass_folder: SECRETS_FOLDER,
            program: &job.worker.program,
            arguments: &job.worker.arguments,
            workers,
            needs_part: job.worker.needs_part(),
            // From 10^5 indexes on, a server takes 10^4 at most.
            lost_indexes: (workers / 4).clamp(1, 10_000),
            tries: MAX_INDEX_RESTARTS,
            grace_s: GRACE_S,
        },
    )
}
