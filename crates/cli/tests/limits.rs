//! Limits: what is refused, the option that allows it, folders that nothing leaves, compressed scenes.

#![cfg(unix)]

mod common;

use common::BALLS;
use common::Folder;
use std::io::Write;
use std::os::unix::fs::symlink;
use std::process::Command;
use std::time::Duration;
use std::time::Instant;

fn packed(program: &str, text: &[u8]) -> Option<Vec<u8>> {
    let mut child = Command::new(program)
        .arg("-c")
        .stdin(std::process::Stdio::piped())
        .stdout(std::process::Stdio::piped())
        .spawn()
        .ok()?;
    let mut input = child.stdin.take()?;
    let text = text.to_vec();
    let writer = std::thread::spawn(move || input.write_all(&text));
    let output = child.wait_with_output().ok()?;
    writer.join().ok()?.ok()?;
    output.status.success().then_some(output.stdout)
}

#[test]
fn packed_scenes_and_includes_are_read_whatever_their_names() {
    let folder = Folder::new();
    let plain = folder.run("info balls.ray --format json").expect(0).text();
    for (program, name) in [("gzip", "balls.ray.gz"), ("zstd", "balls.ray.zst")] {
        let Some(bytes) = packed(program, BALLS.as_bytes()) else {
            println!("skipped, no {program}");
            continue;
        };
        folder.put(name, &bytes);
        folder.put("disguised.ray", &bytes);
        folder.put("part.inc", &packed(program, b"#shape_sphere -1 0 0 0 1\n").unwrap());
        folder.put("whole.ray", format!("{BALLS}#ray_file part.inc\n#ray_file_instance 0\n").as_bytes());
        for scene in [name, "disguised.ray"] {
            let told = folder.run(&format!("info {scene} --format json")).expect(0).text();
            assert_eq!(told.replace(scene, "balls.ray"), plain);
        }
        assert_eq!(folder.run_with_input("check -", &bytes).expect(0).stderr, "");
        folder.run("check whole.ray").expect(0);
        // A few bytes that stand for very many.
        let bomb = packed(program, &b" ".repeat(30 << 20)).unwrap();
        assert!(bomb.len() < 100_000);
        folder.put("bomb.ray", &bomb);
        folder.run("info bomb.ray --max-file-size 20M").expect(1).says("larger than 20971520 bytes");
        folder
            .run_with_input("info - --max-file-size 20M", &bomb)
            .expect(1)
            .says("larger than 20971520 bytes");
        folder.put("bomb.ray", &bytes[..bytes.len() - 5]);
        folder.run("info bomb.ray").expect(1).says("damaged");
    }
}

#[test]
fn a_few_packed_bytes_take_no_more_memory_than_is_allowed() {
    let folder = Folder::new();
    let text = [&b"#shape_sphere -1  0 0 0  1\n"[..], &vec![b' '; 3 << 20]].concat();
    let Some(bytes) = packed("gzip", &text) else { return };
    assert!(bytes.len() < 10_000);
    folder.put("bomb.ray.gz", &bytes);
    folder.run("info bomb.ray.gz --max-memory 2M").expect(1).says("larger than 2097152 bytes");
    folder.run("info bomb.ray.gz --max-memory 2M --max-file-size 4M").expect(0);
    folder.run("info bomb.ray.gz --max-memory 4M").expect(0);
}

