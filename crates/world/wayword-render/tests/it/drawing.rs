//! Properties that every drawn picture must have.

#![allow(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use glam::{DVec2, DVec3, Vec2, Vec3};
use proptest::prelude::*;
use wayword_render::{
    Mesh, MeshMaterial, PictureBackground, PinholeCamera, RenderScene, RenderedPicture, Texture, TextureFilter,
    render_ids, render_scene, top_down, visible_objects,
};

const BOTH_SIDES: MeshMaterial = MeshMaterial { base_colour: [1.0; 4], texture: None, double_sided: true };

fn camera(heading_rad: f64, elevation_rad: f64) -> PinholeCamera {
    let position = DVec3::new(0.0, 0.0, 1.5);
    PinholeCamera { position, heading_rad, elevation_rad, vertical_fov_rad: 1.0, width: 160, height: 120 }
}

/// A mesh of one colour per id, drawn from both sides.
fn mesh(id: u32, positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Mesh {
    let shade = [0.2 + 0.1 * (id % 8) as f32; 3];
    let colours = vec![shade; positions.len()];
    Mesh { positions, colours, triangles, id, ..Mesh::default() }
}

fn draw(meshes: Vec<Mesh>, camera: &PinholeCamera) -> RenderedPicture {
    render_scene(&RenderScene::new(meshes, vec![BOTH_SIDES], vec![]).unwrap(), camera).unwrap()
}

fn covered(picture: &RenderedPicture) -> usize {
    picture.ids.iter().filter(|&&id| id != 0).count()
}

/// A square that faces south, `half` metres from its centre to its sides.
fn square(id: u32, centre: Vec3, half: f32) -> Mesh {
    let corner = |x: f32, z: f32| centre + Vec3::new(x, 0.0, z) * half;
    let positions = vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    mesh(id, positions, vec![[0, 1, 2], [0, 2, 3]])
}

#[test]
fn a_square_falls_where_the_camera_projects_it() {
    let camera = camera(0.0, 0.0);
    let picture = draw(vec![square(5, Vec3::new(0.5, 4.0, 1.5), 0.5)], &camera);
    let seen = visible_objects(&picture);
    let (left, bottom, depth) = camera.project_point(DVec3::new(0.0, 4.0, 1.0)).unwrap();
    let (right, top, _) = camera.project_point(DVec3::new(1.0, 4.0, 2.0)).unwrap();
    let [x, y, width, height] = seen[0].bbox.map(f64::from);
    for (pixel, edge) in [(x, left), (y, top), (x + width, right), (y + height, bottom)] {
        assert!((pixel - edge).abs() <= 0.51, "{pixel} against {edge}");
    }
    let middle = (y + height / 2.0) as usize * picture.width as usize + (x + width / 2.0) as usize;
    assert!((f64::from(picture.depth_m[middle]) - depth).abs() < 1e-5);
    assert_eq!(picture.depth_m[0], f32::INFINITY);
}

#[test]
fn depths_and_ids_are_the_same_without_colours() {
    let camera = camera(0.1, 0.05);
    let meshes = vec![square(5, Vec3::new(0.5, 4.0, 1.5), 0.5), square(8, Vec3::new(-0.3, 6.0, 1.2), 0.9)];
    let scene = RenderScene::new(meshes, vec![BOTH_SIDES], vec![]).unwrap();
    let (coloured, plain) = (render_scene(&scene, &camera).unwrap(), render_ids(&scene, &camera).unwrap());
    assert!(covered(&plain) > 0 && plain.rgb.is_empty());
    assert_eq!(plain, RenderedPicture { rgb: Vec::new(), ..coloured });
}

#[test]
fn only_front_faces_show_unless_double_sided() {
    let front = MeshMaterial { double_sided: false, ..BOTH_SIDES };
    let mut wall = square(5, Vec3::new(0.0, 4.0, 1.5), 0.5);
    let shown = |wall: &Mesh, material: &MeshMaterial| {
        let scene = RenderScene::new(vec![wall.clone()], vec![material.clone()], vec![]).unwrap();
        covered(&render_scene(&scene, &camera(0.0, 0.0)).unwrap())
    };
    let whole = shown(&wall, &front);
    assert!(whole > 0);
    wall.triangles = vec![[0, 2, 1], [0, 3, 2]];
    assert_eq!(shown(&wall, &front), 0);
    assert_eq!(shown(&wall, &BOTH_SIDES), whole);
}

#[test]
fn at_equal_depth_the_first_triangle_is_visible() {
    let (one, two) = (square(1, Vec3::new(0.0, 4.0, 1.5), 0.5), square(2, Vec3::new(0.0, 4.0, 1.5), 0.5));
    let ids = |meshes| visible_objects(&draw(meshes, &camera(0.0, 0.0))).iter().map(|v| v.id).collect::<Vec<_>>();
    assert_eq!(ids(vec![one.clone(), two.clone()]), [1]);
    assert_eq!(ids(vec![two, one]), [2]);
}

#[test]
fn a_floor_that_runs_under_the_camera_keeps_its_visible_half() {
    // Two triangles of 200 m, most of them behind the eye: both the near plane and the guard band cut them.
    let corners = [(-100.0, -100.0), (100.0, -100.0), (100.0, 100.0), (-100.0, 100.0)];
    let positions = corners.map(|(x, y)| Vec3::new(x, y, 0.0)).to_vec();
    let floor = mesh(3, positions, vec![[0, 1, 2], [0, 2, 3]]);
    let camera = camera(0.6, -0.2);
    let picture = draw(vec![floor], &camera);
    for y in 0..120 {
        for x in 0..160 {
            let ray = camera.ray_through(f64::from(x) + 0.5, f64::from(y) + 0.5);
            let hit = camera.position + ray * (camera.position.z / -ray.z);
            let on_floor = ray.z < 0.0 && hit.x.abs() < 99.0 && hit.y.abs() < 99.0;
            let index = (y * 160 + x) as usize;
            if on_floor {
                let (_, _, depth) = camera.project_point(hit).unwrap();
                assert_eq!(picture.ids[index], 3, "pixel {x}, {y}");
                assert!((f64::from(picture.depth_m[index]) / depth - 1.0).abs() < 1e-3, "pixel {x}, {y}");
            } else if ray.z >= 0.0 {
                assert_eq!(picture.ids[index], 0, "pixel {x}, {y}");
            }
        }
    }
}

#[test]
fn textures_lie_the_right_way_up_and_in_perspective() {
    let colours = [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255, 255, 255, 255]];
    let texels = (0..64 * 64).map(|i| colours[(i / 64 / 32) * 2 + i % 64 / 32]).collect();
    let texture = Texture::new(64, 64, texels).unwrap();
    // The right side is four times as far away as the left one, so its half of the picture is narrower.
    let positions =
        vec![Vec3::new(-1.0, 2.0, 0.5), Vec3::new(3.0, 8.0, 0.5), Vec3::new(3.0, 8.0, 2.5), Vec3::new(-1.0, 2.0, 2.5)];
    let uvs = [(0.0, 1.0), (1.0, 1.0), (1.0, 0.0), (0.0, 0.0)].map(Vec2::from).to_vec();
    let wall = Mesh { positions, uvs, triangles: vec![[0, 1, 2], [0, 2, 3]], id: 1, ..Mesh::default() };
    let material = MeshMaterial { texture: Some(0), ..MeshMaterial::default() };
    for filter in [TextureFilter::Bilinear, TextureFilter::Trilinear] {
        let scene = RenderScene::new(vec![wall.clone()], vec![material.clone()], vec![texture.clone()]).unwrap();
        let picture = render_scene(&scene.with_filter(filter), &camera(0.2, 0.0)).unwrap();
        let at = |u: f64, v: f64| {
            let point = DVec3::new(-1.0 + 4.0 * u, 2.0 + 6.0 * u, 2.5 - 2.0 * v);
            let (x, y, _) = camera(0.2, 0.0).project_point(point).unwrap();
            let index = y as usize * 160 + x as usize;
            [0, 1, 2].map(|c| picture.rgb[3 * index + c])
        };
        assert_eq!(at(0.4, 0.4), [255, 0, 0]);
        assert_eq!(at(0.6, 0.4), [0, 255, 0]);
        assert_eq!(at(0.4, 0.6), [0, 0, 255]);
        assert_eq!(at(0.6, 0.6), [255, 255, 255]);
    }
}

