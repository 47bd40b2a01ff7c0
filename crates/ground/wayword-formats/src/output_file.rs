//! The one writer of files that a user names. A file gets its name once it is complete; a pipe or a device is written
//! through, and never replaced.

use crate::OutputPlace;
use std::{
    ffi::OsString,
    fs::{self, File},
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
    time::{Duration, Instant, SystemTime, UNIX_EPOCH},
};

/// How long the program waits for another to open a pipe for reading.
const READER_WAIT: Duration = Duration::from_secs(10);
/// Time between two looks whether a pipe has a reader.
const READER_POLL: Duration = Duration::from_millis(20);
/// Characters of a file's name that its temporary name repeats, so that the latter is never too long.
const REPEATED_NAME_CHARS: usize = 40;

/// An output that is being written. If it is dropped before [`OutputFile::finish`], a file under that name stays as it was.
#[derive(Debug)]
pub struct OutputFile {
    out: BufWriter<File>,
    /// The names of a file; `None` for what is written through.
    names: Option<OutputNames>,
}

/// The names of a file that is being written.
#[derive(Debug)]
struct OutputNames {
    /// The hidden name beside the final one, until the file is complete.
    temporary: PathBuf,
    /// The final name.
    file: PathBuf,
}

impl OutputFile {
    /// Begins an output. Missing folders above a file are made.
    ///
    /// # Errors
    /// When the name leads to a folder, a socket or a block device, nobody reads the pipe, or it cannot be written.
    pub fn begin(name: &Path) -> io::Result<Self> {
        let stream = |opened: File| Self { out: BufWriter::new(opened), names: None };
        match OutputPlace::for_name(name)? {
            OutputPlace::StandardOutput => open_standard_output().map(stream),
            OutputPlace::Stream(place) => open_stream(&place).map(stream),
            OutputPlace::File(file) => Self::beside(file),
        }
    }

    /// Writes a complete output.
    ///
    /// # Errors
    /// As [`OutputFile::begin`], and when it cannot be written.
    pub fn write_whole(name: &Path, bytes: &[u8]) -> io::Result<()> {
        let mut output = Self::begin(name)?;
        output.write_all(bytes)?;
        output.finish()
    }

    /// Writes all bytes to the disk, and gives the file its name.
    ///
    /// # Errors
    /// When it cannot be written. Then the temporary file is removed.
    pub fn finish(mut self) -> io::Result<()> {
        self.out.flush()?;
        let Some(OutputNames { temporary, file }) = &self.names else { return Ok(()) };
        self.out.get_ref().sync_all()?;
        fs::rename(temporary, file)?;
        self.names = None;
        Ok(())
    }

    /// Begins a file under a temporary name beside its own.
    fn beside(file: PathBuf) -> io::Result<Self> {
        // The rename does not ask whether the old file may be written, so the program does.
        let old = match File::options().append(true).open(&file) {
            Ok(old) => Some(old.metadata()?.permissions()),
            Err(error) if matches!(error.kind(), io::ErrorKind::NotFound | io::ErrorKind::NotADirectory) => None,
            Err(error) => return Err(error),
        };
        if let Some(folder) = file.parent().filter(|folder| !folder.as_os_str().is_empty()) {
            make_folder(folder)?;
        }
        let temporary = temporary_name(&file)?;
        let new = File::options().write(true).create_new(true).open(&temporary)?;
        let names = Some(OutputNames { temporary, file });
        let output = Self { out: BufWriter::new(new), names };
        if let Some(permissions) = old {
            output.out.get_ref().set_permissions(permissions)?;
        }
        Ok(output)
    }
}

impl Write for OutputFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.out.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

impl Drop for OutputFile {
    fn drop(&mut self) {
        // A temporary file that cannot be removed stays: the first failure is the one to report.
        if let Some(OutputNames { temporary, .. }) = &self.names {
            let _ = fs::remove_file(temporary);
        }
    }
}

/// Makes a folder and those above it.
fn make_folder(folder: &Path) -> io::Result<()> {
    fs::create_dir_all(folder).map_err(|error| match error.kind() {
        io::ErrorKind::AlreadyExists | io::ErrorKind::NotADirectory => {
            io::Error::new(io::ErrorKind::NotADirectory, format!("{} is no folder", folder.display()))
        }
        _ => error,
    })
}

/// A hidden name in the same folder that no other process makes: `.NAME.12ab-183f5c.part`.
fn temporary_name(file: &Path) -> io::Result<PathBuf> {
    let Some(name) = file.file_name() else {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "it is not the name of a file"));
    };
    let beginning: String = name.to_string_lossy().chars().take(REPEATED_NAME_CHARS).collect();
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_nanos();
    let hidden = format!(".{beginning}.{:x}-{since:x}.part", std::process::id());
    Ok(file.with_file_name(OsString::from(hidden)))
}

/// Standard output, in the way in which any other program opens it by name.
#[cfg(unix)]
fn open_standard_output() -> io::Result<File> {
    let open = |name: &str| File::options().append(true).open(name);
    open("/dev/stdout").or_else(|error| open("/proc/self/fd/1").map_err(|_| error))
}

