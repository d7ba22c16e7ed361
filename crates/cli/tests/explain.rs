//! `dotray explain`: what it tells is what was rendered.

mod common;

use common::Folder;
use common::root;
use dotray::image::Limits;
use dotray::image::decode;
use serde_json::Value;

/// All shapes of a small world: a mirror, glass, a blocker, three kinds of lights.
const ALL: &str = "\
#camera 0 0 4 0 0 -1 0 1 0 .5
#background .1 .2 .3
#ambient .2 .2 .2
#light_point 1 1 1 0 4 0 1 0 0
#light_area .5 .5 .5 3 4 5 -3 -4 -5 .5 1 0 0
#light_dir .2 .2 .2 0 0 -1
#material .2 .1 0 .7 .6 .1 .5 .5 .5 0 0 0 .5 0 1 -1 !!
#material .1 .1 .1 .1 .1 .1 .9 .9 .9 0 0 0 .2 .8 1.4 -1 !!
#group_begin 1 0 0 0 0 1 0 -1 0 0 1 0 0 0 0 1
  #group_begin 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1
    #shape_box 0 0 0 0 6 .2 6
  #group_end
#group_end
#shape_sphere 1 -.6 0 1 .5
#shape_sphere 0 0 1.5 0 .7
";

fn explained(folder: &Folder, arguments: &str) -> Value {
    let ended = folder.run(&format!("explain {arguments} --format json")).expect(0);
    serde_json::from_slice(&ended.stdout).expect("one JSON object")
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("a list").iter().map(|x| x.as_f64().expect("a number")).collect()
}

/// Adds up what the terms of a ray add; true to rounding only, as the order of the sum is the renderer's own.
fn check_sum(rays: &[Value], ray: &Value) {
    let hit = &ray["hit"];
    if hit.is_null() {
        return;
    }
    let mut sum = numbers(&hit["own_light"]);
    let mut add = |color: &Value| sum.iter_mut().zip(numbers(color)).for_each(|(sum, x)| *sum += x);
    hit["lights"].as_array().expect("lights").iter().for_each(|light| add(&light["adds"]));
    for branch in ["reflected", "refracted"] {
        if let Some(child) = hit[branch]["ray"].as_u64() {
            add(&hit[branch]["adds"]);
            assert_eq!(rays[child as usize]["parent"], ray["id"]);
            assert_eq!(rays[child as usize]["kind"], branch);
        } else {
            assert!(hit[branch]["ended"].is_string(), "{hit}");
        }
    }
    let expected = numbers(&ray["color"]);
    assert!(sum.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-9), "{sum:?} {expected:?}");
    assert_eq!(hit["sum"], ray["color"]);
}

#[test]
fn every_pixel_is_the_sum_of_its_terms() {
    let folder = Folder::new();
    folder.put("all.ray", ALL.as_bytes());
    folder.run("render all.ray all.pfm --size 12x9 --light-samples 3").expect(0);
    let picture = decode(&folder.get("all.pfm"), None, &Limits::default()).expect("a picture");
    let mut seen = std::collections::BTreeMap::<String, u32>::new();
    for (x, y) in (0..9).flat_map(|y| (0..12).map(move |x| (x, y))) {
        let told = explained(&folder, &format!("all.ray {x} {y} --size 12x9 --light-samples 3"));
        assert_eq!(told["checks"], serde_json::json!({ "sums": true, "pixel": true }));
        let stored = picture.pixel(x, y).expect("in the picture");
        let color: Vec<f32> = numbers(&told["color"]).iter().map(|&x| x as f32).collect();
        assert_eq!(color, stored[..3], "pixel {x} {y}");
        let rays = told["rays"].as_array().expect("rays");
        for ray in rays {
            check_sum(rays, ray);
            for light in ray["hit"]["lights"].as_array().into_iter().flatten() {
                let result = light["shadow"]["result"].as_str().expect("a word");
                *seen.entry(result.to_owned()).or_default() += 1;
            }
        }
    }
    // The scene has all that can stand between a point and a light.
    for result in ["not-asked", "free", "blocked", "filtered"] {
        assert!(seen.get(result).is_some_and(|&count| count > 5), "{seen:?}");
    }
}