#[test]
fn light_multiplies_and_saturates() {
    let mut wall = square(1, Vec3::new(0.0, 4.0, 1.5), 3.0);
    wall.colours = vec![[0.5, 1.0, 3.0]; 4];
    let material = MeshMaterial { base_colour: [0.5, 0.5, 0.5, 1.0], ..BOTH_SIDES };
    let scene = RenderScene::new(vec![wall], vec![material], vec![]).unwrap();
    let picture = render_scene(&scene, &camera(0.0, 0.0)).unwrap();
    assert_eq!(picture.rgb[..3], [64, 128, 255]);
}

#[test]
fn the_sky_is_lighter_where_it_is_higher() {
    let background = PictureBackground::Sky { zenith: [0, 0, 255], horizon: [0; 3], nadir: [255, 0, 0] };
    let scene = RenderScene::new(vec![], vec![], vec![]).unwrap().with_background(background);
    let picture = render_scene(&scene, &camera(1.0, 0.0)).unwrap();
    let rows: Vec<&[u8]> = picture.rgb.chunks(3 * 160).collect();
    assert!(rows.windows(2).all(|pair| pair[0][2] >= pair[1][2] && pair[0][0] <= pair[1][0]));
    assert!(rows[0][2] > 100 && rows[119][0] > 100);
}

