//! Writes pictures in order: as files in a folder, as a GIF, as a video, or side by side. `--out` decides which.

mod folder;
mod gif;
#[cfg(feature = "video")]
mod mp4;
mod strip;

use super::file_kind::{FileKind, check_foreign};
use std::path::{Path, PathBuf};
use wayword_core::Image;
use wayword_run::error::CommandError;

/// Writes the pictures of a film, which all have the same size.
pub(crate) trait FilmWriter {
    /// Adds the next picture.
    ///
    /// # Errors
    /// When it cannot be encoded or written.
    fn add_picture(&mut self, picture: &Image) -> Result<(), CommandError>;

    /// Puts everything into its place; returns the files.
    ///
    /// # Errors
    /// When it cannot be written.
    fn finish(self: Box<Self>) -> Result<Vec<PathBuf>, CommandError>;
}

/// Begins a video in which each picture is one frame, with many key frames: readers of training data jump to any frame.
///
/// # Errors
/// When the file cannot be written.
#[cfg(feature = "video")]
pub(crate) fn open_training_video(out: &Path, fps: f64) -> Result<Box<dyn FilmWriter>, CommandError> {
    mp4::open_frames(out, fps)
}

/// The place and the form of a film.
#[derive(Debug)]
pub(super) enum FilmPlace {
    Folder(PathBuf),
    /// One picture, of this kind.
    Strip(PathBuf, FileKind),
    Gif(PathBuf),
    #[cfg(feature = "video")]
    Mp4(PathBuf),
}

impl FilmPlace {
    /// The place that `out` means: a folder if it is one or has no ending, else a file of the kind of its ending.
    ///
    /// # Errors
    /// When the ending is unknown, this build cannot write the kind, or the existing file must not be overwritten.
    pub(super) fn from_out(out: &Path, data: Option<&Path>) -> Result<Self, CommandError> {
        let is_folder = out.is_dir() || out.as_os_str().to_string_lossy().ends_with(['/', std::path::MAIN_SEPARATOR]);
        if out.as_os_str() != "-" && (is_folder || (out.extension().is_none() && !out.exists())) {
            check_foreign(out, data)?;
            return Ok(Self::Folder(out.to_owned()));
        }
        let kind = FileKind::from_ending(out).filter(|kind| *kind != FileKind::Svg).ok_or_else(|| {
            let problem = format!("--out {}: its ending does not say what to write", out.display());
            CommandError::usage(
                problem,
                "end it in .gif, .mp4, .jpg or .png, or in / for a folder of numbered PNG files",
            )
        })?;
        kind.check_free(out, data)?;
        match kind {
            FileKind::Gif => Ok(Self::Gif(out.to_owned())),
            FileKind::Png | FileKind::Jpeg => Ok(Self::Strip(out.to_owned(), kind)),
            #[cfg(feature = "video")]
            _ => Ok(Self::Mp4(out.to_owned())),
            #[cfg(not(feature = "video"))]
            _ => Err(CommandError::usage(
                "this build cannot write videos",
                "build it with `cargo build --release --features full`, or end --out in .gif or /",
            )),
        }
    }

    /// Whether it is one picture, with some frames side by side.
    pub(super) fn is_strip(&self) -> bool {
        matches!(self, Self::Strip(..))
    }

    /// Begins to write at most `most` pictures, `fps` for each second.
    ///
    /// # Errors
    /// When the place cannot be written.
    pub(super) fn open_writer(self, fps: f64, most: usize) -> Result<Box<dyn FilmWriter>, CommandError> {
        Ok(match self {
            Self::Folder(folder) => Box::new(folder::FolderFilm::new(folder, most)?),
            Self::Strip(file, kind) => Box::new(strip::PictureStrip::new(file, kind)),
            Self::Gif(file) => Box::new(gif::GifFilm::new(&file, fps)?),
            #[cfg(feature = "video")]
            Self::Mp4(file) => mp4::open_video(&file, fps)?,
        })
    }
}
