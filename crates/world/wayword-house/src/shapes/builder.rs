//! The simple parts that shapes are built from: boxes, cushions, tubes, balls, rods, discs.

use super::super::surface::HouseSurface;
use glam::{Vec2, Vec3};

/// Corners around the axis of a turned part (a part that is round like one made on a lathe).
const ROUND_SIDES: usize = 16;

/// Triangles of one surface, with normals for the light.
#[derive(Debug, Clone)]
pub(crate) struct MeshPart {
    pub(crate) surface: HouseSurface,
    pub(crate) positions: Vec<Vec3>,
    pub(crate) normals: Vec<Vec3>,
    pub(crate) uvs: Vec<Vec2>,
    pub(crate) triangles: Vec<[u32; 3]>,
}

/// The mesh of one thing, metres. A piece of furniture is centred on the origin, rests on z = 0, and faces -y; walls and
/// other parts of the house are in the world frame.
#[derive(Debug, Clone, Default)]
pub(crate) struct HouseShape {
    pub(crate) parts: Vec<MeshPart>,
}

impl MeshPart {
    fn new(surface: HouseSurface) -> Self {
        Self { surface, positions: Vec::new(), normals: Vec::new(), uvs: Vec::new(), triangles: Vec::new() }
    }

    fn add_vertex(&mut self, position: Vec3, normal: Vec3, uv: Vec2) -> u32 {
        self.positions.push(position);
        self.normals.push(normal);
        self.uvs.push(uv);
        self.positions.len() as u32 - 1
    }
}

/// How many corners a round part of this radius (metres) gets: a small part needs few.
fn sides_for_radius(radius: f32) -> usize {
    if radius > 0.06 { ROUND_SIDES } else { ROUND_SIDES / 2 }
}

/// Unit vector around the z axis.
fn unit_on_circle(step: usize, sides: usize) -> (f32, f32) {
    let angle = std::f32::consts::TAU * step as f32 / sides as f32;
    (libm::cosf(angle), libm::sinf(angle))
}

impl HouseShape {
    /// The part with this surface; a new one if there is none yet.
    pub(crate) fn part_for_surface(&mut self, surface: HouseSurface) -> &mut MeshPart {
        let at = self.parts.iter().position(|part| part.surface == surface).unwrap_or_else(|| {
            self.parts.push(MeshPart::new(surface));
            self.parts.len() - 1
        });
        &mut self.parts[at]
    }

    /// A flat quadrilateral from a corner along two edges; its front is the side from which `u` to `v` turns
    /// counter-clockwise. Texture coordinates run from `uv0` to `uv1`, v downwards.
    pub(crate) fn add_quad(&mut self, surface: HouseSurface, corner: Vec3, u: Vec3, v: Vec3, uv0: Vec2, uv1: Vec2) {
        let normal = u.cross(v).normalize_or_zero();
        let part = self.part_for_surface(surface);
        let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
        let [a, b, c, d] = corners.map(|(s, t)| {
            let uv = Vec2::new(uv0.x + (uv1.x - uv0.x) * s, uv1.y + (uv0.y - uv1.y) * t);
            part.add_vertex(corner + u * s + v * t, normal, uv)
        });
        part.triangles.extend([[a, b, c], [a, c, d]]);
    }

    /// A flat quadrilateral by its corners, counter-clockwise as seen from its front.
    pub(crate) fn add_face(&mut self, surface: HouseSurface, corners: [Vec3; 4]) {
        let [a, b, _, d] = corners;
        let normal = (b - a).cross(d - a).normalize_or_zero();
        let part = self.part_for_surface(surface);
        let [a, b, c, d] =
            corners.map(|corner| part.add_vertex(corner, normal, Vec2::new(corner.x + corner.y, -corner.z)));
        part.triangles.extend([[a, b, c], [a, c, d]]);
    }

    /// A quadrilateral that shows a whole picture.
    pub(crate) fn add_picture(&mut self, surface: HouseSurface, corner: Vec3, u: Vec3, v: Vec3) {
        self.add_quad(surface, corner, u, v, Vec2::ZERO, Vec2::ONE);
    }

