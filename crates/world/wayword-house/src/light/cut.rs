//! Cuts the triangles of a surface where the light on it changes, because light is stored at corners only.
//!
//! An edge is cut in its middle if the light there differs from the mean of its ends; this is repeated with the halves.
//! The decision depends on the two ends alone. So two triangles with a common edge agree, and no crack opens between
//! them.

use super::super::shapes::MeshPart;
use glam::Vec3;
use std::collections::{BTreeMap, HashMap};

/// Light at a place with a normal, as factors.
pub(in super::super) type LightFactors = [f32; 3];

/// The light on an edge may differ by this much from the value interpolated between its ends.
const LIGHT_TOLERANCE: f32 = 0.045;
/// Texture coordinates nearer to each other than this count as equal.
const SAME_TEXEL: f32 = 1e-4;
/// Where the light differs by this much, as at the edge of a patch of sunlight, pieces are cut to half the finest length.
const SHARP_LIGHT_STEP: f32 = 0.12;
/// Edges longer than this are tried at three places instead of one, metres.
const LONG_M: f32 = 0.45;
/// Most times that a triangle and its pieces are cut; this only bounds the work.
const MAX_CUT_DEPTH: u32 = 12;

/// How finely surfaces are cut, metres.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct SurfaceGrain {
    /// Where the light changes, down to about this length.
    pub(in super::super) finest_m: f32,
    /// Every longer edge is cut. A shadow in the middle of a wider piece would be missed.
    pub(in super::super) widest_m: f32,
}

/// Cuts the triangles of a part where the light changes, and gives the light of each corner.
pub(in super::super) fn cut_part(
    part: &mut MeshPart,
    grain: SurfaceGrain,
    light: impl Fn(Vec3, Vec3) -> LightFactors,
) -> Vec<LightFactors> {
    weld_corners(part);
    let colours = part.positions.iter().zip(&part.normals).map(|(at, normal)| light(*at, *normal)).collect();
    let mut cutter = SurfaceCutter { part, colours, grain, light, middles: BTreeMap::new() };
    let mut waiting: Vec<_> = std::mem::take(&mut cutter.part.triangles).into_iter().map(|each| (each, 0)).collect();
    waiting.reverse();
    while let Some((triangle, depth)) = waiting.pop() {
        let pieces = if depth < MAX_CUT_DEPTH { cutter.cut_triangle(triangle) } else { vec![triangle] };
        match pieces.as_slice() {
            [whole] => cutter.part.triangles.push(*whole),
            several => waiting.extend(several.iter().map(|piece| (*piece, depth + 1))),
        }
    }
    cutter.colours
}

/// Merges corners that have the same place, normal and texture coordinates, so that their light is computed only once.
fn weld_corners(part: &mut MeshPart) {
    let MeshPart { positions, normals, uvs, triangles, .. } = part;
    let mut first: HashMap<[u32; 6], usize> = HashMap::with_capacity(positions.len());
    let mut kept = 0;
    let mut moved = Vec::with_capacity(positions.len());
    for at in 0..positions.len() {
        // Adding zero turns -0.0 into 0.0, so that both have the same bits.
        let [p, n] = [positions[at] + Vec3::ZERO, normals[at] + Vec3::ZERO].map(|v| v.to_array().map(f32::to_bits));
        let other = *first.entry([p[0], p[1], p[2], n[0], n[1], n[2]]).or_insert(kept);
        let same = other < kept && uvs[other].distance_squared(uvs[at]) < SAME_TEXEL * SAME_TEXEL;
        moved.push(if same { other } else { kept } as u32);
        if !same {
            (positions[kept], normals[kept], uvs[kept]) = (positions[at], normals[at], uvs[at]);
            kept += 1;
        }
    }
    positions.truncate(kept);
    normals.truncate(kept);
    uvs.truncate(kept);
    triangles.iter_mut().flatten().for_each(|corner| *corner = moved[*corner as usize]);
}

/// A part while it is being cut.
struct SurfaceCutter<'a, L> {
    part: &'a mut MeshPart,
    colours: Vec<LightFactors>,
    grain: SurfaceGrain,
    light: L,
    /// The new corner in the middle of an edge; `None` where the edge stays whole.
    middles: BTreeMap<(u32, u32), Option<u32>>,
}

