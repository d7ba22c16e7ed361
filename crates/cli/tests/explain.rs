//! `dotray explain`: what it tells is what was rendered.

mod common;

use common::Folder;
use common::root;
use dotray::geometry::Ray;
use dotray::geometry::Sphere;
use dotray::geometry::Vec3;
use dotray::image::Limits;
use dotray::image::decode;
use dotray::scene::number::General;
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

fn vec3(value: &Value) -> Vec3 {
    Vec3::from_slice(&numbers(value))
}

fn near(a: Vec3, b: Vec3) -> bool {
    (a - b).length() <= 1e-9 * (1.0 + b.length())
}

/// What is told of a ray hangs together: places, directions, depths, weights.
fn check_ray(rays: &[Value], ray: &Value) {
    let (origin, direction) = (vec3(&ray["origin"]), vec3(&ray["direction"]));
    assert!((direction.length() - 1.0).abs() < 1e-9);
    let depth = ray["depth"].as_u64().expect("a depth");
    match ray["parent"].as_u64() {
        None => {
            assert_eq!((depth, vec3(&ray["contribution"])), (0, Vec3::ONE));
            assert!(near(origin, Vec3::new(0.0, 0.0, 4.0)) && ray["kind"] == "eye");
        }
        Some(parent) => {
            let parent = &rays[parent as usize];
            assert_eq!(Some(depth), parent["depth"].as_u64().map(|depth| depth + 1));
            let product = vec3(&parent["contribution"]) * vec3(&ray["weight"]);
            assert!(near(vec3(&ray["contribution"]), product), "{ray:#}");
            assert!(near(origin, vec3(&parent["hit"]["point"])));
            if ray["kind"] == "reflected" {
                assert!(near(direction, vec3(&parent["hit"]["mirrored"])), "{ray:#}");
            }
        }
    }
    if ray["hit"].is_object() {
        check_hit(ray, origin, direction);
    }
}

/// The shape, the point, the normals.
fn check_hit(ray: &Value, origin: Vec3, direction: Vec3) {
    let hit = &ray["hit"];
    let point = vec3(&hit["point"]);
    let t = hit["t"].as_f64().expect("a number");
    assert!(near(origin + direction * t, point), "{hit:#}");
    let entering = hit["entering"].as_bool().expect("yes or no");
    for normal in ["normal", "geometric_normal"] {
        let [before, after] = ["before", "after"].map(|side| vec3(&hit[normal][side]));
        assert!(after.dot(direction) <= 0.0 && (before.dot(direction) <= 0.0) == entering, "{hit:#}");
        assert!(near(before, if entering { after } else { -after }), "{hit:#}");
    }
    let normal = vec3(&hit["normal"]["after"]);
    assert!(near(vec3(&hit["mirrored"]), direction - normal * (2.0 * direction.dot(normal))));
    let object = vec3(&hit["object_point"]);
    let (kind, number) = (hit["shape"]["kind"].as_str(), hit["shape"]["number"].as_u64());
    let sphere = |center: Vec3, radius: f64| {
        assert!((object.distance(center) - radius).abs() < 1e-9 && near(object, point), "{hit:#}");
        let sphere = Sphere::new(center, radius).expect("a sphere");
        let own = Ray::new(object + 9.0 * (object - center), center - object);
        let crossing = sphere.crossings(&own).as_slice()[0];
        let st = sphere.surface(&own, crossing).texcoord.get();
        let told = numbers(&hit["st"]);
        assert!((st.x - told[0]).abs() < 1e-9 && (st.y - told[1]).abs() < 1e-9, "{hit:#}");
        assert!(near(vec3(&hit["geometric_normal"]["before"]), (object - center) / radius), "{hit:#}");
    };
    match (kind, number) {
        // Its groups lower the box by 1.
        (Some("box"), Some(0)) => assert!(entering && near(object - Vec3::Y, point), "{hit:#}"),
        (Some("sphere"), Some(1)) => sphere(Vec3::new(-0.6, 0.0, 1.0), 0.5),
        (Some("sphere"), Some(2)) => sphere(Vec3::new(0.0, 1.5, 0.0), 0.7),
        other => panic!("no shape of the scene is {other:?}"),
    }
    for light in hit["lights"].as_array().expect("lights") {
        check_light(light, point, vec3(&hit["normal"]["after"]));
    }
}

