//! Finds out where the bytes for a name go: into a file, through a pipe or a device, or to standard output.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

/// Most links that are followed from one name, as on Linux.
const MAX_LINKS: usize = 40;
/// The folders that list the open files of this process, by their numbers.
const DESCRIPTOR_FOLDERS: [&str; 3] = ["/dev/fd", "/proc/self/fd", "/proc/thread-self/fd"];

/// Where the bytes for a name go. Nothing but a file is ever replaced.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum OutputPlace {
    /// To standard output: `-`, `/dev/stdout` or `/dev/fd/1`.
    StandardOutput,
    /// Through a pipe, a character device, or another open file of this process such as `/dev/fd/3`.
    Stream(PathBuf),
    /// Into a file that exists or will be made, under its own name: links are followed.
    File(PathBuf),
}

impl OutputPlace {
    /// The place that a user's name for an output leads to.
    ///
    /// # Errors
    /// When it leads to a folder, a socket or a block device, or cannot be looked at.
    pub fn for_name(name: &Path) -> io::Result<Self> {
        let refused = |kind: io::ErrorKind, problem: &str| Err(io::Error::new(kind, problem.to_owned()));
        if name.as_os_str() == "-" {
            return Ok(Self::StandardOutput);
        }
        if name.as_os_str().is_empty() {
            return refused(io::ErrorKind::InvalidInput, "the name is empty");
        }
        if name.as_os_str().as_encoded_bytes().ends_with(b"/") {
            return refused(io::ErrorKind::IsADirectory, "the name is that of a folder");
        }
        let mut place = name.to_owned();
        for _ in 0..MAX_LINKS {
            match descriptor_number(&place) {
                Some(1) => return Ok(Self::StandardOutput),
                Some(_) => return Ok(Self::Stream(place)),
                None => {}
            }
            let about = match fs::symlink_metadata(&place) {
                Ok(about) => about,
                // A file in the place of a folder is found when the folders are made.
                Err(error) if matches!(error.kind(), io::ErrorKind::NotFound | io::ErrorKind::NotADirectory) => {
                    return Ok(Self::File(place));
                }
                Err(error) => return Err(error),
            };
            if about.is_symlink() {
                let target = fs::read_link(&place)?;
                place = place.parent().map_or(target.clone(), |folder| folder.join(&target));
                continue;
            }
            if about.is_file() {
                return Ok(Self::File(place));
            }
            if about.is_dir() {
                return refused(io::ErrorKind::IsADirectory, "it is a folder");
            }
            if is_pipe_or_character_device(&about) {
                return Ok(Self::Stream(place));
            }
            return refused(io::ErrorKind::InvalidInput, "it is a socket or a block device");
        }
        // The system has the words for too many links.
        fs::metadata(name).map(|_| Self::File(place))
    }

    /// Whether there is a file that would be replaced.
    #[must_use]
    pub fn has_old_file(&self) -> bool {
        matches!(self, Self::File(file) if file.exists())
    }
}

/// The number of an open file of this process, if the path names one.
fn descriptor_number(path: &Path) -> Option<u32> {
    match path.to_str()? {
        "/dev/stdin" => return Some(0),
        "/dev/stdout" => return Some(1),
        "/dev/stderr" => return Some(2),
        _ => {}
    }
    let folder = path.parent()?;
    let own = PathBuf::from(format!("/proc/{}/fd", std::process::id()));
    let is_ours = DESCRIPTOR_FOLDERS.iter().any(|known| folder == Path::new(known)) || folder == own;
    if is_ours { path.file_name()?.to_str()?.parse().ok() } else { None }
}

#[cfg(unix)]
fn is_pipe_or_character_device(about: &fs::Metadata) -> bool {
    use std::os::unix::fs::FileTypeExt;
    let kind = about.file_type();
    kind.is_fifo() || kind.is_char_device()
}

#[cfg(not(unix))]
fn is_pipe_or_character_device(_: &fs::Metadata) -> bool {
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn for_name_follows_links_and_knows_standard_output_under_all_its_names() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        for name in ["-", "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"] {
            assert_eq!(OutputPlace::for_name(Path::new(name)).unwrap(), OutputPlace::StandardOutput, "{name}");
        }
        for name in ["/dev/null", "/dev/stderr", "/dev/fd/3"] {
            assert!(matches!(OutputPlace::for_name(Path::new(name)).unwrap(), OutputPlace::Stream(_)), "{name}");
        }
        for (link, target) in [("a", "b"), ("b", "new"), ("out", "/dev/stdout"), ("round", "round")] {
            std::os::unix::fs::symlink(target, at(link)).unwrap();
        }
        assert_eq!(OutputPlace::for_name(&at("a")).unwrap(), OutputPlace::File(at("new")));
        assert_eq!(OutputPlace::for_name(&at("out")).unwrap(), OutputPlace::StandardOutput);
        assert!(OutputPlace::for_name(&at("round")).is_err());
        assert_eq!(OutputPlace::for_name(&at("./-")).unwrap(), OutputPlace::File(at("./-")));
    }

    #[cfg(unix)]
    #[test]
    fn for_name_refuses_folders_sockets_and_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let socket = folder.path().join("socket");
        let _listener = std::os::unix::net::UnixListener::bind(&socket).unwrap();
        let refused = |name: &Path| OutputPlace::for_name(name).unwrap_err().to_string();
        assert_eq!(refused(folder.path()), "it is a folder");
        assert_eq!(refused(&folder.path().join("new/")), "the name is that of a folder");
        assert_eq!(refused(&folder.path().join("..")), "it is a folder");
        assert_eq!(refused(&socket), "it is a socket or a block device");
        assert_eq!(refused(Path::new("")), "the name is empty");
    }
}
