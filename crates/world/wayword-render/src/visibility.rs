//! Lists the objects that are visible in a picture, with their boxes. It counts pixels, so hidden objects are left out.

use crate::picture::RenderedPicture;
use std::collections::BTreeMap;

/// One id that shows in a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct VisibleObject {
    /// The id of its meshes; never 0.
    pub id: u32,
    /// Pixels that show it.
    pub pixels: u32,
    /// The smallest box of pixels around them: x, y of the top left pixel, width, height.
    pub bbox: [u32; 4],
}

/// All ids that show in a picture, sorted by id.
#[must_use]
pub fn visible_objects(picture: &RenderedPicture) -> Vec<VisibleObject> {
    let width = picture.width.max(1) as usize;
    let mut found: BTreeMap<u32, ObjectPixels> = BTreeMap::new();
    for (y, row) in picture.ids.chunks(width).enumerate() {
        let mut x = 0;
        for run in row.chunk_by(|a, b| a == b) {
            if run[0] != 0 {
                let ends = [x as u32, y as u32, (x + run.len()) as u32, y as u32 + 1];
                found.entry(run[0]).or_insert_with(ObjectPixels::empty_object).add_run(ends);
            }
            x += run.len();
        }
    }
    found.into_iter().map(|(id, found)| found.into_visible(id)).collect()
}

/// The pixels of one id that were counted so far.
struct ObjectPixels {
    pixels: u32,
    /// The first column and row with a pixel, and the column and row after the last.
    ends: [u32; 4],
}

impl ObjectPixels {
    fn empty_object() -> Self {
        Self { pixels: 0, ends: [u32::MAX, u32::MAX, 0, 0] }
    }

    fn add_run(&mut self, [left, top, right, bottom]: [u32; 4]) {
        self.pixels += right - left;
        let [l, t, r, b] = self.ends;
        self.ends = [l.min(left), t.min(top), r.max(right), b.max(bottom)];
    }

    fn into_visible(self, id: u32) -> VisibleObject {
        let [left, top, right, bottom] = self.ends;
        VisibleObject { id, pixels: self.pixels, bbox: [left, top, right - left, bottom - top] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_and_boxes_of_each_id() {
        let ids = vec![0, 9, 9, 0, /**/ 3, 0, 9, 0, /**/ 3, 3, 0, 9];
        let picture = RenderedPicture { width: 4, height: 3, rgb: vec![0; 36], depth_m: vec![1.0; 12], ids };
        let three = VisibleObject { id: 3, pixels: 3, bbox: [0, 1, 2, 2] };
        let nine = VisibleObject { id: 9, pixels: 4, bbox: [1, 0, 3, 3] };
        assert_eq!(visible_objects(&picture), [three, nine]);
    }

    #[test]
    fn visible_objects_of_an_empty_picture_is_empty() {
        let picture = RenderedPicture { width: 0, height: 0, rgb: vec![], depth_m: vec![], ids: vec![] };
        assert_eq!(visible_objects(&picture), []);
    }
}
