//! Kinds of files that `view` writes, by their endings, and which files they may overwrite.

use std::{
    fs::{self, File},
    io::Read,
    path::Path,
};
use wayword_formats::OutputPlace;
use wayword_run::{error::CommandError, written_files::find_output_place};

/// A kind of file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FileKind {
    Png,
    Jpeg,
    Svg,
    Gif,
    Mp4,
}

/// How an SVG of this program begins.
pub(super) const SVG_START: &str = "<svg ";

impl FileKind {
    const ALL: [Self; 5] = [Self::Png, Self::Jpeg, Self::Svg, Self::Gif, Self::Mp4];

    fn endings(self) -> &'static [&'static str] {
        match self {
            Self::Png => &["png"],
            Self::Jpeg => &["jpg", "jpeg"],
            Self::Svg => &["svg"],
            Self::Gif => &["gif"],
            Self::Mp4 => &["mp4"],
        }
    }

    /// The kind for a file's ending; `None` for other endings.
    pub(super) fn from_ending(file: &Path) -> Option<Self> {
        let ending = file.extension()?.to_str()?.to_ascii_lowercase();
        Self::ALL.into_iter().find(|kind| kind.endings().contains(&ending.as_str()))
    }

    /// The kind of `out`, which has to be one of `kinds`.
    ///
    /// # Errors
    /// When its ending belongs to none of `kinds`.
    pub(super) fn one_among(kinds: &[Self], out: &Path) -> Result<Self, CommandError> {
        let kind = Self::from_ending(out).filter(|kind| kinds.contains(kind));
        kind.ok_or_else(|| {
            let endings: Vec<String> =
                kinds.iter().flat_map(|kind| kind.endings()).map(|end| format!(".{end}")).collect();
            let problem = format!("--out {}: this command does not write files with this ending", out.display());
            CommandError::usage(problem, format!("end it in {}", endings.join(" or ")))
        })
    }

    /// Whether these first bytes of a file are those of this kind.
    fn fits_start(self, start: &[u8]) -> bool {
        match self {
            Self::Png => start.starts_with(b"\x89PNG\r\n\x1a\n"),
            Self::Jpeg => start.starts_with(&[0xff, 0xd8, 0xff]),
            Self::Svg => start.starts_with(SVG_START.as_bytes()),
            Self::Gif => start.starts_with(b"GIF8"),
            Self::Mp4 => start.get(4..8) == Some(b"ftyp"),
        }
    }

    /// Refuses to overwrite a file that this program cannot have written, and the platform's data.
    ///
    /// # Errors
    /// When `out` is a folder, is a file of another kind, or is within `data`.
    pub(super) fn check_free(self, out: &Path, data: Option<&Path>) -> Result<(), CommandError> {
        let OutputPlace::File(real) = find_output_place(out)? else {
            // A pipe or a device is written through.
            return Ok(());
        };
        if !real.exists() {
            return Ok(());
        }
        check_foreign(out, data)?;
        let mut start = Vec::new();
        let read = File::open(&real).and_then(|file| file.take(16).read_to_end(&mut start));
        read.map_err(CommandError::io(out, "read"))?;
        if start.is_empty() || self.fits_start(&start) {
            return Ok(());
        }
        Err(in_the_way(out, &format!("the file there is not a .{} file", self.endings()[0])))
    }
}

/// Refuses to overwrite the platform's data, files of any kind.
///
/// # Errors
/// When `out` exists and is within `data`.
pub(super) fn check_foreign(out: &Path, data: Option<&Path>) -> Result<(), CommandError> {
    let (Ok(out_is), Some(Ok(data_is))) = (fs::canonicalize(out), data.map(fs::canonicalize)) else { return Ok(()) };
    if out_is.starts_with(data_is) { Err(in_the_way(out, "it belongs to --data")) } else { Ok(()) }
}

fn in_the_way(out: &Path, problem: &str) -> CommandError {
    let problem = format!("--out {}: {problem}, and this command would overwrite it", out.display());
    CommandError::usage(problem, "give --out another name")
}
