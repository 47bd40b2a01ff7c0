//! Lists the objects that are visible in a picture, with their boxes and depths. It counts pixels, so hidden objects are
//! left out.

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
    /// The smallest depth among its pixels.
    pub nearest_m: f32,
    /// The middle depth among its pixels (the lower of the two middle ones).
    pub median_m: f32,
}

/// All ids that show in a picture, sorted by id.
#[must_use]
pub fn visible_objects(picture: &RenderedPicture) -> Vec<VisibleObject> {
    let width = picture.width.max(1) as usize;
    let mut found: BTreeMap<u32, ObjectPixels> = BTreeMap::new();
    let pixels: Vec<(u32, f32)> = picture.ids.iter().copied().zip(picture.depth_m.iter().copied()).collect();
    for (y, row) in pixels.chunks(width).enumerate() {
        let mut x = 0;
        for run in row.chunk_by(|a, b| a.0 == b.0) {
            if run[0].0 != 0 {
                let ends = [x as u32, y as u32, (x + run.len()) as u32, y as u32 + 1];
                found.entry(run[0].0).or_insert_with(ObjectPixels::empty_object).add_run(run, ends);
            }
            x += run.len();
        }
    }
    found.into_iter().map(|(id, found)| found.into_visible(id)).collect()
}

/// The pixels of one id that were counted so far.
struct ObjectPixels {
    depths_m: Vec<f32>,
    /// The first column and row with a pixel, and the column and row after the last.
    ends: [u32; 4],
}

impl ObjectPixels {
    fn empty_object() -> Self {
        Self { depths_m: Vec::new(), ends: [u32::MAX, u32::MAX, 0, 0] }
    }

    fn add_run(&mut self, run: &[(u32, f32)], [left, top, right, bottom]: [u32; 4]) {
        self.depths_m.extend(run.iter().map(|pixel| pixel.1));
        let [l, t, r, b] = self.ends;
        self.ends = [l.min(left), t.min(top), r.max(right), b.max(bottom)];
    }

    fn into_visible(mut self, id: u32) -> VisibleObject {
        let middle = (self.depths_m.len() - 1) / 2;
        let (nearer, &mut median_m, _) = self.depths_m.select_nth_unstable_by(middle, f32::total_cmp);
        let nearest_m = nearer.iter().copied().fold(median_m, f32::min);
        let [left, top, right, bottom] = self.ends;
        let bbox = [left, top, right - left, bottom - top];
        VisibleObject { id, pixels: self.depths_m.len() as u32, bbox, nearest_m, median_m }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_boxes_and_depths_of_each_id() {
        let ids = vec![0, 9, 9, 0, /**/ 3, 0, 9, 0, /**/ 3, 3, 0, 9];
        let depth_m = vec![f32::INFINITY, 4.0, 3.0, 1.0, 2.0, 1.0, 5.0, 1.0, 2.5, 7.0, 1.0, 6.0];
        let picture = RenderedPicture { width: 4, height: 3, rgb: vec![0; 36], depth_m, ids };
        let three = VisibleObject { id: 3, pixels: 3, bbox: [0, 1, 2, 2], nearest_m: 2.0, median_m: 2.5 };
        let nine = VisibleObject { id: 9, pixels: 4, bbox: [1, 0, 3, 3], nearest_m: 3.0, median_m: 4.0 };
        assert_eq!(visible_objects(&picture), [three, nine]);
    }

    #[test]
    fn visible_objects_of_an_empty_picture_is_empty() {
        let picture = RenderedPicture { width: 0, height: 0, rgb: vec![], depth_m: vec![], ids: vec![] };
        assert_eq!(visible_objects(&picture), []);
    }
}