#[test]
fn a_map_shows_what_is_below_the_cut() {
    let slab = |id, x: f32, z: f32| {
        let corner = |dx: f32, dy: f32| Vec3::new(x + dx, dy, z);
        mesh(
            id,
            vec![corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)],
            vec![[0, 1, 2], [0, 2, 3]],
        )
    };
    let scene =
        RenderScene::new(vec![slab(1, 0.0, 0.0), slab(2, 0.5, 0.5), slab(3, 0.0, 2.5)], vec![BOTH_SIDES], vec![])
            .unwrap();
    let map = top_down(&scene, DVec2::new(-1.0, -1.0), DVec2::new(3.0, 2.0), 2.0, 0.1).unwrap();
    assert_eq!((map.width, map.height), (40, 30));
    let id = |x: f64, y: f64| map.ids[((2.0 - y) / 0.1) as usize * 40 + ((x + 1.0) / 0.1) as usize];
    assert_eq!((id(0.25, 0.25), id(0.75, 0.75), id(1.25, 0.25), id(-0.5, 0.5)), (1, 2, 2, 0));
    assert_eq!((id(0.25, 1.25), id(0.25, -0.25)), (0, 0));
    let depth = map.depth_m[((2.0f64 - 0.25) / 0.1) as usize * 40 + 12];
    assert!((depth - 2.0).abs() < 1e-6);
    assert_eq!(map.rgb[..3], [255; 3]);
    assert_eq!(visible_objects(&map).iter().map(|v| v.pixels).collect::<Vec<_>>(), [50, 100]);
    assert!(top_down(&scene, DVec2::ZERO, DVec2::splat(1e9), 2.0, 0.1).is_err());
    assert!(top_down(&scene, DVec2::ZERO, DVec2::NAN, 2.0, 0.1).is_err());
    assert!(top_down(&scene, DVec2::ZERO, DVec2::ONE, 2.0, 0.0).is_err());
}

fn point() -> impl Strategy<Value = Vec3> {
    [-6.0..6.0f32, -6.0..6.0f32, -3.0..6.0f32].prop_map(Vec3::from)
}

fn front_point() -> impl Strategy<Value = Vec3> {
    (-1.0..1.0f32, 2.0..6.0f32, -0.7..0.7f32).prop_map(|(x, y, z)| Vec3::new(x * y * 0.6, y, 1.5 + z * y * 0.6))
}