#[test]
fn shapes_are_named_with_their_lines_and_groups() {
    let folder = Folder::new();
    folder.put("all.ray", ALL.as_bytes());
    let told = explained(&folder, "all.ray 50 70 --size 100x80");
    let shape = &told["rays"][0]["hit"]["shape"];
    assert_eq!((&shape["kind"], &shape["place"]), (&"box".into(), &"all.ray:11:5".into()));
    assert_eq!(shape["groups"], serde_json::json!(["group all.ray:9:1", "group all.ray:10:3"]));
    assert_eq!(told["rays"][0]["hit"]["material"]["place"], "all.ray:7:1");
    assert_eq!(told["rays"][0]["hit"]["lights"][0]["place"], "all.ray:4:1");
    // Under the ball the point light is blocked by it.
    let text = folder.run("explain all.ray 50 61 --size 100x80").expect(0).text();
    assert!(text.contains("blocked by sphere 2 all.ray:15:1"), "{text}");
    assert!(text.contains("agree bit for bit") && text.contains("the same bit for bit"), "{text}");
    assert!(!text.contains('\x1b'));
    let coloured = folder.run("explain all.ray 50 61 --size 100x80 --color always").expect(0).text();
    assert!(coloured.contains("\x1b[31mblocked by"), "{coloured}");
}

#[test]
fn branches_say_why_they_end() {
    let folder = Folder::new();
    folder.put("all.ray", ALL.as_bytes());
    // Into the glass ball.
    let at = "all.ray 36 40 --size 100x80";
    let ended = |more: &str, branch: &str| {
        let told = explained(&folder, &format!("{at} {more}"));
        told["rays"][0]["hit"][branch]["ended"].as_str().unwrap_or("traced").to_owned()
    };
    assert_eq!(ended("", "refracted"), "traced");
    assert_eq!(ended("--recursion 0", "refracted"), "limit");
    assert_eq!(ended("--cutoff 0.5", "reflected"), "threshold");
    let told = explained(&folder, "all.ray 50 70 --size 100x80");
    assert_eq!(told["rays"][0]["hit"]["refracted"]["ended"], "no-weight");
}

#[test]
fn samples_make_the_pixel() {
    let folder = Folder::new();
    folder.put("all.ray", ALL.as_bytes());
    for (aa, least) in [("--aa grid=3", 9), ("--aa adaptive --aa-depth 2", 10)] {
        // At the edge of the upper ball.
        let told = explained(&folder, &format!("all.ray 37 13 --size 100x80 {aa} --sample 4"));
        assert_eq!(told["checks"]["pixel"], true, "{aa}");
        let samples = told["samples"].as_array().expect("samples");
        assert!(samples.len() >= least, "{aa}: {}", samples.len());
        let mut mean = [0.0; 3];
        for sample in samples {
            let weight = sample["weight"].as_f64().expect("a weight");
            mean.iter_mut().zip(numbers(&sample["color"])).for_each(|(mean, c)| *mean += weight * c);
        }
        let pixel = numbers(&told["color"]);
        assert!(mean.iter().zip(&pixel).all(|(a, b)| (a - b).abs() < 1e-12), "{mean:?} {pixel:?}");
        assert_eq!(told["rays"][0]["color"], samples[4]["color"]);
    }
    folder.run("explain all.ray 29 40 --size 100x80 --sample 1").expect(2).says("there is no sample 1");
}

#[test]
fn all_accelerators_agree_and_other_forms_are_well_formed() {
    let folder = Folder::new();
    let told = explained(&folder, "balls.ray 20 15 --size 40x30 --visits");
    let visits = told["visits"].as_array().expect("visits");
    assert_eq!(visits.len(), 5);
    assert!(visits.iter().all(|visit| visit["same_color"] == true));
    assert!(visits.iter().all(|visit| visit["all"]["shapes"].as_u64() > Some(0)), "{visits:?}");
    let svg = folder.run("explain balls.ray 20 15 --size 40x30 --format svg").expect(0).text();
    assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n") && svg.contains("ray 0: eye"));
    assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    let dot = folder.run("explain balls.ray 20 15 --size 40x30 --format dot").expect(0).text();
    assert!(dot.starts_with("digraph rays {") && dot.contains("r0 [label=\"ray 0: eye"));
    // A place on the film is the same ray.
    let film = explained(&folder, "balls.ray --film 20.5,14.5 --size 40x30");
    assert_eq!(film["rays"][0]["color"], told["rays"][0]["color"]);
    for (arguments, part) in [
        ("explain balls.ray", "no pixel given"),
        ("explain balls.ray 40 0 --size 40x30", "there is no pixel 40 0"),
        ("explain balls.ray 1", "Y"),
        ("explain balls.ray 1 1 --film 1,1", "cannot be used with"),
    ] {
        folder.run(arguments).expect(2).says(part);
    }
}

#[test]
fn real_scenes_are_explained() {
    let folder = Folder::new();
    for (scene, x, y) in [("slides", 20, 30), ("mirrors", 40, 30), ("glasses", 40, 20), ("lenses", 33, 28)] {
        let path = root().join("scenes").join(scene).with_extension("ray");
        let told = explained(&folder, &format!("{} {x} {y} --size 80x60 --light-samples 4", path.display()));
        assert_eq!(told["checks"]["pixel"], true, "{scene}");
        assert_eq!(told["checks"]["sums"], true, "{scene}");
    }
}
