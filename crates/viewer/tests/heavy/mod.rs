//! A scene whose picture takes minutes.

/// Mirrors and glass among each other under two lamps of many points: every ray sends two more, many times.
pub fn text() -> String {
    let mut text = "#camera 0 0 14 0 0 -1 0 1 0 .5 #background .3 .4 .5
        #light_area .6 .6 .6 4 9 6 -.4 -1 -.6 2 1 0 0 #light_area .5 .5 .4 -6 8 3 .6 -1 -.3 2 1 0 0
        #material .1 .1 .1 .4 .4 .4 .5 .5 .5 0 0 0 .9 .9 1.5 -1 !glass!"
        .to_owned();
    for (x, y) in (-9..9).flat_map(|x| (-7..7).map(move |y| (x, y))) {
        text += &format!("\n#shape_sphere 0 {} {} {} .49", x, y, (x * x + 3 * y) % 4);
    }
    text
}
