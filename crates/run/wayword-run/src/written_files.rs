//! Writes files that a user names, and refuses names that cannot take what a command writes before it begins.

use crate::{count::count_phrase, error::CommandError};
use std::{
    fs,
    io::{self, ErrorKind},
    path::{Path, PathBuf},
};
use wayword_formats::{OutputFile, OutputPlace};

/// Endings of files that users put into the folder of an output themselves: logs, settings, ledgers.
const BESIDE_OUTPUTS: [&str; 7] = [".log", ".out", ".err", ".toml", ".db", ".db-wal", ".db-shm"];

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
    refuse_tilde(out)?;
    OutputPlace::for_name(out).map_err(CommandError::io(out, "write"))
}

/// Refuses a name in the home folder that the shell did not replace, as in quotes: it would make a folder that is called `~`.
fn refuse_tilde(out: &Path) -> Result<(), CommandError> {
    if out.starts_with("~") && !Path::new("~").exists() {
        let problem = format!("--out {}: the shell has not replaced the ~ by your home folder", out.display());
        return Err(CommandError::usage(
            problem,
            "write it without quotes, or with $HOME; ./~ is a folder of that name",
        ));
    }
    Ok(())
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
    refuse_tilde(folder)?;
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

/// As [`expect_output_folder`], and refuses a folder in which other files stand than those that `is_own` accepts by their names:
/// the command's files would be mixed with the user's. Hidden files, logs, settings and ledgers may stand there.
///
/// # Errors
/// As [`expect_output_folder`], when there are other files, or the folder cannot be read.
pub fn expect_own_folder(folder: &Path, is_own: impl Fn(&str) -> bool) -> Result<(), CommandError> {
    expect_output_folder(folder)?;
    let mut foreign = Vec::new();
    let entries = match fs::read_dir(folder) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
        entries => entries.map_err(CommandError::io(folder, "look into"))?,
    };
    for entry in entries {
        let name = entry.map_err(CommandError::io(folder, "look into"))?.file_name().to_string_lossy().into_owned();
        let stands_beside = name.starts_with('.') || BESIDE_OUTPUTS.iter().any(|end| name.ends_with(end));
        if !stands_beside && !is_own(&name) {
            foreign.push(name);
        }
    }
    let Some(first) = foreign.iter().min() else { return Ok(()) };
    let problem = format!(
        "--out {}: the folder holds {} that this command did not write, such as {first}",
        folder.display(),
        count_phrase(foreign.len(), "file")
    );
    Err(CommandError::usage(problem, "give an empty folder, or the name of a new one"))
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

    #[test]
    fn folder_with_files_of_the_user_is_refused() {
        let around = tempfile::tempdir().unwrap();
        let folder = around.path().join("recording");
        let expect = || expect_own_folder(&folder, |name| name == "run.lock").map_err(|error| error.to_string());
        expect().unwrap();
        fs::create_dir(&folder).unwrap();
        for beside in ["run.lock", "worker-3.log", "styles.toml", ".hidden"] {
            fs::write(folder.join(beside), "").unwrap();
        }
        expect().unwrap();
        for picture in ["000001.jpg", "000000.jpg"] {
            fs::write(folder.join(picture), "").unwrap();
        }
        let refused = expect().unwrap_err();
        assert!(refused.contains("holds 2 files that this command did not write, such as 000000.jpg"), "{refused}");
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