fn check_light(light: &Value, point: Vec3, normal: Vec3) {
    if light["towards"].is_null() {
        return;
    }
    let towards = vec3(&light["towards"]);
    let number = |key: &str| light[key].as_f64().expect("a number");
    assert!((normal.dot(towards) - number("cosine")).abs() < 1e-9);
    let factors = number("spot") * number("attenuation");
    assert!(near(vec3(&light["strength"]), vec3(&light["color"]) * factors), "{light:#}");
    match light["kind"].as_str() {
        Some("point") => {
            let distance = number("distance");
            assert!(near(point + towards * distance, Vec3::new(0.0, 4.0, 0.0)));
            let expected = 1.0 / (0.9 + 0.05 * distance);
            assert!((number("attenuation") - expected).abs() < 1e-12 && number("spot") == 1.0, "{light:#}");
        }
        Some("dir" | "directional") => assert!(near(towards, Vec3::Z) && light["distance"].is_null()),
        Some("area") => {
            let place = point + towards * number("distance");
            assert!(place.distance(Vec3::new(3.0, 4.0, 5.0)) < 0.501, "{light:#}");
        }
        other => panic!("{other:?}"),
    }
    if number("cosine") > 0.0 {
        let sum = (vec3(&light["diffuse"]) + vec3(&light["highlight"])) * vec3(&light["strength"]);
        assert!(near(vec3(&light["unshadowed"]), sum), "{light:#}");
    }
    let added = vec3(&light["unshadowed"]) * vec3(&light["filter"]) / number("samples");
    assert!(near(vec3(&light["adds"]), added), "{light:#}");
    let mut through = Vec3::ONE;
    for crossing in light["shadow"]["through"].as_array().into_iter().flatten() {
        through *= vec3(&crossing["filter"]);
        assert_eq!(crossing["shape"]["number"], 1, "only one ball is of glass");
    }
    match light["shadow"]["result"].as_str() {
        Some("blocked") => {
            assert_eq!(light["filter"], serde_json::json!([0.0, 0.0, 0.0]));
            let by = light["shadow"]["by"]["number"].as_u64();
            assert!(by == Some(0) || by == Some(2), "glass blocks nothing: {light:#}");
        }
        Some("not-asked" | "free" | "filtered") => assert!(near(vec3(&light["filter"]), through)),
        other => panic!("{other:?}"),
    }
}

#[test]
fn what_is_told_hangs_together() {
    let folder = Folder::new();
    let fading = ALL.replace("0 4 0 1 0 0", "0 4 0 .9 .05 0");
    assert!(fading != ALL);
    folder.put("all.ray", fading.as_bytes());
    let mut kinds = std::collections::BTreeMap::<String, u32>::new();
    for (x, y) in (0..9).flat_map(|y| (0..12).map(move |x| (x, y))) {
        let told =
            explained(&folder, &format!("all.ray {x} {y} --size 12x9 --light-samples 4 --recursion 3"));
        let rays = told["rays"].as_array().expect("rays");
        for ray in rays {
            check_ray(rays, ray);
            *kinds.entry(ray["kind"].as_str().expect("a word").to_owned()).or_default() += 1;
            if let Some(entering) = ray["hit"]["entering"].as_bool() {
                *kinds.entry(format!("entering {entering}")).or_default() += 1;
            }
        }
    }
    assert!(kinds.len() == 5 && kinds.values().all(|count| *count > 10), "{kinds:?}");
}

