//! Writes files that a user names, and refuses names that cannot take what a command writes before it begins.

use crate::error::CommandError;
use std::{
    fs,
    io::{self, ErrorKind},
    path::Path,
};
use wayword_formats::{OutputFile, OutputPlace};

/// Writes a complete file, or through a pipe or a device: see [`OutputFile`].
///
/// # Errors
/// When it cannot be written.
pub fn write_file(out: &Path, bytes: impl AsRef<[u8]>) -> Result<(), CommandError> {
    OutputFile::write_whole(out, bytes.as_ref()).map_err(CommandError::io(out, "write"))
}

/// The place that the name of an output file leads to. A command that takes long asks for it before it begins.
///
/// # Errors
/// When the name leads to a folder, a socket or a block device.
pub fn find_output_place(out: &Path) -> Result<OutputPlace, CommandError> {
    OutputPlace::for_name(out).map_err(CommandError::io(out, "write"))
}

/// Refuses a name that cannot be a folder, before a command begins that writes one.
///
/// # Errors
/// When it is `-`, or there is something of that name that is no folder.
pub fn expect_output_folder(folder: &Path) -> Result<(), CommandError> {
    if folder.as_os_str() == "-" {
        let problem = "--out -: this command writes several files, and standard output takes only one";
        return Err(CommandError::usage(problem, "give the name of a folder"));
    }
    let failed = CommandError::io(folder, "make the folder");
    match fs::metadata(folder) {
        Ok(about) if about.is_dir() => Ok(()),
        Ok(_) => Err(failed(ErrorKind::NotADirectory.into())),
        Err(error) if error.kind() == ErrorKind::NotFound => match fs::read_link(folder) {
            Ok(target) => {
                let problem = format!("it is a link to {}, which is not there", target.display());
                Err(failed(io::Error::new(ErrorKind::NotFound, problem)))
            }
            Err(_) => Ok(()),
        },
        Err(error) => Err(failed(error)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn expect_output_folder_refuses_everything_but_a_folder_or_a_free_name() {
        let around = tempfile::tempdir().unwrap();
        let at = |name: &str| around.path().join(name);
        fs::write(at("file"), "").unwrap();
        std::os::unix::fs::symlink("nothing", at("link")).unwrap();
        std::os::unix::fs::symlink(".", at("folder")).unwrap();
        for free in [at("new"), at("new/deep"), at("folder"), around.path().to_owned()] {
            expect_output_folder(&free).unwrap();
        }
        for taken in [at("file"), at("file/deep"), at("link"), "-".into(), "/dev/null".into()] {
            let refused = expect_output_folder(&taken).unwrap_err();
            assert!(refused.to_string().contains("hint: "), "{refused}");
        }
    }
}
