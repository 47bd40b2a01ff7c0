//! The folder of pictures beside a page, `report-files` beside `report.html`. A picture has the hash of its bytes as its name, so
//! it is written once, however often it is shown and however often the report is written again.

use super::report_files::file_address;
use sha2::{Digest, Sha256};
use std::{
    cell::RefCell,
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
};
use wayword_core::hex_text;
use wayword_run::error::CommandError;

/// Digits of the hash in a name: 128 bits.
const NAME_DIGITS: usize = 32;
/// The end of each name.
const NAME_END: &str = ".jpg";

/// A folder of pictures beside a page.
pub(super) struct ReportPictures {
    folder: PathBuf,
    /// The names of the pictures that the pages show.
    shown: RefCell<BTreeSet<String>>,
}

impl ReportPictures {
    /// The folder of a page. Nothing is made before the first picture.
    ///
    /// # Errors
    /// When something that is no folder has its name.
    pub(super) fn beside_page(page: &Path) -> Result<Self, CommandError> {
        let mut name = page.file_stem().unwrap_or_default().to_owned();
        name.push("-files");
        let folder = page.with_file_name(name);
        match fs::symlink_metadata(&folder) {
            Ok(found) if !found.is_dir() => Err(CommandError::usage(
                format!("{}: it is not a folder, but the pictures of the report belong there", folder.display()),
                "give another name with --out, or remove it",
            )),
            _ => Ok(Self { folder, shown: RefCell::default() }),
        }
    }

    /// Writes a picture, unless the folder has it, and gives its address from the page.
    ///
    /// # Errors
    /// When it cannot be written.
    pub(super) fn keep_picture(&self, jpeg: &[u8]) -> Result<String, CommandError> {
        let name = format!("{}{NAME_END}", &hex_text(Sha256::digest(jpeg))[..NAME_DIGITS]);
        let file = self.folder.join(&name);
        let address = format!("{}/{name}", file_address(&self.folder));
        let is_whole =
            fs::symlink_metadata(&file).is_ok_and(|found| found.is_file() && found.len() == jpeg.len() as u64);
        if !is_whole {
            fs::create_dir_all(&self.folder).map_err(CommandError::io(&self.folder, "make"))?;
            // A program that is killed leaves no half picture under this name.
            let unfinished = self.folder.join(format!("{name}.new"));
            fs::write(&unfinished, jpeg).map_err(CommandError::io(&unfinished, "write"))?;
            fs::rename(&unfinished, &file).map_err(CommandError::io(&file, "write"))?;
        }
        self.shown.borrow_mut().insert(name);
        Ok(address)
    }

    /// Removes the pictures that an older report left and this one does not show, and the folder if it is empty then. Files
    /// with other names stay.
    ///
    /// # Errors
    /// When a picture cannot be removed.
    pub(super) fn remove_unused(&self) -> Result<(), CommandError> {
        let Ok(entries) = fs::read_dir(&self.folder) else { return Ok(()) };
        let shown = self.shown.borrow();
        for entry in entries.flatten() {
            let name = entry.file_name();
            let Some(name) = name.to_str() else { continue };
            let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
            if is_file && is_own_name(name) && !shown.contains(name) {
                fs::remove_file(entry.path()).map_err(CommandError::io(entry.path(), "remove the older picture"))?;
            }
        }
        if shown.is_empty() {
            // Fails without harm where somebody keeps other files there.
            let _ = fs::remove_dir(&self.folder);
        }
        Ok(())
    }
}

/// Whether a file has a name that this program gives to pictures, whole or half written.
fn is_own_name(name: &str) -> bool {
    let hash = name.strip_suffix(".new").unwrap_or(name).strip_suffix(NAME_END);
    hash.is_some_and(|hash| {
        hash.len() == NAME_DIGITS && hash.bytes().all(|digit| digit.is_ascii_hexdigit() && !digit.is_ascii_uppercase())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> BTreeSet<String> {
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn a_picture_is_written_once_and_older_ones_are_removed() {
        let place = tempfile::tempdir().unwrap();
        let page = place.path().join("my report.html");
        let folder = place.path().join("my report-files");
        let first = ReportPictures::beside_page(&page).unwrap();
        let address = first.keep_picture(b"one").unwrap();
        assert!(address.starts_with("my%20report-files/") && address.ends_with(".jpg"), "{address}");
        assert_eq!(first.keep_picture(b"one").unwrap(), address);
        first.keep_picture(b"two").unwrap();
        assert_eq!(names(&folder).len(), 2);
        fs::write(folder.join("notes.txt"), "mine").unwrap();
        fs::write(folder.join("holiday.jpg"), "mine").unwrap();
        let second = ReportPictures::beside_page(&page).unwrap();
        second.keep_picture(b"one").unwrap();
        second.remove_unused().unwrap();
        let left = names(&folder);
        assert!(left.len() == 3 && left.contains("notes.txt") && left.contains("holiday.jpg"), "{left:?}");
    }

    #[test]
    fn a_half_written_picture_is_written_again() {
        let place = tempfile::tempdir().unwrap();
        let pictures = ReportPictures::beside_page(&place.path().join("r.html")).unwrap();
        let file = place.path().join(pictures.keep_picture(b"whole").unwrap());
        fs::write(&file, b"wh").unwrap();
        pictures.keep_picture(b"whole").unwrap();
        assert_eq!(fs::read(&file).unwrap(), b"whole");
    }

    #[test]
    fn an_empty_folder_goes_and_a_file_in_its_place_is_an_error() {
        let place = tempfile::tempdir().unwrap();
        let page = place.path().join("r.html");
        ReportPictures::beside_page(&page).unwrap().keep_picture(b"one").unwrap();
        ReportPictures::beside_page(&page).unwrap().remove_unused().unwrap();
        assert!(!place.path().join("r-files").exists());
        fs::write(place.path().join("r-files"), "mine").unwrap();
        let refused = ReportPictures::beside_page(&page).err().unwrap().to_string();
        assert!(refused.contains("r-files") && refused.contains("--out"), "{refused}");
    }
}
