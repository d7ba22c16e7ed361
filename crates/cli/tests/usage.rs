//! Wrong command lines, help, and the documents made from the table.

mod common;

use common::Folder;
use common::root;

#[test]
fn wrong_command_lines_end_with_2_and_say_why() {
    let folder = Folder::new();
    let before = folder.names();
    let cases = [
        ("", "Usage"),
        ("render", "no scene given"),
        ("rendre balls.ray", "render"),
        ("balls.ray a.png", "did you mean `dotray render balls.ray a.png`?"),
        ("--in balls.ray --out a.png", "did you mean `dotray render --in balls.ray --out a.png`?"),
        ("render balls.ray a.png --widht 3", "--width"),
        ("render balls.ray a.pgn", "did you mean `.png`?"),
        ("render balls.ray a", "no extension"),
        ("render balls.ray a.png 0 10", "width is 0"),
        ("render balls.ray a.png 10 -1", "-1"),
        ("render balls.ray a.png 10 x", "'x'"),
        (
            "render balls.ray a.png 10 10 -o b.png",
            "the picture is given twice: `a.png` in its place and `--output b.png`",
        ),
        ("render balls.ray a.png 10 10 --height 4", "the height is given twice"),
        ("render balls.ray a.png --width 3 --width 4", "--width"),
        ("render balls.ray a.png --size 10", "800x600"),
        ("render balls.ray a.png --crop 1,2,3", "x,y,width,height"),
        ("render balls.ray a.png --aa grid", "grid=N"),
        ("render balls.ray a.png --aa-depth 2", "--aa adaptive"),
        ("render balls.ray a.png --aa adaptive --aa-depth 11", "0 to 10"),
        ("render balls.ray a.png --accel kd", "bvh"),
        ("render balls.ray a.png --threads 0", "1..=1024"),
        ("render balls.ray a.png --tile-size 7", "8 to 1024"),
        ("render balls.ray a.png --depth 12", "16"),
        ("render balls.ray a.bmp --depth 16", "PNG only"),
        ("render balls.ray a.jpg --jpeg-quality 0", "1..=100"),
        ("render balls.ray a.png --cutoff nan", "finite"),
        ("render balls.ray a.png --max-pixels 100", "the limit is 100"),
        ("render balls.ray a.png --recursion 1001", "0 to 1000"),
        ("dump", "SCENE"),
        ("info balls.ray --format xml", "json"),
        ("man nothing", "render"),
        ("completions tcsh", "bash"),
    ];
    for (arguments, part) in cases {
        let ended = folder.run(arguments);
        assert_eq!(ended.code, Some(2), "`{arguments}`: {}", ended.stderr);
        assert!(ended.stderr.contains(part), "`{arguments}` does not say `{part}`: {}", ended.stderr);
        assert!(ended.stdout.is_empty(), "`{arguments}`");
    }
    assert_eq!(folder.names(), before);
}

#[test]
fn help_is_for_newcomers() {
    let folder = Folder::new();
    let help = folder.run("--help").expect(0).text();
    for part in ["render", "dump", "info", "man", "completions", "Examples:", "Exit codes:"] {
        assert!(help.contains(part), "no {part} in: {help}");
    }
    let help = folder.run("render --help").expect(0).text();
    let headings =
        ["Arguments:", "Files:", "Picture:", "Light:", "Speed and limits:", "Messages:", "Examples:"];
    for part in headings.into_iter().chain(["[default: 640]", "[default: bvh]", "--rLimit", "800 600 7 0.01"])
    {
        assert!(help.contains(part), "no {part} in: {help}");
    }
    assert!(help.lines().all(|line| line.chars().count() <= 100));
    assert_eq!(folder.run("help render").expect(0).text(), help);
    assert_eq!(folder.run("--version").expect(0).text(), format!("dotray {}\n", env!("CARGO_PKG_VERSION")));
}

#[test]
fn manual_pages_and_completions_name_every_command() {
    let folder = Folder::new();
    let page = folder.run("man").expect(0).text();
    assert!(page.contains(".TH") && page.contains("completions"), "{page}");
    for command in ["render", "dump", "info", "compare", "grade", "lsp", "man", "completions"] {
        let page = folder.run(&format!("man {command}")).expect(0).text();
        assert!(page.contains(".TH") && page.contains(&format!("dotray\\-{command}")), "{page}");
    }
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = folder.run(&format!("completions {shell}")).expect(0).text();
        for word in ["render", "texture-filter", "jpeg-quality"] {
            assert!(script.contains(word), "{shell}: no {word}");
        }
    }
}

#[test]
fn the_reference_is_up_to_date() {
    let path = root().join("docs/cli.md");
    let made = Folder::new().run("man --markdown").expect(0).text();
    if std::env::var_os("UPDATE").is_some() {
        std::fs::write(&path, &made).expect("docs/cli.md can be written");
    }
    let committed = std::fs::read_to_string(&path).unwrap_or_default().replace("\r\n", "\n");
    assert!(made == committed, "docs/cli.md is out of date: run `UPDATE=1 cargo test -p dotray`");
}
