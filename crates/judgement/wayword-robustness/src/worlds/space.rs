//! Mirrored and turned worlds.

use super::{WorldAlteration, altered_platform::AlteredLook};
use std::{f64::consts::FRAC_PI_2, sync::Arc};
use wayword_core::{DVec3, DepthImage, GroundTruth, Heading, Image, ObjectLabel, PlatformError, Pose, View};

/// The world mirrored at the plane x = 0: left becomes right, and all distances stay the same.
#[derive(Debug, Clone, Copy, Default)]
pub struct WorldMirror;

/// The world turned by 90 degrees clockwise, seen from above, around the origin.
#[derive(Debug, Clone, Copy, Default)]
pub struct QuarterTurn;

impl WorldAlteration for WorldMirror {
    fn place_after(&self, before: DVec3) -> DVec3 {
        before.with_x(-before.x)
    }

    fn place_before(&self, after: DVec3) -> DVec3 {
        after.with_x(-after.x)
    }

    fn heading_after(&self, before: Heading) -> Heading {
        Heading::NORTH.turned_by(-before.rad())
    }

    fn heading_before(&self, after: Heading) -> Heading {
        self.heading_after(after)
    }

    fn view_after(&self, _: AlteredLook<'_>, before: View) -> Result<View, PlatformError> {
        let width_px = before.image.as_ref().map(|image| f64::from(image.width_px()));
        let label = |mut label: ObjectLabel| {
            // Without a picture its width is unknown, so the box cannot be mirrored and is dropped.
            label.box_px =
                label.box_px.zip(width_px).map(|([x, y, width, height], all)| [all - x - width, y, width, height]);
            label
        };
        let mut after = move_view(self, before, label);
        after.image = after.image.as_deref().map(mirror_image).map(Arc::new);
        Ok(after)
    }

    fn depth_after(&self, _: DepthImage) -> Option<DepthImage> {
        None
    }
}

impl WorldAlteration for QuarterTurn {
    fn place_after(&self, before: DVec3) -> DVec3 {
        DVec3::new(before.y, -before.x, before.z)
    }

    fn place_before(&self, after: DVec3) -> DVec3 {
        DVec3::new(-after.y, after.x, after.z)
    }

    fn heading_after(&self, before: Heading) -> Heading {
        before.turned_by(FRAC_PI_2)
    }

    fn heading_before(&self, after: Heading) -> Heading {
        after.turned_by(-FRAC_PI_2)
    }

    fn view_after(&self, _: AlteredLook<'_>, before: View) -> Result<View, PlatformError> {
        Ok(move_view(self, before, |label| label))
    }
}

/// Maps the pose and the labels of a view into the changed space.
fn move_view(space: &impl WorldAlteration, before: View, label: impl Fn(ObjectLabel) -> ObjectLabel) -> View {
    let truth = before.ground_truth().cloned().map(|truth| GroundTruth {
        labels: truth.labels.into_iter().map(|before| label(label_after(space, before))).collect(),
        ..truth
    });
    let pose = Pose {
        position: space.place_after(before.pose.position),
        heading: space.heading_after(before.pose.heading),
        ..before.pose
    };
    View::new(pose, before.horizontal_fov_rad, before.image, truth)
}

fn label_after(space: &impl WorldAlteration, before: ObjectLabel) -> ObjectLabel {
    ObjectLabel {
        heading: space.heading_after(before.heading),
        position: before.position.map(|position| space.place_after(position)),
        ..before
    }
}

/// Mirrors a picture by reversing its columns.
fn mirror_image(image: &Image) -> Image {
    let mut rgb = Vec::with_capacity(image.rgb_bytes().len());
    for row in image.rgb_bytes().chunks_exact(image.width_px() as usize * 3) {
        rgb.extend(row.chunks_exact(3).rev().flatten());
    }
    Image::new(image.width_px(), image.height_px(), rgb).unwrap_or_else(|_| image.clone())
}

#[cfg(test)]
mod tests;