#[test]
fn nothing_outside_of_a_folder_is_read() {
    let folder = Folder::new();
    std::fs::create_dir_all(folder.path("in/deep")).unwrap();
    let scene = |name: &str, line: &str| folder.put(name, format!("{BALLS}{line}\n").as_bytes());
    folder.put("part.ray", b"#shape_sphere -1 0 0 0 1\n");
    folder.put("in/part.ray", b"#shape_sphere -1 0 0 0 1\n");
    folder.put("white.ppm", b"P3 1 1 255 255 255 255");
    folder.put("in/white.ppm", b"P3 1 1 255 255 255 255");
    symlink(folder.path("part.ray"), folder.path("in/link.ray")).unwrap();
    symlink(folder.path("in/part.ray"), folder.path("in/deep/inner.ray")).unwrap();
    symlink(folder.path(""), folder.path("in/up")).unwrap();
    for (line, fine) in [
        ("#ray_file part.ray", true),
        ("#ray_file deep/inner.ray", true),
        ("#ray_file ../part.ray", false),
        ("#ray_file link.ray", false),
        ("#ray_file up/part.ray", false),
        ("#ray_file /etc/passwd", false),
        ("#ray_file ../nothing.ray", false),
        ("#texture white.ppm", true),
        ("#texture ../white.ppm", false),
        ("#texture up/white.ppm", false),
    ] {
        scene("in/scene.ray", line);
        for command in ["check", "render --size 8x6 -q -o out.png"] {
            let ended = folder.run(&format!("{command} in/scene.ray --confine in"));
            assert_eq!(
                ended.code,
                Some(i32::from(!fine)),
                "{command} {line}: {}{}",
                ended.text(),
                ended.stderr
            );
            let told = format!("{}{}", ended.text(), ended.stderr);
            assert_eq!(told.contains("lies outside"), !fine, "{line}: {told}");
            // Whether a file outside exists is not told.
            assert!(!told.contains("there is a file"), "{told}");
        }
        let free = folder.run("check in/scene.ray");
        assert_eq!(free.code, Some(i32::from(line.contains("nothing") || line.contains("passwd"))), "{line}");
    }
    folder.run("info balls.ray --confine in").expect(1).says("lies outside");
    folder.run("info in/scene.ray --confine nowhere").expect(2).says("no such folder");
    // Dialects look for includes in the folders above; there, too, nothing is found.
    folder.put("above.inc", b"#shape_sphere -1 0 0 0 1\n");
    folder.put("in/deep/uva.ray", b"#ambient 1 1 1\n#ray_file above.inc\n");
    let free = folder.run("info in/deep/uva.ray --dialect uva");
    let kept = folder.run("info in/deep/uva.ray --dialect uva --confine in").expect(1);
    assert!(
        !free.stderr.contains("was not found") && kept.stderr.contains("was not found"),
        "{}",
        kept.stderr
    );
}

/// Runs a command that must be at its end in no time.
fn quick(folder: &Folder, arguments: &str) -> String {
    let start = Instant::now();
    let ended = folder.run(arguments).expect(1);
    assert!(start.elapsed() < Duration::from_secs(20), "{arguments}");
    format!("{}{}", ended.text(), ended.stderr)
}

#[test]
fn pipes_devices_and_folders_are_no_textures_and_no_includes() {
    let folder = Folder::new();
    let made = Command::new("mkfifo").arg(folder.path("pipe")).status();
    for name in ["/dev/zero", "/dev/tty", "pipe", "."] {
        if name == "pipe" && !made.as_ref().is_ok_and(|status| status.success()) {
            continue;
        }
        for line in [format!("#texture {name}"), format!("#ray_file {name}")] {
            folder.put("scene.ray", format!("{BALLS}{line}\n").as_bytes());
            for command in ["check scene.ray", "render scene.ray --size 8x6 -o out.png"] {
                let told = quick(&folder, command);
                assert!(told.contains("it is no file") || told.contains("it is a folder"), "{line}: {told}");
            }
        }
    }
    quick(&folder, "info /dev/zero --max-file-size 1M");
    assert!(!folder.path("out.png").exists());
}

