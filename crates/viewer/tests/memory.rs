//! How much memory a scene takes once it can be traced. A program of its own: nothing else runs beside it.

use rayview::bundle::Bundle;
use rayview::clerk::Clerk;
use rayview::wire::Ask;
use rayview::wire::Tell;
use std::fmt::Write;

/// The memory of this process that is in use; `None` on systems that do not tell.
fn resident() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    line.trim().trim_end_matches(" kB").parse::<u64>().ok().map(|kilobytes| kilobytes << 10)
}

/// The renderer needs about 88 bytes a sphere. The scene's own list beside it would be 38 more.
#[test]
fn a_tracer_keeps_the_shapes_once() {
    const COUNT: u32 = 2_000_000;
    let Some(before) = resident() else { return println!("skipped, the system tells nothing") };
    let mut text = "#camera 0 0 3 0 0 -1 0 1 0 .5 #light_dir 1 1 1 0 0 -1\n".to_owned();
    for k in 0..COUNT {
        let [x, y, z] =
            [7, 11, 13].map(|prime: u32| f64::from(k.wrapping_mul(prime * 2_654_435) >> 12) / 1e6);
        writeln!(text, "#shape_sphere -1 {x} {y} {z} .001").expect("text");
    }
    let files = vec![("many.ray".to_owned(), text.into_bytes())];
    let mut clerk = Clerk::default();
    let open = Ask::Open { number: 1, path: "many.ray".into(), accel: "bvh".into(), files };
    let told = clerk.handle(open, &Bundle::default());
    assert!(matches!(told.as_slice(), [Tell::Prepared(1, _)]), "{told:?}");
    let taken = resident().unwrap_or_default().saturating_sub(before) / u64::from(COUNT);
    println!("{taken} bytes a sphere");
    assert!(taken < 105, "{taken} bytes a sphere");
}
