//! The names of in-process models, such as `hf/openai/clip-vit-base-patch32`.

use crate::LocalError;
use std::{
    fmt,
    path::{Path, PathBuf},
};

/// The beginning of every name.
const NAME_PREFIX: &str = "hf/";

/// The revision for a name without one.
const DEFAULT_REVISION: &str = "main";

/// The longest organisation or name, revision, file, and path of a folder, bytes. Longer ones are refused.
const MAX_PART_BYTES: usize = 96;
const MAX_REVISION_BYTES: usize = 200;
const MAX_FILE_BYTES: usize = 200;
const MAX_PATH_BYTES: usize = 4096;

/// The name of a model. It gives the place of the model's files:
///
/// - `hf/ORG/NAME`, `hf/ORG/NAME@REVISION`: on the hub, at a branch, tag or commit (`main` if none is given);
/// - `hf/ORG/NAME@REVISION:FILE.gguf`, or `FILE.pth`: one file of a repository on the hub;
/// - `hf//abs/folder`, `hf/./folder`, `hf/../folder`: a folder on this machine;
/// - the same with a path that ends in `.gguf` or `.pth`: a file on this machine.
///
/// Organisation, name, revision and file become parts of paths and addresses. So characters and names that could lead
/// elsewhere, such as `..`, are refused.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ModelName {
    text: String,
    pub(super) source: ModelSource,
}

/// The place of a model's files.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum ModelSource {
    /// The hub, or its cache on this machine.
    Hub(HubModelName),
    /// A folder on this machine.
    Folder(PathBuf),
    /// A file on this machine.
    File(PathBuf),
}

/// A model on the hub.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct HubModelName {
    pub(super) org: String,
    pub(super) name: String,
    /// A branch, a tag or a commit.
    pub(super) revision: String,
    /// The file in the name, for a GGUF file or a checkpoint as training leaves it.
    pub(super) file: Option<String>,
}

impl ModelName {
    /// Reads a name.
    ///
    /// # Errors
    /// When the name is not valid.
    pub fn parse(text: &str) -> Result<Self, LocalError> {
        let source = parse_source(text).map_err(|problem| LocalError::Name {
            name: text.chars().take(MAX_REVISION_BYTES).collect(),
            problem: problem.to_owned(),
        })?;
        Ok(Self { text: text.to_owned(), source })
    }

    /// Whether the name is that of one GGUF file.
    #[must_use]
    pub fn is_gguf(&self) -> bool {
        self.file_path().is_some_and(|file| ends_in(file, "gguf"))
    }

    /// Whether the name is that of one checkpoint as training leaves it, `.pth`.
    #[must_use]
    pub fn is_trained(&self) -> bool {
        self.file_path().is_some_and(|file| ends_in(file, "pth"))
    }

    /// Whether the name is that of one file.
    #[must_use]
    pub fn is_file(&self) -> bool {
        self.file_path().is_some()
    }

    /// The file of a name that is that of one file.
    fn file_path(&self) -> Option<&Path> {
        match &self.source {
            ModelSource::Hub(model) => model.file.as_deref().map(Path::new),
            ModelSource::Folder(_) => None,
            ModelSource::File(path) => Some(path),
        }
    }
}

impl fmt::Display for ModelName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// Reads a name. The error is the problem with it.
fn parse_source(text: &str) -> Result<ModelSource, &'static str> {
    let rest = text.strip_prefix(NAME_PREFIX).ok_or("it does not begin with hf/")?;
    if ["/", "./", "../"].iter().any(|begin| rest.starts_with(begin)) {
        return parse_local(rest);
    }
    let (repo, file) = rest.split_once(':').map_or((rest, None), |(repo, file)| (repo, Some(file)));
    let (repo, revision) = repo.split_once('@').unwrap_or((repo, DEFAULT_REVISION));
    let (org, name) = repo.split_once('/').ok_or("it has no organisation before the model's name")?;
    if !is_name_part(org) || !is_name_part(name) {
        return Err(
            "organisation and name may have letters, digits, and single '-', '_' and '.' between them, at most 96 characters",
        );
    }
    if !is_revision(revision) {
        return Err("its revision is not a branch, tag or commit");
    }
    if file.is_some_and(|file| !is_file(file)) {
        return Err("after the colon there must be a file of the repository that ends in .gguf or .pth");
    }
    Ok(ModelSource::Hub(HubModelName {
        org: org.to_owned(),
        name: name.to_owned(),
        revision: revision.to_owned(),
        file: file.map(str::to_owned),
    }))
}

/// Reads the path of a folder or file on this machine.
fn parse_local(path: &str) -> Result<ModelSource, &'static str> {
    if path.chars().any(char::is_control) || path.len() > MAX_PATH_BYTES {
        return Err("its path contains control characters or is too long");
    }
    let source = if is_one_file(Path::new(path)) { ModelSource::File } else { ModelSource::Folder };
    Ok(source(PathBuf::from(path)))
}

/// Whether a text may be an organisation or a name, by the hub's rule. Two dashes in a row would make the names of the
/// cache's folders ambiguous.
pub(super) fn is_name_part(part: &str) -> bool {
    let inner = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.');
    let edge = |c: Option<char>| c.is_some_and(|c| c.is_ascii_alphanumeric() || c == '_');
    part.len() <= MAX_PART_BYTES
        && part.chars().all(inner)
        && edge(part.chars().next())
        && edge(part.chars().last())
        && !part.contains("--")
        && !part.contains("..")
}

fn is_revision(revision: &str) -> bool {
    let allowed = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.' | '+');
    revision.len() <= MAX_REVISION_BYTES && are_segments(revision, allowed)
}

fn is_file(file: &str) -> bool {
    let allowed = |c: char| c.is_ascii_graphic() && !r#"\:*?"<>|%#"#.contains(c);
    file.len() <= MAX_FILE_BYTES && is_one_file(Path::new(file)) && are_segments(file, allowed)
}

/// Whether a text consists of names with slashes between them, and no name is empty or begins with a dot.
fn are_segments(text: &str, allowed: impl Fn(char) -> bool) -> bool {
    text.split('/').all(|segment| !segment.is_empty() && !segment.starts_with('.') && segment.chars().all(&allowed))
}

/// Whether a path has the ending of a model that is one file.
fn is_one_file(path: &Path) -> bool {
    ["gguf", "pth"].iter().any(|end| ends_in(path, end))
}

fn ends_in(path: &Path, end: &str) -> bool {
    path.extension().is_some_and(|found| found.eq_ignore_ascii_case(end))
}
