//! Whatever a file says, looking it over ends: with messages that can be shown, and without a crash.

use dotray_scene::Files;
use dotray_scene::codes::all_codes;
use dotray_scene::context::name_groups;
use dotray_scene::files::Disk;
use dotray_scene::lint::lint;
use dotray_scene::load::LoadOptions;
use dotray_scene::load::load_text;
use dotray_scene::report::render_text;
use dotray_scene::resolve::resolve;
use proptest::collection::vec;
use proptest::prelude::*;
use std::path::Path;

/// Everything that a check does with a text, but for textures.
fn look_over(text: &[u8]) {
    let loaded = load_text("a.ray", text, &Disk, &LoadOptions::default());
    let mut diagnostics = loaded.diagnostics;
    if let Some(outcome) = loaded.scene.map(resolve) {
        diagnostics.extend(outcome.diagnostics);
        diagnostics.extend(outcome.resolved.iter().flat_map(lint));
    }
    name_groups(&mut diagnostics, &loaded.sources);
    let shown = render_text(&diagnostics, &loaded.sources, false);
    let codes = all_codes();
    for diagnostic in &diagnostics {
        assert!(codes.iter().any(|code| code.name == diagnostic.code), "{}", diagnostic.code);
        assert!(shown.contains(diagnostic.code));
    }
}

#[test]
fn cut_and_bent_scenes_are_looked_over() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let text = Disk.read(&folder.join("slides-as-printed.ray")).unwrap();
    for end in 0..text.len() {
        look_over(&text[..end]);
    }
    for at in 0..text.len() {
        let mut bent = text.clone();
        bent[at] ^= 1 << (at % 8);
        look_over(&bent);
    }
}

#[test]
fn a_line_of_a_million_words_is_looked_over() {
    look_over(&format!("#ambient 1 1 1 {}", "1 ".repeat(1_000_000)).into_bytes());
    look_over(
        &format!("#light_dir 1 1 1 0 0 -1 {}", "#shape_sphere -1 0 0 0 1 ".repeat(40_000)).into_bytes(),
    );
    look_over(
        &format!("#group_end {}", "#group_begin 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 ".repeat(60_000))
            .into_bytes(),
    );
}

fn word() -> impl Strategy<Value = String> {
    let directive = proptest::sample::select(dotray_scene::directive::DIRECTIVES.as_slice());
    let example = directive
        .prop_flat_map(|spec| proptest::sample::select(spec.forms))
        .prop_map(|form| form.example.to_owned());
    prop_oneof![
        12 => example,
        2 => Just("#group_end".to_owned()),
        1 => "-?[0-9]{1,3}(e[0-9]{1,3})?",
        1 => "[#!\"/*a-z_ \n]{1,6}",
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_row_of_directives_is_looked_over(words in vec(word(), 0..40), numbers in vec(any::<f64>(), 40)) {
        let mut text = String::new();
        for (word, number) in words.iter().zip(&numbers) {
            // Now and then a number of an example becomes another.
            let odd = word.replacen(" 1 ", &format!(" {number:e} "), usize::from(number.to_bits() % 4 == 0));
            text.push_str(&odd);
            text.push('\n');
        }
        look_over(text.as_bytes());
    }

    #[test]
    fn any_bytes_are_looked_over(bytes in vec(any::<u8>(), 0..300)) {
        look_over(&bytes);
        look_over(&[b"#ambient 1 1 1\n".as_slice(), &bytes].concat());
    }
}
