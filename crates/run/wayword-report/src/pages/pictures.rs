//! Loads the pictures of frames for a page, only from the run's own folder. A page shows them from the folder beside it, or
//! contains them.

use super::{data_uri, picture_folder::ReportPictures};
use serde::Serialize;
use std::path::{Path, PathBuf};
use wayword_run::{
    error::CommandError,
    pictures::{MAX_PICTURE_BYTES, StoredPicture, read_picture},
    run_folder::file,
};

/// Most bytes of all pictures in a page together, 64 MiB, so that a browser can open it. Pictures beyond are left out.
const MAX_PAGE_PICTURE_BYTES: u64 = 64 << 20;

/// A picture of a page.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub(super) struct PagePicture {
    /// The address of its file, or a `data:` address.
    pub(super) address: String,
    pub(super) width_px: u32,
    pub(super) height_px: u32,
}

/// The pictures of a run.
pub(super) struct PagePictures<'a> {
    frames: PathBuf,
    /// Where they lie; `None` if the page contains them.
    beside: Option<&'a ReportPictures>,
    /// How many bytes of pictures may still be added to a page that contains them.
    left_bytes: u64,
    /// How many the page shows.
    pub(super) shown: usize,
    /// How many are not shown: they are missing, too large, not a JPEG, or the page was full.
    pub(super) left_out: usize,
    /// The first error of the folder beside the page.
    trouble: Option<CommandError>,
}

impl<'a> PagePictures<'a> {
    pub(super) fn from_run(run: &Path, beside: Option<&'a ReportPictures>) -> Self {
        let frames = run.join(file::FRAMES);
        Self { frames, beside, left_bytes: MAX_PAGE_PICTURE_BYTES, shown: 0, left_out: 0, trouble: None }
    }

    /// The picture of a frame (from 0) of an item.
    pub(super) fn take_picture(&mut self, item: &str, frame: usize) -> Option<PagePicture> {
        let picture = self.load_picture(item, frame);
        *if picture.is_some() { &mut self.shown } else { &mut self.left_out } += 1;
        picture
    }

    /// The same picture for a list, if it lies beside the page, so that it costs nothing.
    pub(super) fn take_small(&mut self, item: &str, frame: usize) -> Option<PagePicture> {
        self.beside.and_then(|_| self.load_picture(item, frame))
    }

    /// The first error of the folder beside the page, if there was one.
    ///
    /// # Errors
    /// When a picture could not be written.
    pub(super) fn expect_written(&mut self) -> Result<(), CommandError> {
        self.trouble.take().map_or(Ok(()), Err)
    }

    fn load_picture(&mut self, item: &str, frame: usize) -> Option<PagePicture> {
        let most_bytes = if self.beside.is_some() { MAX_PICTURE_BYTES } else { self.left_bytes };
        let StoredPicture { jpeg, width_px, height_px } = read_picture(&self.frames, item, frame, most_bytes)?;
        let address = match self.beside.map(|folder| folder.keep_picture(&jpeg)) {
            Some(Ok(address)) => address,
            Some(Err(error)) => {
                self.trouble.get_or_insert(error);
                return None;
            }
            None => {
                self.left_bytes = self.left_bytes.saturating_sub(jpeg.len() as u64);
                data_uri::jpeg_uri(&jpeg)
            }
        };
        Some(PagePicture { address, width_px, height_px })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::ImageFormat;
    use std::{fs, io::Cursor};
    use wayword_run::pictures::MAX_PICTURE_SIDE_PX;

    fn jpeg(width_px: u32, height_px: u32) -> Vec<u8> {
        let mut bytes = Vec::new();
        let picture = image::RgbImage::from_pixel(width_px, height_px, image::Rgb([90, 120, 200]));
        picture.write_to(&mut Cursor::new(&mut bytes), ImageFormat::Jpeg).unwrap();
        bytes
    }

    fn run() -> tempfile::TempDir {
        let run = tempfile::tempdir().unwrap();
        fs::create_dir(run.path().join(file::FRAMES)).unwrap();
        run
    }

    #[test]
    fn a_picture_is_given_with_its_size() {
        let run = run();
        fs::write(run.path().join("frames/a_0.jpg"), jpeg(6, 4)).unwrap();
        let mut pictures = PagePictures::from_run(run.path(), None);
        let picture = pictures.take_picture("a", 0).unwrap();
        assert_eq!((picture.width_px, picture.height_px), (6, 4));
        assert!(picture.address.starts_with("data:image/jpeg;base64,/9j/"));
        assert_eq!(pictures.take_picture("a", 1), None);
        assert_eq!((pictures.shown, pictures.left_out), (1, 1));
    }

    #[test]
    fn names_that_lead_out_of_the_folder_are_refused() {
        let run = run();
        fs::write(run.path().join("secret_0.jpg"), jpeg(6, 4)).unwrap();
        fs::create_dir(run.path().join("frames/deep")).unwrap();
        fs::write(run.path().join("frames/deep/a_0.jpg"), jpeg(6, 4)).unwrap();
        let absolute = run.path().join("secret").display().to_string();
        for bad in ["../secret", "deep/a", "./../secret", absolute.as_str(), "a\0"] {
            assert_eq!(PagePictures::from_run(run.path(), None).take_picture(bad, 0), None, "{bad:?}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn links_are_not_followed() {
        let run = run();
        fs::write(run.path().join("secret.jpg"), jpeg(6, 4)).unwrap();
        std::os::unix::fs::symlink("../secret.jpg", run.path().join("frames/a_0.jpg")).unwrap();
        assert_eq!(PagePictures::from_run(run.path(), None).take_picture("a", 0), None);
    }

    #[test]
    fn take_leaves_out_large_files_and_other_formats() {
        let run = run();
        fs::write(run.path().join("frames/a_0.jpg"), "<svg onload='alert(1)'/>").unwrap();
        fs::write(run.path().join("frames/a_1.jpg"), vec![0xff; MAX_PICTURE_BYTES as usize + 1]).unwrap();
        fs::write(run.path().join("frames/a_2.jpg"), jpeg(MAX_PICTURE_SIDE_PX + 1, 1)).unwrap();
        let mut pictures = PagePictures::from_run(run.path(), None);
        assert!((0..3).all(|frame| pictures.take_picture("a", frame).is_none()));
    }

    #[test]
    fn a_full_page_takes_no_more() {
        let run = run();
        fs::write(run.path().join("frames/a_0.jpg"), jpeg(6, 4)).unwrap();
        let mut pictures = PagePictures { left_bytes: 10, ..PagePictures::from_run(run.path(), None) };
        assert_eq!(pictures.take_picture("a", 0), None);
    }
}
