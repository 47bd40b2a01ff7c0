//! Writes files that a user names, and refuses names that cannot take what a command writes before it begins.

use crate::{error::CommandError, run_folder};
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

/// Refuses an output that would take the place of something that the command reads: one of these files, or a file of a run in one of
/// these folders. The pages of a report are no file of its run. `flag` names the output, as in `--out`.
///
/// # Errors
/// When it would.
pub fn refuse_over_input<'a>(
    flag: &str,
    out: &Path,
    inputs: impl IntoIterator<Item = &'a Path>,
) -> Result<(), CommandError> {
    // A file that does not exist yet is no input.
    let Ok(out_is) = fs::canonicalize(out) else { return Ok(()) };
    let is_read = |input: &Path| {
        let own_file = |name: &str| fs::canonicalize(input.join(name)).is_ok_and(|own| own == out_is);
        fs::canonicalize(input).is_ok_and(|input| input == out_is)
            || (input.is_dir() && run_folder::file::KEPT.into_iter().any(own_file))
    };
    match inputs.into_iter().find(|input| is_read(input)) {
        Some(input) => {
            let problem =
                format!("{flag} {} would overwrite what this command reads of {}", out.display(), input.display());
            Err(CommandError::usage(problem, "give another name"))
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
        for name in ["walks.jsonl", "report.html", "texts.json"] {
            fs::write(at(name), "").unwrap();
        }
        let refused =
            |out: &str, inputs: &[&Path]| refuse_over_input("--out", &at(out), inputs.iter().copied()).is_err();
        let (run, texts) = (around.path(), at("texts.json"));
        assert!(
            refused("walks.jsonl", &[run]) && refused("texts.json", &[&texts]) && refused("./texts.json", &[&texts])
        );
        assert!(!refused("report.html", &[run]) && !refused("texts.json", &[run]) && !refused("new.json", &[&texts]));
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
