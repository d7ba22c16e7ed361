//! Random shapes under random invertible matrices: what the renderer's shapes meet is what the slow judge meets.

use crate::judge::Judge;
use crate::judge::V;
use crate::random;
use crate::random::Placement;
use dotray_geometry::Ray;
use dotray_geometry::Vec3;
use dotray_geometry::shape::TriangleRay;
use dotray_render::shapes::Shapes;
use dotray_tests::pictures;
use proptest::collection::vec;
use proptest::strategy::Strategy;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

const T_MIN: f64 = 1e-6;

/// The baked shapes of a scene, in file order.
fn baked(text: String) -> Shapes {
    let scene = pictures::scene_of_text("random.ray", text).unwrap_or_else(|error| panic!("{error}"));
    let resolved = pictures::resolved(scene).unwrap_or_else(|error| panic!("{error}"));
    let numbers: Vec<u32> = (0..resolved.shape_count).collect();
    Shapes::bake(&resolved.runs, resolved.frames, resolved.files, &numbers, None, |_, _| 0)
}

/// Brute force over the shapes as the renderer tests them.
fn nearest(shapes: &Shapes, origin: V, direction: V) -> Option<f64> {
    let ray = Ray::new(Vec3::from_array(origin), Vec3::from_array(direction));
    let triangle_ray = TriangleRay::new(&ray);
    let hits = (0..shapes.len() as u32).filter_map(|position| {
        shapes.crossings(position, &ray, &triangle_ray).first_within(T_MIN, f64::INFINITY)
    });
    hits.map(|hit| hit.t).min_by(f64::total_cmp)
}

/// Rays of a picture from somewhere: unit directions.
fn rays(eye: V) -> Vec<(V, V)> {
    let mut rays = Vec::new();
    for (i, j) in (0..30).flat_map(|j| (0..40).map(move |i| (i, j))) {
        let target = [(f64::from(i) - 19.5) * 0.2, (f64::from(j) - 14.5) * 0.2, 0.3];
        let d = [0, 1, 2].map(|k| target[k] - eye[k]);
        let length = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
        rays.push((eye, d.map(|v| v / length)));
    }
    rays
}

#[test]
fn hits_are_those_of_the_judge() {
    let mut runner = TestRunner::deterministic();
    let (mut count, mut hits) = (0_u32, 0_u32);
    let mut faults = Vec::new();
    for case in 0..150 {
        let groups = vec(random::group(), 1..4).new_tree(&mut runner).expect("groups can be made").current();
        let text = random::text(&groups, Placement::PLAIN);
        let (shapes, judge) = (baked(text.clone()), Judge::new(&groups));
        let eye = [[0.3, 0.6, 9.0], [-7.0, 2.0, 3.0], [0.1, 0.2, 0.15]][case % 3];
        for (origin, direction) in rays(eye) {
            let (expected, actual) =
                (judge.nearest(origin, direction, T_MIN), nearest(&shapes, origin, direction));
            count += 1;
            hits += u32::from(expected.is_some());
            let agree = match (expected, actual) {
                (None, None) => true,
                (Some(a), Some(b)) => (a - b).abs() <= 1e-6 * a.max(1.0),
                (Some(_), None) | (None, Some(_)) => false,
            };
            if !agree {
                faults.push(format!(
                    "{expected:?} but {actual:?} from {origin:?} along {direction:?} in\n{text}"
                ));
            }
        }
    }
    println!("{count} rays, {hits} hits, {} disagreements", faults.len());
    assert!(hits > count / 10, "{hits} hits of {count} rays are too few to tell");
    let allowed = count as usize / 1000;
    assert!(faults.len() <= allowed, "{} of {count} rays disagree, first: {}", faults.len(), faults[0]);
}