proptest! {
    #[test]
    fn a_triangle_covers_about_its_projected_area(a in front_point(), b in front_point(), c in front_point()) {
        let camera = camera(0.0, 0.0);
        let picture = draw(vec![mesh(1, vec![a, b, c], vec![[0, 1, 2]])], &camera);
        let [a, b, c] = [a, b, c].map(|p| camera.project_point(p.as_dvec3()).map(|(x, y, _)| DVec2::new(x, y)).unwrap());
        let area = (b - a).perp_dot(c - a).abs() / 2.0;
        let outline = a.distance(b) + b.distance(c) + c.distance(a);
        prop_assert!((covered(&picture) as f64 - area).abs() <= outline / 2.0 + 2.0);
    }

    #[test]
    fn depth_is_that_of_the_plane(a in front_point(), b in front_point(), c in front_point()) {
        let camera = camera(0.0, 0.0);
        let picture = draw(vec![mesh(1, vec![a, b, c], vec![[0, 1, 2]])], &camera);
        let (near, far) = (a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y));
        for (id, depth) in picture.ids.iter().zip(&picture.depth_m) {
            prop_assert!(*id == 0 || (near * 0.9999..=far * 1.0001).contains(depth), "{depth} outside {near}..{far}");
        }
    }

    #[test]
    fn a_fan_around_a_point_has_no_gaps_and_no_double_hits(
        centre in (-0.5..0.5f32, -0.5..0.5f32, 2.0..6.0f32), radii in proptest::collection::vec(3.0..9.0f32, 3..9),
        tilt in -0.3..0.3f32,
    ) {
        // Each slice has its own id and is one triangle; together they cover the whole picture, also beyond its sides.
        let (x, z, y) = centre;
        let rim = |i: usize| {
            let (sin, cos) = (i as f32 / radii.len() as f32 * std::f32::consts::TAU).sin_cos();
            Vec3::new(x + cos * radii[i] * 4.0, y + tilt * sin * radii[i], 1.5 + z + sin * radii[i] * 4.0)
        };
        let hub = Vec3::new(x, y, 1.5 + z);
        let slices = (0..radii.len()).map(|i| {
            mesh(1 + i as u32, vec![hub, rim(i), rim((i + 1) % radii.len())], vec![[0, 1, 2]])
        }).collect::<Vec<_>>();
        let alone: usize = slices.iter().map(|s| covered(&draw(vec![s.clone()], &camera(0.0, 0.0)))).sum();
        let together = covered(&draw(slices, &camera(0.0, 0.0)));
        prop_assert_eq!(alone, together);
        if radii.len() >= 5 {
            prop_assert_eq!(together, 160 * 120);
        }
    }

    #[test]
    fn the_nearer_of_two_squares_is_visible(near in 1.5..4.0f32, gap in 0.01..3.0f32, swap: bool) {
        let mut squares = vec![square(1, Vec3::new(0.0, near, 1.5), 0.4), square(2, Vec3::new(0.2, near + gap, 1.5), 0.4)];
        let alone = draw(vec![squares[0].clone()], &camera(0.0, 0.0));
        if swap {
            squares.swap(0, 1);
        }
        let both = draw(squares, &camera(0.0, 0.0));
        for (alone, both) in alone.ids.iter().zip(&both.ids) {
            prop_assert!(*alone == 0 || *both == 1);
        }
    }

    #[test]
    fn endless_triangles_do_no_harm(
        corners in proptest::collection::vec(proptest::array::uniform9(-1e6..1e6f32), 1..20), shift in 0..7u32,
        heading in 0.0..6.2f64, fov in 0.0001..3.1f64,
    ) {
        let scale = 0.1f32.powi(shift as i32);
        let meshes: Vec<Mesh> = corners.iter().map(|c| {
            let corner = |i: usize| Vec3::new(c[i] * scale, c[i + 1], c[i + 2] * scale);
            mesh(1, vec![corner(0), corner(3), corner(6)], vec![[0, 1, 2]])
        }).collect();
        let scene = RenderScene::new(meshes, vec![BOTH_SIDES], vec![]).unwrap();
        let view = PinholeCamera { vertical_fov_rad: fov, ..camera(heading, 0.1) };
        let map = top_down(&scene, DVec2::splat(-3.0), DVec2::splat(3.0), 2.0, 0.1).unwrap();
        for picture in [render_scene(&scene, &view).unwrap(), map] {
            prop_assert!(picture.depth_m.iter().all(|d| *d > -0.2));
            prop_assert!(picture.ids.iter().zip(&picture.depth_m).all(|(id, d)| (*id == 0) == d.is_infinite()));
        }
    }

    #[test]
    fn any_triangles_give_the_same_picture_on_any_number_of_threads(
        corners in proptest::collection::vec((point(), point(), point()), 1..60), heading in 0.0..6.2f64, seed: u64,
    ) {
        let meshes: Vec<Mesh> = corners.iter().enumerate()
            .map(|(i, &(a, b, c))| mesh(1 + i as u32, vec![a, b, c], vec![[0, 1, 2]])).collect();
        let elevation = (seed % 100) as f64 / 100.0 - 0.5;
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| draw(meshes.clone(), &camera(heading, elevation)))
        };
        let one = on(1);
        prop_assert_eq!(&one, &on(3));
        prop_assert!(one.depth_m.iter().all(|d| *d > 0.0));
    }
}