impl<L: Fn(Vec3, Vec3) -> LightFactors> SurfaceCutter<'_, L> {
    /// Cuts a triangle at the middles of those edges that need it: into one to four pieces.
    fn cut_triangle(&mut self, [a, b, c]: [u32; 3]) -> Vec<[u32; 3]> {
        match [self.edge_middle(a, b), self.edge_middle(b, c), self.edge_middle(c, a)] {
            [None, None, None] => vec![[a, b, c]],
            [Some(ab), Some(bc), Some(ca)] => vec![[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]],
            [Some(ab), None, None] => vec![[a, ab, c], [ab, b, c]],
            [None, Some(bc), None] => vec![[b, bc, a], [bc, c, a]],
            [None, None, Some(ca)] => vec![[c, ca, b], [ca, a, b]],
            [Some(ab), Some(bc), None] => vec![[ab, b, bc], [a, ab, bc], [a, bc, c]],
            [None, Some(bc), Some(ca)] => vec![[bc, c, ca], [b, bc, ca], [b, ca, a]],
            [Some(ab), None, Some(ca)] => vec![[ca, a, ab], [c, ca, ab], [c, ab, b]],
        }
    }

    /// The corner in the middle of an edge, made when it is first needed; `None` if the edge stays whole.
    fn edge_middle(&mut self, a: u32, b: u32) -> Option<u32> {
        let edge = (a.min(b), a.max(b));
        if let Some(known) = self.middles.get(&edge) {
            return *known;
        }
        let made = self.cut_edge(a as usize, b as usize);
        self.middles.insert(edge, made);
        made
    }

    /// Decides whether an edge is cut, and adds the new corner. The result is the same for both orders of the ends, because
    /// two triangles run along their common edge in opposite directions.
    fn cut_edge(&mut self, a: usize, b: usize) -> Option<u32> {
        let length = (self.part.positions[a] - self.part.positions[b]).length();
        let (finest, widest) = (self.grain.finest_m, self.grain.widest_m);
        if length < 0.75 * finest || (length < 1.5 * finest && self.light_difference(a, b) < SHARP_LIGHT_STEP) {
            return None;
        }
        let (at, normal, colour) = self.point_between(a, b, 0.5);
        let strays = self.interpolation_error(a, b, 0.5, colour);
        let uneven = length > widest || strays > if length < 1.5 * finest { SHARP_LIGHT_STEP } else { LIGHT_TOLERANCE };
        let uneven = uneven
            || length > LONG_M
                && [0.25, 0.75].into_iter().any(|share| {
                    let (_, _, colour) = self.point_between(a, b, share);
                    self.interpolation_error(a, b, share, colour) > LIGHT_TOLERANCE
                });
        uneven.then(|| {
            let uv = (self.part.uvs[a] + self.part.uvs[b]) * 0.5;
            self.part.positions.push(at);
            self.part.normals.push(normal);
            self.part.uvs.push(uv);
            self.colours.push(colour);
            self.colours.len() as u32 - 1
        })
    }

    /// How much the light at two corners differs.
    fn light_difference(&self, a: usize, b: usize) -> f32 {
        (0..3).map(|channel| (self.colours[a][channel] - self.colours[b][channel]).abs()).fold(0.0, f32::max)
    }

    /// Place, normal and light of a point on an edge; `share` is 0 at `a` and 1 at `b`.
    fn point_between(&self, a: usize, b: usize, share: f32) -> (Vec3, Vec3, LightFactors) {
        let at = self.part.positions[a] * (1.0 - share) + self.part.positions[b] * share;
        let normal = (self.part.normals[a] * (1.0 - share) + self.part.normals[b] * share).normalize_or_zero();
        (at, normal, (self.light)(at, normal))
    }

    /// How much the light at a point of an edge differs from the value interpolated between its ends.
    fn interpolation_error(&self, a: usize, b: usize, share: f32, colour: LightFactors) -> f32 {
        let interpolated = |channel: usize| self.colours[a][channel] * (1.0 - share) + self.colours[b][channel] * share;
        (0..3).map(|channel| (colour[channel] - interpolated(channel)).abs()).fold(0.0, f32::max)
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::{shapes::HouseShape, surface::HouseSurface};
    use super::*;
    use glam::Vec2;

    /// A square of 2 m in four pieces, with light on one side of a slanting line.
    fn half_lit() -> (MeshPart, Vec<LightFactors>) {
        let mut shape = HouseShape::default();
        for (x, y) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
            let uv = Vec2::new(x, -y);
            shape.add_quad(
                HouseSurface::from_rgb([255; 3]),
                Vec3::new(x, y, 0.0),
                Vec3::X,
                Vec3::Y,
                uv - Vec2::Y,
                uv + Vec2::X,
            );
        }
        let mut part = shape.parts.remove(0);
        let light = |at: Vec3, _: Vec3| if at.x + 0.6 * at.y < 1.3 { [1.0; 3] } else { [0.2; 3] };
        let colours = cut_part(&mut part, SurfaceGrain { finest_m: 0.1, widest_m: 0.5 }, light);
        (part, colours)
    }

    #[test]
    fn no_crack_opens_between_pieces() {
        let (part, _) = half_lit();
        let mut shared: BTreeMap<[[u32; 2]; 2], usize> = BTreeMap::new();
        for [a, b, c] in &part.triangles {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                let mut ends =
                    [from, to].map(|at| part.positions[*at as usize].truncate().to_array().map(f32::to_bits));
                ends.sort_unstable();
                *shared.entry(ends).or_default() += 1;
            }
        }
        let is_rim = |ends: &[[u32; 2]; 2]| {
            let at = ends.map(|end| end.map(f32::from_bits));
            (0..2).any(|axis| [0.0, 2.0].iter().any(|rim| at[0][axis] == *rim && at[1][axis] == *rim))
        };
        for (ends, count) in &shared {
            assert_eq!(*count, if is_rim(ends) { 1 } else { 2 }, "{:?}", ends.map(|end| end.map(f32::from_bits)));
        }
    }

    #[test]
    fn pieces_are_small_only_where_the_light_changes() {
        let (part, colours) = half_lit();
        assert_eq!(colours.len(), part.positions.len());
        let is_mixed = |triangle: &&[u32; 3]| {
            let lit = triangle.iter().filter(|at| colours[**at as usize][0] > 0.5).count();
            lit == 1 || lit == 2
        };
        let longest = |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|at| part.positions[at as usize]);
            a.distance(b).max(b.distance(c)).max(c.distance(a))
        };
        let mixed = part.triangles.iter().filter(is_mixed).map(longest).fold(0.0, f32::max);
        assert!(mixed > 0.0 && mixed < 0.15, "{mixed} m across the edge of the light");
        assert!(part.triangles.iter().map(longest).fold(0.0, f32::max) > 0.3);
    }
}
