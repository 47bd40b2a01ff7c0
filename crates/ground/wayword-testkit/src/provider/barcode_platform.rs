//! Wraps a platform so that its pictures show barcodes instead of the scene. The labels of each view go into a gallery under the
//! barcode's number, and so a [`FlawedEye`](super::scripts::FlawedEye) can answer questions about the picture.

use super::{GalleryThing, PictureGallery, PictureScenery, barcode};
use sha2::{Digest, Sha256};
use std::sync::Arc;
use wayword_core::{
    DepthImage, Frame, Ground, GroundIsland, GroundRoute, Path, PathRequest, Platform, PlatformError, SceneId, View,
    ViewGaze, ViewThird, ViewpointGraph,
};

/// What is farther than this is called far, metres.
const FAR_M: f64 = 4.0;

/// A platform with a barcode in each view instead of a picture of the scene.
pub struct BarcodePlatform<P> {
    platform: P,
    gallery: PictureGallery,
}

impl<P: Platform> BarcodePlatform<P> {
    /// Wraps a platform. Each view that is looked at is added to the gallery.
    #[must_use]
    pub fn new(platform: P, gallery: PictureGallery) -> Self {
        Self { platform, gallery }
    }
}

impl<P: Platform> Platform for BarcodePlatform<P> {
    fn name(&self) -> &'static str {
        self.platform.name()
    }

    fn list_scenes(&self) -> Result<Vec<SceneId>, PlatformError> {
        self.platform.list_scenes()
    }

    fn graph_for_scene(&self, scene: &SceneId) -> Result<Arc<ViewpointGraph>, PlatformError> {
        self.platform.graph_for_scene(scene)
    }

    fn sample_path(&self, scene: &SceneId, request: &PathRequest, seed: u64) -> Result<Path, PlatformError> {
        self.platform.sample_path(scene, request, seed)
    }

    fn look_from(&self, scene: &SceneId, from: &Frame, gaze: ViewGaze) -> Result<View, PlatformError> {
        // The barcode replaces the picture, so the platform need not draw one.
        let view = self.platform.look_without_picture(scene, from, gaze)?;
        let truth = view.ground_truth().cloned();
        let id = view_number(scene, from, gaze);
        if let Some(truth) = &truth {
            let third = |label: &wayword_core::ObjectLabel| {
                let off_rad = view.pose.heading.turn_to(label.heading);
                match ViewThird::from_offset(off_rad, view.horizontal_fov_rad) {
                    ViewThird::Left => 0,
                    ViewThird::Middle => 1,
                    ViewThird::Right => 2,
                }
            };
            let things = truth.labels.iter().map(|label| GalleryThing {
                name: label.name.clone(),
                third: third(label),
                colour: label.colour.clone(),
                is_far: label.distance_m.is_some_and(|metres| metres > FAR_M),
            });
            self.gallery.add_picture(id, PictureScenery { room: truth.room.clone(), things: things.collect() });
        }
        Ok(View::new(view.pose, view.horizontal_fov_rad, Some(Arc::new(barcode::draw_number(id))), truth))
    }

    fn inner(&self) -> Option<&dyn Platform> {
        Some(&self.platform)
    }

    fn ground(&self) -> &dyn Ground {
        self
    }
}

/// Routes, islands and depth come from the wrapped platform, because barcodes replace only pictures. `look_down` keeps its default,
/// which gives no picture: a picture from above would show the scene.
impl<P: Platform> Ground for BarcodePlatform<P> {
    fn ground_route(&self, scene: &SceneId, from: &Frame, to: &Frame) -> Result<Option<GroundRoute>, PlatformError> {
        self.platform.ground().ground_route(scene, from, to)
    }

    fn ground_islands(&self, scene: &SceneId) -> Result<Vec<GroundIsland>, PlatformError> {
        self.platform.ground().ground_islands(scene)
    }

