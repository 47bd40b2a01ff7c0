//! Reads the file of `--calibration`, and refuses one of another platform.

use crate::{
    error::CommandError,
    own_format::{self, OwnFormatError},
    text_file,
};
use std::path::Path;
use wayword_checks::open::Calibration;

/// Reads a file of calibrations for a platform.
///
/// # Errors
/// When it cannot be read, is not a calibration, or was made for another platform.
pub(crate) fn read_calibration(file: &Path, platform: &str) -> Result<Calibration, CommandError> {
    let text = text_file::read_text_file(file, "read the calibration")?;
    let hint = "make it with: wayword calibrate --platform matterport --data DIR --from R2R_train.json --out FILE";
    let read = own_format::parse_document(&text)
        .and_then(|read: Calibration| read.check_numbers().map(|()| read).map_err(OwnFormatError::Broken));
    let calibration = read.map_err(|unread| {
        CommandError::usage(format!("{} is no calibration: {unread}", file.display()), unread.hint_or(hint))
    })?;
    if calibration.platform != platform {
        let made_for = &calibration.platform;
        let problem = format!("{} was made for platform {made_for}, and not for {platform}", file.display());
        return Err(CommandError::usage(problem, hint));
    }
    Ok(calibration)
}