#[cfg(not(unix))]
fn open_standard_output() -> io::Result<File> {
    Err(io::Error::new(io::ErrorKind::Unsupported, "standard output takes no data on this system"))
}

/// Opens a pipe or a device for writing. A pipe that nobody reads would keep the program waiting for ever, so it waits
/// [`READER_WAIT`] at most.
#[cfg(unix)]
fn open_stream(place: &Path) -> io::Result<File> {
    use std::os::unix::fs::{FileTypeExt, OpenOptionsExt};
    /// The flag with which opening a pipe fails instead of waiting for a reader.
    const DO_NOT_WAIT: i32 = if cfg!(any(target_os = "linux", target_os = "android")) { 0o4000 } else { 4 };
    /// The number of the error "no such device or address": the pipe has no reader.
    const NO_READER: i32 = 6;
    let is_pipe = fs::metadata(place).is_ok_and(|about| about.file_type().is_fifo());
    let deadline = Instant::now() + READER_WAIT;
    // Stays open until the pipe is opened once more: else its reader would see the end of it. The second time, because writes to
    // the first one would not wait for the reader either.
    let mut held_open = None;
    while is_pipe && held_open.is_none() {
        match File::options().write(true).custom_flags(DO_NOT_WAIT).open(place) {
            Ok(opened) => held_open = Some(opened),
            Err(error) if error.raw_os_error() != Some(NO_READER) => return Err(error),
            Err(_) if Instant::now() < deadline => std::thread::sleep(READER_POLL),
            Err(_) => {
                let problem =
                    format!("no program has opened this pipe for reading within {} seconds", READER_WAIT.as_secs());
                return Err(io::Error::other(problem));
            }
        }
    }
    // An open file of this process may be a file with contents, which stay.
    let stream = File::options().append(true).open(place);
    drop(held_open);
    stream
}

#[cfg(not(unix))]
fn open_stream(place: &Path) -> io::Result<File> {
    File::options().write(true).open(place)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names_in(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    #[test]
    fn a_file_has_its_name_only_when_it_is_complete() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a/b/out.json");
        let mut half = OutputFile::begin(&file).unwrap();
        half.write_all(b"half").unwrap();
        assert!(!file.exists());
        drop(half);
        assert!(names_in(file.parent().unwrap()).is_empty());
        OutputFile::write_whole(&file, b"old").unwrap();
        let mut half = OutputFile::begin(&file).unwrap();
        half.write_all(b"half").unwrap();
        drop(half);
        assert_eq!(fs::read(&file).unwrap(), b"old");
        OutputFile::write_whole(&file, b"new").unwrap();
        assert_eq!(fs::read(&file).unwrap(), b"new");
        assert_eq!(names_in(file.parent().unwrap()), ["out.json"]);
    }

    #[test]
    fn a_name_of_255_bytes_has_a_temporary_name_too() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["x".repeat(255), "\u{1f6cb}".repeat(63)] {
            OutputFile::write_whole(&folder.path().join(&name), b"text").unwrap();
        }
        assert_eq!(names_in(folder.path()).len(), 2);
    }

    #[test]
    fn a_file_where_a_folder_should_be_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        fs::write(&file, "text").unwrap();
        let refused = OutputFile::begin(&file.join("out/deep")).unwrap_err().to_string();
        assert!(refused.contains("file"), "{refused}");
    }

    #[cfg(unix)]
    #[test]
    fn links_and_permissions_stay() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let (real, link, new) = (folder.path().join("real"), folder.path().join("link"), folder.path().join("new"));
        fs::write(&real, "old").unwrap();
        fs::set_permissions(&real, PermissionsExt::from_mode(0o600)).unwrap();
        std::os::unix::fs::symlink("real", &link).unwrap();
        std::os::unix::fs::symlink("sub/later", &new).unwrap();
        OutputFile::write_whole(&link, b"text").unwrap();
        OutputFile::write_whole(&new, b"text").unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink() && fs::symlink_metadata(&new).unwrap().is_symlink());
        assert_eq!(fs::read(&real).unwrap(), b"text");
        assert_eq!(fs::metadata(&real).unwrap().permissions().mode() & 0o777, 0o600);
        assert_eq!(fs::read(folder.path().join("sub/later")).unwrap(), b"text");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_device_is_an_error_and_stays_a_device() {
        let error = OutputFile::write_whole(Path::new("/dev/full"), b"text").unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::StorageFull);
        assert!(!fs::metadata("/dev/full").unwrap().is_file());
    }

    #[cfg(unix)]
    #[test]
    fn a_pipe_waits_for_its_reader_and_stays_a_pipe() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        for delay_ms in [0, 200] {
            let reader = {
                let pipe = pipe.clone();
                std::thread::spawn(move || {
                    std::thread::sleep(Duration::from_millis(delay_ms));
                    fs::read(pipe).unwrap()
                })
            };
            // The reader waits for a writer, and must not see the end before the first byte.
            std::thread::sleep(Duration::from_millis(100 - delay_ms.min(100)));
            let text = vec![b'x'; 1 << 20];
            OutputFile::write_whole(&pipe, &text).unwrap();
            assert_eq!(reader.join().unwrap(), text);
        }
        assert_eq!(names_in(folder.path()), ["pipe"]);
    }
}