#[test]
fn text_and_drawings_tell_the_same_as_the_data() {
    let folder = Folder::new();
    folder.put("all.ray", ALL.as_bytes());
    // Into the glass ball, and the floor under the other ball.
    for at in ["36 40", "50 61"] {
        let line = format!("all.ray {at} --size 100x80 --light-samples 8");
        let told = explained(&folder, &line);
        let rays = told["rays"].as_array().expect("rays");
        let of = |format: &str| folder.run(&format!("explain {line} --format {format}")).expect(0).text();
        let (text, svg, dot) = (of("text"), of("svg"), of("dot"));
        let count_of = |kind: &str| rays.iter().filter(|ray| ray["kind"] == kind).count();
        for (kind, color) in [("reflected", "#1a8f3c"), ("refracted", "#d9730d"), ("eye", "#1f5fbf")] {
            // A line in each of two views; the legend has one more.
            let lines = svg.matches(&format!("stroke=\"{color}\" stroke-width=\"2\"")).count();
            assert_eq!(lines, 2 * count_of(kind) + 1, "{at}: {kind}");
        }
        let asked = |result: &str| {
            let lights = rays.iter().flat_map(|ray| ray["hit"]["lights"].as_array().into_iter().flatten());
            lights.filter(|light| light["shadow"]["result"] == result).count()
        };
        assert_eq!(svg.matches("stroke=\"#c62828\"").count(), 2 * asked("blocked") + 1, "{at}");
        for (id, ray) in rays.iter().enumerate() {
            let kind = ray["kind"].as_str().expect("a word");
            let contribution =
                numbers(&ray["contribution"]).iter().map(|&x| format!("{}", General(x))).collect::<Vec<_>>();
            let head = format!(
                "ray {id}: {kind}, depth {}, contribution ({})",
                ray["depth"],
                contribution.join(" ")
            );
            assert!(text.contains(&head), "{head}\n{text}");
            if let Some(parent) = ray["parent"].as_u64() {
                assert!(dot.contains(&format!("  r{parent} -> r{id} [")), "{dot}");
            }
            let hit = &ray["hit"];
            if hit.is_null() {
                continue;
            }
            let shape = &hit["shape"];
            let name = [&shape["kind"], &shape["place"]].map(|word| word.as_str().expect("a word"));
            let meets = format!("meets {} {} {}", name[0], shape["number"], name[1]);
            assert!(text.contains(&meets), "{meets}\n{text}");
            assert!(
                dot.contains(&format!("r{id} [label=\"ray {id}: {kind}\\n{} {}", name[0], shape["number"]))
            );
        }
        let leaves = rays.iter().filter(|ray| ray["hit"]["entering"] == false).count();
        assert_eq!(text.matches("leaves: normals are flipped").count(), leaves, "{text}");
        // Edges to lights: dotted where nothing is added.
        let mut dark = 0;
        for hit in rays.iter().map(|ray| &ray["hit"]).filter(|hit| hit.is_object()) {
            let lights = hit["lights"].as_array().expect("lights");
            for light in 0..3_u64 {
                let sum: f64 = lights
                    .iter()
                    .filter(|term| term["light"] == light)
                    .flat_map(|term| numbers(&term["adds"]))
                    .sum();
                dark += usize::from(sum == 0.0);
            }
        }
        let dotted = dot.lines().filter(|line| line.contains("l") && line.contains("[style=dotted]")).count();
        let ended = dot.matches("shape=plaintext").count();
        assert_eq!(dotted, dark + ended, "{dot}");
        // What each light adds, and what stands before the area light.
        let plain: Vec<&Value> =
            rays.iter().flat_map(|ray| ray["hit"]["lights"].as_array().into_iter().flatten()).collect();
        for light in
            plain.iter().filter(|light| light["samples"] == 1 && light["cosine"].as_f64() > Some(0.0))
        {
            let adds: Vec<String> =
                numbers(&light["adds"]).iter().map(|&x| format!("{}", General(x + 0.0))).collect();
            assert!(text.contains(&format!("adds ({})", adds.join(" "))), "{adds:?}\n{text}");
        }
    }
}

/// In the half shadow of a lamp with a size some samples arrive and some do not.
#[test]
fn the_text_counts_what_reaches_the_point() {
    let folder = Folder::new();
    let soft = "#camera 0 3 6  0 -.5 -1  0 1 0  .4  #light_area 1 1 1  0 6 0  0 -1 0  1  1 0 0
        #material 1 1 1  1 1 1  0 0 0  0 0 0  0 0 1 -1 !!  #shape_box 0  0 -.1 0  8 .2 8
        #shape_sphere 0  0 1.2 0  .5";
    folder.put("soft.ray", soft.as_bytes());
    let mut found = 0;
    for x in 0..40 {
        let line = format!("soft.ray {x} 15 --size 40x30 --light-samples 16");
        let told = explained(&folder, &line);
        let lights = told["rays"][0]["hit"]["lights"].as_array().cloned().unwrap_or_default();
        let count = |result: &str| lights.iter().filter(|light| light["shadow"]["result"] == result).count();
        let (free, blocked) = (count("free"), count("blocked"));
        if free > 0 && blocked > 0 {
            let text = folder.run(&format!("explain {line}")).expect(0).text();
            assert!(text.contains(&format!("{free} reach the point, 0 through")), "{text}");
            assert!(text.contains(&format!("{blocked} blocked by sphere 1 soft.ray")), "{text}");
            found += 1;
        }
    }
    assert!(found >= 2, "only {found} pixels in half shadow");
}

#[test]
fn visits_are_the_sums_of_what_rays_cost() {
    let folder = Folder::new();
    folder.put("all.ray", ALL.as_bytes());
    let told = explained(&folder, "all.ray 36 40 --size 100x80 --visits --accel octree");
    let (mut boxes, mut shapes) = (0, 0);
    let mut add = |tests: &Value| {
        boxes += tests["boxes"].as_u64().expect("a count");
        shapes += tests["shapes"].as_u64().expect("a count");
    };
    for ray in told["rays"].as_array().expect("rays") {
        add(&ray["tests"]);
        ray["hit"]["lights"].as_array().into_iter().flatten().for_each(|light| add(&light["tests"]));
    }
    let visits = told["visits"].as_array().expect("visits");
    let octree = visits.iter().find(|visit| visit["accelerator"] == "octree").expect("the octree");
    assert_eq!(octree["all"], serde_json::json!({ "boxes": boxes, "shapes": shapes }));
    assert_eq!(octree["eye"], told["rays"][0]["tests"]);
    assert!(boxes > octree["eye"]["boxes"].as_u64().expect("a count"));
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
