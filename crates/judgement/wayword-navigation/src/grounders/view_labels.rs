//! Gets the labels and the room of a view for grounders, with the error for platforms that have none.

use wayword_core::{ModelError, ObjectLabel, View};

/// The labels of a view and its room, for the grounder named `by`.
pub(crate) fn labels_of<'a>(view: &'a View, by: &str) -> Result<(&'a [ObjectLabel], Option<&'a str>), ModelError> {
    let truth = view.ground_truth().ok_or_else(|| ModelError::NothingToSee {
        name: format!("--grounder {by}"),
        needs: "labels",
        hint: "name a grounder that sees pictures, as in --grounder hf/openai/clip-vit-base-patch32, or use a platform with labels",
    })?;
    Ok((&truth.labels, truth.room.as_deref()))
}