    /// A flat rectangle with the texture at its natural size.
    fn add_tiled(&mut self, surface: HouseSurface, corner: Vec3, u: Vec3, v: Vec3) {
        let scale = surface.pattern.repeat_m();
        let along = if u.x.abs() + u.y.abs() > 1e-6 { corner.x + corner.y } else { corner.z };
        let start = Vec2::new(along / scale, -(corner.z + v.length()) / scale);
        self.add_quad(surface, corner, u, v, start, start + Vec2::new(u.length(), v.length()) / scale);
    }

    /// A box along the axes.
    pub(crate) fn add_block(&mut self, surface: HouseSurface, x: [f32; 2], y: [f32; 2], z: [f32; 2]) {
        let (low, high) = (Vec3::new(x[0], y[0], z[0]), Vec3::new(x[1], y[1], z[1]));
        let size = high - low;
        let (dx, dy, dz) = (Vec3::X * size.x, Vec3::Y * size.y, Vec3::Z * size.z);
        self.add_tiled(surface, low, dx, dz);
        self.add_tiled(surface, Vec3::new(high.x, high.y, low.z), -dx, dz);
        self.add_tiled(surface, Vec3::new(low.x, high.y, low.z), -dy, dz);
        self.add_tiled(surface, Vec3::new(high.x, low.y, low.z), dy, dz);
        self.add_tiled(surface, Vec3::new(low.x, low.y, high.z), dx, dy);
        self.add_tiled(surface, Vec3::new(low.x, high.y, low.z), dx, -dy);
    }

    /// A box with edges rounded by `radius`.
    pub(crate) fn add_soft_box(&mut self, surface: HouseSurface, x: [f32; 2], y: [f32; 2], z: [f32; 2], radius: f32) {
        let (low, high) = (Vec3::new(x[0], y[0], z[0]), Vec3::new(x[1], y[1], z[1]));
        let (centre, half) = ((low + high) / 2.0, (high - low) / 2.0);
        let radius = radius.min(half.min_element());
        for axis in 0..3 {
            for sign in [-1.0, 1.0] {
                self.soft_face(surface, centre, half, radius, axis, sign);
            }
        }
    }

    /// One of the six faces of a box with rounded edges: `axis` and `sign` choose it.
    fn soft_face(&mut self, surface: HouseSurface, centre: Vec3, half: Vec3, radius: f32, axis: usize, sign: f32) {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        // Small roundings get one bevel; large ones get one more corner.
        let all = |h: f32| vec![-h, -h + 0.3 * radius, -h + radius, h - radius, h - 0.3 * radius, h];
        let few = |h: f32| vec![-h, -h + radius, h - radius, h];
        let ticks = |h: f32| if radius < 0.05 { few(h) } else { all(h) };
        let (us, vs) = (ticks(half[u]), ticks(half[v]));
        let side = us.len() as u32;
        let scale = surface.pattern.repeat_m();
        let core = half - Vec3::splat(radius);
        let part = self.part_for_surface(surface);
        let base = part.positions.len() as u32;
        for tv in vs {
            for tu in us.iter().copied() {
                let mut at = Vec3::ZERO;
                (at[axis], at[u], at[v]) = (sign * half[axis], tu, tv);
                let inner = at.clamp(-core, core);
                let normal = (at - inner).normalize_or_zero();
                part.add_vertex(centre + inner + normal * radius, normal, Vec2::new(tu, -tv) / scale);
            }
        }
        for row in 0..side - 1 {
            for column in 0..side - 1 {
                let a = base + row * side + column;
                let (b, c, d) = (a + 1, a + side + 1, a + side);
                if sign > 0.0 {
                    part.triangles.extend([[a, b, c], [a, c, d]]);
                } else {
                    part.triangles.extend([[a, c, b], [a, d, c]]);
                }
            }
        }
    }