#[test]
fn memory_is_estimated_before_it_is_taken() {
    let folder = Folder::new();
    // A few lines place a thousand spheres 40 times 40 times: 1.6 million spheres.
    for level in 0..2 {
        let (next, place) = (level + 1, "#ray_file_instance 0\n".repeat(40));
        folder.put(&format!("{level}.ray"), format!("{BALLS}#ray_file {next}.ray\n{place}").as_bytes());
    }
    folder.put("2.ray", "#shape_sphere -1 0 0 0 1\n".repeat(1000).as_bytes());
    let start = Instant::now();
    let refused = folder.run("render 0.ray --max-memory 100M -o out.png").expect(1);
    assert!(start.elapsed() < Duration::from_secs(60));
    let refused = refused.says("would take about").says("shapes ").says("accelerator ").says("picture ");
    refused.says("the limit is 100 MiB (--max-memory allows more)");
    folder.run("explain 0.ray 1 1 --max-memory 100M").expect(1).says("--max-memory");
    folder.run("tree 0.ray --accel bvh --max-memory 100M").expect(1).says("--max-memory");
    folder
        .run("render balls.ray --size 2000x1000 --max-memory 1M -o out.png")
        .expect(1)
        .says("picture 45.8 MiB");
    folder.run("render balls.ray --size 20x10 --max-memory 1M -q -o out.png").expect(0);
    folder.run("render balls.ray --max-memory 4X").expect(2).says("such as");
}

#[test]
fn each_limit_says_what_it_is_and_can_be_raised() {
    let folder = Folder::new();
    folder.put("a.ray", format!("{BALLS}#ray_file b.ray\n").as_bytes());
    folder.put("b.ray", b"#ray_file c.ray\n#ray_file_instance 0\n");
    folder.put("c.ray", b"#shape_sphere -1 0 0 0 1\n");
    for (limit, low, enough, says) in [
        ("--max-includes", "2", "3", "more than 2 files"),
        ("--max-include-depth", "1", "2", "more than 1 deep"),
        ("--max-shapes", "1", "2", "more than 1 shapes"),
        ("--max-nesting", "0", "1", "nested more than 0 deep"),
        ("--max-file-size", "300", "1K", "larger than 300 bytes"),
    ] {
        folder.run(&format!("info a.ray {limit} {low}")).expect(1).says(says).says(limit);
        folder.run(&format!("info a.ray {limit} {enough}")).expect(0);
        let told = folder.run(&format!("check a.ray {limit} {low}")).expect(1).text();
        assert!(told.contains(says), "{told}");
        folder.run(&format!("convert a.ray - {limit} {low}")).expect(1).says(says);
    }
    folder.run("render balls.ray --size 30x20 --max-pixels 599 -o out.png").expect(2).says("--max-pixels");
    folder.put("wide.ppm", b"P1 40 20 0");
    folder.put("scene.ray", format!("{BALLS}#texture wide.ppm\n").as_bytes());
    let ended = folder.run("render scene.ray --size 30x20 --max-pixels 600 -o out.png").expect(1);
    ended.says("at most 600 pixels").says("--max-pixels");
}

/// What the files write out themselves is never refused, but what instances make of it.
#[test]
fn instances_multiply_to_so_many_groups_as_are_allowed() {
    let folder = Folder::new();
    let ten = |name: &str| format!("#ray_file {name}\n{}", "#ray_file_instance 0\n".repeat(10));
    folder.put("a.ray", format!("{BALLS}{}", ten("b.ray")).as_bytes());
    folder.put("b.ray", ten("c.ray").as_bytes());
    folder.put("c.ray", b"#shape_sphere -1 0 0 0 1\n");
    for command in ["info a.ray", "check a.ray", "render a.ray --size 4x3 -o a.png", "convert a.ray -"] {
        let ended = folder.run(&format!("{command} --max-groups 50")).expect(1);
        let told = format!("{}{}", ended.stderr, String::from_utf8_lossy(&ended.stdout));
        assert!(
            told.contains("multiply to more than") && told.contains("--max-groups N"),
            "{command}: {told}"
        );
        folder.run(&format!("{command} --max-groups 200")).expect(0);
        folder.run(command).expect(0);
    }
}

/// Beyond the usual number of pixels, at one pixel's cost.
#[test]
fn a_part_of_a_huge_picture_is_no_huge_picture() {
    let folder = Folder::new();
    folder.run("render balls.ray --size 1000000x1000000 --crop 5,5,8,8 -q -o out.png").expect(0);
    folder.run("render balls.ray --size 20000x20000 -o out.png").expect(2).says("268435456");
    let raised = "render balls.ray --size 20000x20000 --max-pixels 400000000 --max-memory 1G -o out.png";
    folder.run(raised).expect(1).says("picture 8.9 GiB");
}