    fn view_depth(&self, scene: &SceneId, from: &Frame, gaze: ViewGaze) -> Result<Option<DepthImage>, PlatformError> {
        self.platform.ground().view_depth(scene, from, gaze)
    }
}

/// The number of a view, hashed from the scene, the position and the direction. Equal views have equal numbers.
fn view_number(scene: &SceneId, from: &Frame, gaze: ViewGaze) -> u64 {
    let mut hash = Sha256::new();
    hash.update(scene.as_str());
    for metres in from.pose.position.to_array() {
        hash.update(metres.to_bits().to_le_bytes());
    }
    for rad in [gaze.heading.rad(), gaze.horizontal_fov_rad] {
        hash.update(((rad * 1e6).round() as u64).to_le_bytes());
    }
    let bytes: [u8; 32] = hash.finalize().into();
    u64::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3], bytes[4], bytes[5], bytes[6], bytes[7]])
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
    use wayword_core::{DVec3, GroundTruth, Heading, ObjectId, ObjectLabel, Pose};

    /// A platform with one place, which has a lamp ahead and a bed on the right.
    struct Cell;

    impl Platform for Cell {
        fn name(&self) -> &'static str {
            "cell"
        }

        fn list_scenes(&self) -> Result<Vec<SceneId>, PlatformError> {
            Ok(vec![SceneId::new("cell").unwrap()])
        }

        fn graph_for_scene(&self, _: &SceneId) -> Result<Arc<ViewpointGraph>, PlatformError> {
            panic!("this test needs no graph")
        }

        fn sample_path(&self, _: &SceneId, _: &PathRequest, _: u64) -> Result<Path, PlatformError> {
            panic!("this test needs no path")
        }

        fn look_from(&self, _: &SceneId, from: &Frame, gaze: ViewGaze) -> Result<View, PlatformError> {
            let label = |name: &str, turn_rad: f64| ObjectLabel {
                object: ObjectId::new(name).unwrap(),
                name: name.to_owned(),
                heading: gaze.heading.turned_by(turn_rad),
                elevation_rad: 0.0,
                box_px: None,
                distance_m: None,
                position: None,
                colour: None,
                room: None,
            };
            let truth = GroundTruth {
                labels: vec![label("lamp", 0.0), label("bed", 0.7)],
                lists_objects: true,
                room: Some("cell".into()),
            };
            let pose = Pose { heading: gaze.heading, ..from.pose };
            Ok(View::new(pose, gaze.horizontal_fov_rad, None, Some(truth)))
        }
    }

    #[test]
    fn gallery_has_the_contents_of_each_picture() {
        let gallery = PictureGallery::default();
        let world = BarcodePlatform::new(Cell, gallery.clone());
        let scene = world.list_scenes().unwrap().remove(0);
        let pose = Pose { position: DVec3::ZERO, heading: Heading::NORTH, elevation_rad: 0.0 };
        let frame = Frame { pose, viewpoint: None, level: None };
        let look =
            |rad: f64| world.look_from(&scene, &frame, ViewGaze::quarter_view(Heading::new(rad).unwrap())).unwrap();
        let (first, second, again) = (look(0.0), look(1.0), look(0.0));
        assert_eq!(first.image, again.image);
        assert_ne!(first.image, second.image);
        let picture = first.image.unwrap();
        let mut file = Vec::new();
        let encoder = PngEncoder::new(&mut file);
        encoder
            .write_image(picture.rgb_bytes(), picture.width_px(), picture.height_px(), ExtendedColorType::Rgb8)
            .unwrap();
        let scenery = gallery.find_scenery(barcode::read_number(&file).unwrap()).unwrap();
        let thing = |name: &str, third| GalleryThing { name: name.to_owned(), third, colour: None, is_far: false };
        assert_eq!(scenery.things, [thing("lamp", 1), thing("bed", 2)]);
        assert_eq!(scenery.room.as_deref(), Some("cell"));
    }
}
