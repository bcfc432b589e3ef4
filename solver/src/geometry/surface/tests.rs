use super::*;

/// The triangles of a cube of edge 1 m whose faces are divided into 6 × 6 squares, pushed out
/// to a bumpy ball, as a soup: every triangle with three vertices of its own, which differ by
/// `round_off` [m].
fn bumpy_ball(round_off: f64) -> Vec<[Vector3; 3]> {
    const DIVISIONS: i32 = 6;
    let pushed = |p: Vector3| {
        let n = p.normalize();
        n * (1.0 + 0.1 * (3.0 * n.x).sin() * (2.0 * n.y).cos())
    };
    let mut triangles: Vec<[Vector3; 3]> = Vec::new();
    for (axis, side) in (0..3).flat_map(|axis| [(axis, -1.0), (axis, 1.0)]) {
        let place = |i: i32, j: i32| {
            let at = |n: i32| 2.0 * f64::from(n) / f64::from(DIVISIONS) - 1.0;
            let mut p = Vector3::zeros();
            (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (side, side * at(i), at(j));
            pushed(p)
        };
        for (i, j) in (0..DIVISIONS).flat_map(|i| (0..DIVISIONS).map(move |j| (i, j))) {
            let [a, b, c, d] =
                [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| place(i, j));
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    let mut n = 0.0_f64;
    for v in triangles.iter_mut().flatten() {
        n += 1.0;
        *v += round_off * Vector3::new((7.0 * n).sin(), (11.0 * n).sin(), (13.0 * n).sin());
    }
    triangles
}

fn surface(soup: &[[Vector3; 3]]) -> Surface {
    let vertices: Vec<Vector3> = soup.iter().flatten().copied().collect();
    let triangles = (0..soup.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    Surface::new(vertices, triangles).unwrap()
}

#[test]
fn the_order_of_triangles_and_their_corners_changes_no_bit() {
    for round_off in [0.0, 1e-11] {
        let mut soup = bumpy_ball(round_off);
        let expected = surface(&soup);
        for turn in 1..8 {
            let count = soup.len();
            soup.rotate_left(37 * turn % count);
            soup.chunks_mut(turn + 1).for_each(<[_]>::reverse);
            soup.iter_mut().step_by(turn).for_each(|t| t.rotate_left(turn % 3));
            let other = surface(&soup);
            assert!(other.vertices == expected.vertices, "vertices: {round_off} {turn}");
            assert!(other.triangles == expected.triangles, "triangles: {round_off} {turn}");
        }
    }
}

#[test]
fn vertices_of_no_triangle_are_not_part_of_the_body() {
    let soup = bumpy_ball(0.0);
    let mut vertices: Vec<Vector3> = soup.iter().flatten().copied().collect();
    let triangles = (0..soup.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    vertices.push(Vector3::repeat(9.0));
    let stray = Surface::new(vertices, triangles).unwrap();
    assert_eq!(stray.bounds, surface(&soup).bounds);
}