    /// A turned part around a vertical axis at `at`. `profile` has its radius and height at each edge, from bottom to top;
    /// `squeeze` scales it along y.
    pub(crate) fn add_turned(&mut self, surface: HouseSurface, at: (f32, f32), squeeze: f32, profile: &[(f32, f32)]) {
        let scale = surface.pattern.repeat_m();
        let sides = sides_for_radius(profile.iter().map(|(radius, _)| *radius).fold(0.0, f32::max));
        let part = self.part_for_surface(surface);
        for pair in profile.windows(2) {
            let ((r0, z0), (r1, z1)) = (pair[0], pair[1]);
            // The outside of a profile that goes up lies to its right.
            let slope = Vec2::new(z1 - z0, r0 - r1).normalize_or_zero();
            let base = part.positions.len() as u32;
            for step in 0..=sides {
                let (cos, sin) = unit_on_circle(step, sides);
                let normal = Vec3::new(cos * slope.x, sin * slope.x / squeeze.max(0.1), slope.y).normalize_or_zero();
                let turn = step as f32 / sides as f32 * std::f32::consts::TAU * r0.max(r1);
                for (radius, z) in [(r0, z0), (r1, z1)] {
                    let position = Vec3::new(at.0 + radius * cos, at.1 + radius * sin * squeeze, z);
                    part.add_vertex(position, normal, Vec2::new(turn, -z) / scale);
                }
            }
            for step in 0..sides as u32 {
                let a = base + step * 2;
                part.triangles.extend([[a, a + 2, a + 3], [a, a + 3, a + 1]]);
            }
        }
    }

    /// A closed cylinder or cone frustum.
    pub(crate) fn add_tube(&mut self, surface: HouseSurface, at: (f32, f32), radius: [f32; 2], z: [f32; 2]) {
        self.add_turned(surface, at, 1.0, &[(0.0, z[0]), (radius[0], z[0]), (radius[1], z[1]), (0.0, z[1])]);
    }

    /// A ball.
    pub(crate) fn add_ball(&mut self, surface: HouseSurface, centre: Vec3, radius: f32) {
        let half = sides_for_radius(radius) / 2;
        let ring = |step: usize| {
            let (cos, sin) = unit_on_circle(step, 2 * half);
            (radius * sin, centre.z - radius * cos)
        };
        let profile: Vec<_> = (0..=half).map(ring).collect();
        self.add_turned(surface, (centre.x, centre.y), 1.0, &profile);
    }

    /// A round bar between two points.
    pub(crate) fn add_rod(&mut self, surface: HouseSurface, from: Vec3, to: Vec3, radius: f32) {
        let axis = (to - from).normalize_or_zero();
        let side = if axis.z.abs() < 0.9 { axis.cross(Vec3::Z) } else { axis.cross(Vec3::X) }.normalize_or_zero();
        let up = axis.cross(side);
        let part = self.part_for_surface(surface);
        let base = part.positions.len() as u32;
        let sides = sides_for_radius(radius);
        for step in 0..=sides {
            let (cos, sin) = unit_on_circle(step, sides);
            let normal = side * cos + up * sin;
            part.add_vertex(from + normal * radius, normal, Vec2::new(step as f32 / sides as f32, 0.0));
            part.add_vertex(to + normal * radius, normal, Vec2::new(step as f32 / sides as f32, 1.0));
        }
        for step in 0..sides as u32 {
            let a = base + step * 2;
            part.triangles.extend([[a, a + 2, a + 3], [a, a + 3, a + 1]]);
        }
    }

    /// A disc that faces along `axis`.
    pub(crate) fn add_disc(&mut self, surface: HouseSurface, centre: Vec3, axis: Vec3, radius: f32) {
        let side = if axis.z.abs() < 0.9 { Vec3::Z.cross(axis) } else { Vec3::X }.normalize_or_zero();
        let up = axis.cross(side);
        let part = self.part_for_surface(surface);
        let middle = part.add_vertex(centre, axis, Vec2::splat(0.5));
        for step in 0..=ROUND_SIDES {
            let (cos, sin) = unit_on_circle(step, ROUND_SIDES);
            part.add_vertex(
                centre + (side * cos + up * sin) * radius,
                axis,
                Vec2::new(0.5 + cos / 2.0, 0.5 - sin / 2.0),
            );
        }
        let rim = |step: usize| middle + 1 + step as u32;
        part.triangles.extend((0..ROUND_SIDES).map(|step| [middle, rim(step), rim(step + 1)]));
    }

