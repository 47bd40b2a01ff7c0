//! Suggests a scene of the platform for a name that it does not know.

use crate::{error::CommandError, similar::did_you_mean};
use wayword_core::{Platform, PlatformError, SceneId};

/// The error with the scene that was meant, if it is about a scene that the platform lacks and another has a similar name. Other
/// errors stay as they are.
#[must_use]
pub fn suggest_scene(error: CommandError, platform: &dyn Platform) -> CommandError {
    match error {
        CommandError::Platform(PlatformError::UnknownScene { scene, hint }) => {
            let candidates = platform.files().candidate_scenes().unwrap_or_default();
            let known = if candidates.is_empty() { platform.list_scenes().unwrap_or_default() } else { candidates };
            let meant = did_you_mean(&scene, known.iter().map(SceneId::as_str));
            PlatformError::UnknownScene { scene, hint: format!("{hint}{meant}") }.into()
        }
        error => error,
    }
}
