//! Writes files that a user names, and refuses names that cannot take what a command writes before it begins.

use crate::error::CommandError;
use std::{
    fs,
    io::{self, ErrorKind},
    path::{Path, PathBuf},
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

/// Refuses an output that would take the place of a file that the command reads. `flag` names the output, as in `--out`.
///
/// # Errors
/// When it would.
pub fn refuse_over_input(
    flag: &str,
    out: &Path,
    inputs: impl IntoIterator<Item = PathBuf>,
) -> Result<(), CommandError> {
    // A file that does not exist yet is no input.
    let Ok(out_is) = fs::canonicalize(out) else { return Ok(()) };
    match inputs.into_iter().find(|input| fs::canonicalize(input).is_ok_and(|input| input == out_is)) {
        Some(input) => {
            let problem = format!("{flag} would overwrite {}, which this command reads", input.display());
            Err(CommandError::usage(problem, format!("give {flag} another file name")))
        }
        None => Ok(()),
    }
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

    #[test]
    fn an_output_over_an_input_is_refused() {
        let around = tempfile::tempdir().unwrap();
        let at = |name: &str| around.path().join(name);
        fs::write(at("texts.json"), "").unwrap();
        fs::write(at("page.html"), "").unwrap();
        let refused = |out: &str| refuse_over_input("--out", &at(out), [at("texts.json"), at("gone")]).is_err();
        assert!(refused("texts.json") && refused("./texts.json"));
        assert!(!refused("page.html") && !refused("gone") && !refused("new.json"));
    }

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