    /// A ring around `axis`, which is level: wheels, hoops.
    pub(crate) fn add_hoop(&mut self, surface: HouseSurface, centre: Vec3, axis: Vec3, radius: f32, thick: f32) {
        let side = Vec3::Z.cross(axis).normalize_or_zero();
        let up = axis.cross(side);
        for step in 0..ROUND_SIDES {
            let point = |step: usize| {
                let (cos, sin) = unit_on_circle(step, ROUND_SIDES);
                centre + (side * cos + up * sin) * radius
            };
            self.add_rod(surface, point(step), point(step + 1), thick);
        }
    }

    /// A flat pointed leaf, seen from both sides.
    pub(crate) fn add_leaf(&mut self, surface: HouseSurface, root: Vec3, tip: Vec3, width: f32) {
        let across = (tip - root).cross(Vec3::Z).normalize_or_zero() * width / 2.0;
        let middle = root + (tip - root) * 0.55 + Vec3::Z * (0.15 * (tip - root).length());
        for flip in [1.0, -1.0] {
            let normal = (across * flip).cross(tip - root).normalize_or_zero();
            let part = self.part_for_surface(surface);
            let a = part.add_vertex(root, normal, Vec2::new(0.5, 1.0));
            let b = part.add_vertex(middle + across * flip, normal, Vec2::new(1.0, 0.5));
            let c = part.add_vertex(tip, normal, Vec2::new(0.5, 0.0));
            let d = part.add_vertex(middle - across * flip, normal, Vec2::new(0.0, 0.5));
            part.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }

    /// Legs at the four corners of a rectangle.
    pub(crate) fn add_legs(&mut self, surface: HouseSurface, half: (f32, f32), thick: f32, height: f32) {
        for (sx, sy) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            let (x, y) = (sx * (half.0 - thick), sy * (half.1 - thick));
            let t = thick / 2.0;
            self.add_block(surface, [x - t, x + t], [y - t, y + t], [0.0, height]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn surface() -> HouseSurface {
        HouseSurface::from_rgb([200, 200, 200])
    }

    /// Sum over triangles of the volume towards the origin: positive where all fronts look outwards.
    fn volume(shape: &HouseShape) -> f32 {
        let part = &shape.parts[0];
        let corner = |index: u32| part.positions[index as usize];
        part.triangles.iter().map(|[a, b, c]| corner(*a).dot(corner(*b).cross(corner(*c))) / 6.0).sum()
    }

    #[test]
    fn fronts_look_outwards_and_enclose_the_volume() {
        let mut block = HouseShape::default();
        block.add_block(surface(), [1.0, 2.0], [-1.0, 1.0], [0.0, 0.5]);
        assert!((volume(&block) - 1.0).abs() < 1e-5);
        let mut tube = HouseShape::default();
        tube.add_tube(surface(), (0.0, 0.0), [0.5, 0.5], [0.0, 2.0]);
        assert!((volume(&tube) - std::f32::consts::FRAC_PI_2).abs() < 0.06);
        let mut soft = HouseShape::default();
        soft.add_soft_box(surface(), [0.0, 1.0], [0.0, 1.0], [0.0, 1.0], 0.1);
        assert!((0.9..1.0).contains(&volume(&soft)));
        let mut ball = HouseShape::default();
        ball.add_ball(surface(), Vec3::new(0.0, 0.0, 1.0), 0.5);
        assert!((0.45..0.53).contains(&volume(&ball)));
    }

    #[test]
    fn normals_look_the_way_of_their_fronts() {
        let mut shape = HouseShape::default();
        shape.add_soft_box(surface(), [0.0, 1.0], [0.0, 1.0], [0.0, 1.0], 0.2);
        shape.add_tube(surface(), (3.0, 0.0), [0.5, 0.3], [0.0, 2.0]);
        shape.add_rod(surface(), Vec3::ZERO, Vec3::new(1.0, 1.0, 1.0), 0.1);
        shape.add_disc(surface(), Vec3::ZERO, -Vec3::Y, 1.0);
        for part in &shape.parts {
            for [a, b, c] in &part.triangles {
                let corner = |index: &u32| part.positions[*index as usize];
                let front = (corner(b) - corner(a)).cross(corner(c) - corner(a));
                assert!(front.length() < 1e-9 || front.dot(part.normals[*a as usize]) > 0.0);
            }
        }
    }
}
