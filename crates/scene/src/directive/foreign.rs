//! What other dialects write differently, or besides: data only.

use super::DIRECTIVES;
use super::Directive;
use super::Origin;
use super::Spec;
use super::table::ATTENUATION;
use super::table::CENTER;
use super::table::MATERIAL;
use super::table::POSITION;
use super::table::RGB;
use super::table::angle;
use super::table::form;
use super::table::group;
use super::table::integer;
use super::table::lengths;
use super::table::name;
use super::table::numbers;
use crate::dialect::Dialect;
use crate::directive::ArgumentKind;
use crate::directive::Arguments;
use crate::directive::Form;

/// The directive of this very word in a dialect.
#[inline]
pub fn find_in(dialect: Dialect, word: &[u8]) -> Option<&'static Spec> {
    if dialect == Dialect::Slides {
        return super::find(word);
    }
    words_of(dialect).find(|spec| spec.word.as_bytes() == word)
}

/// The directive of this word in any letter case and any dialect.
pub fn find_in_any_dialect(word: &[u8]) -> Option<&'static Spec> {
    let mut all = Dialect::ALL.into_iter().flat_map(words_of);
    all.find(|spec| spec.word.as_bytes().eq_ignore_ascii_case(word))
}

/// The directives of a dialect: those of its own before those that it shares with the slides.
pub fn words_of(dialect: Dialect) -> impl Iterator<Item = &'static Spec> {
    let own: &[Spec] = match dialect {
        Dialect::Slides => &[],
        Dialect::Uva => &UVA,
        Dialect::Jhu => &JHU,
        Dialect::Hmc => &HMC,
        Dialect::Unisa => &UNISA,
    };
    let shared_by_all = [Directive::Background, Directive::Ambient, Directive::GroupEnd];
    let shares = move |spec: &&Spec| match dialect {
        Dialect::Slides => true,
        Dialect::Uva | Dialect::Jhu | Dialect::Unisa => spec.directive != Directive::ShapeSide,
        Dialect::Hmc => shared_by_all.contains(&spec.directive),
    };
    own.iter().chain(DIRECTIVES.iter().filter(shares))
}

const fn spec(
    directive: Directive,
    word: &'static str,
    meaning: &'static str,
    forms: &'static [Form],
) -> Spec {
    Spec { directive, word, meaning, origin: Origin::LaterCourses, forms }
}

const DIRECTION: Arguments = numbers(&["dx", "dy", "dz"], "direction, of any length but 0");
const AMBIENT: Arguments = numbers(&["ar", "ag", "ab"], "ambient colour");
const DIFFUSE: Arguments = numbers(&["dr", "dg", "db"], "diffuse colour");
const SPECULAR: Arguments = numbers(&["sr", "sg", "sb"], "specular colour");
const EMISSIVE: Arguments = numbers(&["er", "eg", "eb"], "emissive colour");
const EYE: Arguments = lengths(&["px", "py", "pz"], "the eye");
const VIEW: Arguments = numbers(&["dx", "dy", "dz"], "view direction, of any length but 0");
const UP: Arguments =
    numbers(&["ux", "uy", "uz"], "up, of any length but 0 and not along the view direction");
const DEGREES: Arguments = group(ArgumentKind::Number, &["ha"], "degrees", "half of the vertical view angle");
const RADIANS: Arguments = angle(&["a"], "vertical view angle, between 0 and π");
const MATRIX: Arguments = numbers(
    &[
        "m11", "m12", "m13", "m14", "m21", "m22", "m23", "m24", "m31", "m32", "m33", "m34", "m41", "m42",
        "m43", "m44",
    ],
    "the matrix row by row",
);
const COLUMNS: Arguments = numbers(
    &[
        "m11", "m21", "m31", "m41", "m12", "m22", "m32", "m42", "m13", "m23", "m33", "m43", "m14", "m24",
        "m34", "m44",
    ],
    "the matrix column by column",
);
const CUTOFF: Arguments = angle(&["sc"], "cut-off angle between axis and edge");
const CUTOFF_DEGREES: Arguments =
    group(ArgumentKind::Number, &["sc"], "degrees", "cut-off angle between axis and edge");
const DROPOFF: Arguments = numbers(&["sd"], "drop-off rate");
const TEXT: Arguments = group(ArgumentKind::Text, &["string"], "", "free text");
const CORNERS: Arguments = integer(&["i", "j", "k"], "numbers of three vertices of the same file, from 0");

const MATERIAL_17: &[Form] = &[form(
    &[
        EMISSIVE,
        AMBIENT,
        DIFFUSE,
        SPECULAR,
        numbers(&["sfo"], "exponent of the highlight"),
        numbers(&["tr", "tg", "tb"], "transparency, by colour"),
        numbers(&["ir"], "index of refraction, above 0 where light passes"),
        integer(&["tn"], "number of the texture, from 0; -1 is none"),
        TEXT,
    ],
    "#material 0 0 0  .2 0 0  1 0 0  1 1 1 128  0 0 0 1 -1 !!",
)];
const KEY_FILE: &[Form] = &[form(&[name(&["filename"], "name of the file")], "#key_file walk.key")];
const CAMERA_FULL: &[Form] = &[form(&[EYE, VIEW, UP, RADIANS], "#camera 0 0 4  0 0 -1  0 1 0  1.05")];
const SURFACE: &str = "A surface that shapes may name by its number.";
const EYES: &str = "The eye and where it looks.";

/// `uva`
static UVA: [Spec; 5] = [
    spec(Directive::Camera, "#camera", EYES, CAMERA_FULL),
    spec(Directive::Material, "#material", SURFACE, MATERIAL_17),
    spec(
        Directive::JointBegin,
        "#joint_begin",
        "Opens a joint; it is read as a group at its rest pose.",
        &[
            form(&[name(&["joint"], "name of the joint")], "#joint_begin elbow"),
            form(
                &[name(&["joint"], "name of the joint"), MATRIX],
                "#joint_begin elbow  1 0 0 0  0 1 0 0  0 0 1 0  0 0 0 1",
            ),
        ],
    ),
    spec(Directive::JointEnd, "#joint_end", "Closes the joint opened last.", &[form(&[], "#joint_end")]),
    spec(Directive::KeyFile, "#key_file", "Key frames; they are not read.", KEY_FILE),
];

/// `jhu`
static JHU: [Spec; 14] = [
    spec(Directive::Camera, "#camera", EYES, CAMERA_FULL),
    spec(Directive::Material, "#material", SURFACE, MATERIAL_17),
    spec(
        Directive::LightPoint,
        "#light_point",
        "A lamp that shines to all sides.",
        &[
            form(
                &[AMBIENT, DIFFUSE, SPECULAR, POSITION, ATTENUATION],
                "#light_point .1 .1 .1  1 1 1  1 1 1  0 5 0  1 0 0",
            ),
            form(&[RGB, POSITION, ATTENUATION], "#light_point 1 1 1  0 5 0  1 0 0"),
        ],
    ),
    spec(
        Directive::LightSpot,
        "#light_spot",
        "A lamp that shines into a cone.",
        &[
            form(
                &[AMBIENT, DIFFUSE, SPECULAR, POSITION, DIRECTION, ATTENUATION, CUTOFF, DROPOFF],
                "#light_spot .1 .1 .1  1 1 1  1 1 1  0 5 0  0 -1 0  1 0 0  .5 1",
            ),
            form(
                &[RGB, POSITION, DIRECTION, ATTENUATION, CUTOFF, DROPOFF],
                "#light_spot 1 1 1  0 5 0  0 -1 0  1 0 0  .5 1",
            ),
        ],
    ),
    spec(
        Directive::LightDir,
        "#light_dir",
        "Parallel light.",
        &[
            form(&[AMBIENT, DIFFUSE, SPECULAR, DIRECTION], "#light_dir .1 .1 .1  1 1 1  1 1 1  0 -1 0"),
            form(&[RGB, DIRECTION], "#light_dir 1 1 1  0 -1 0"),
        ],
    ),
    spec(
        Directive::StaticAffine,
        "#static_affine",
        "Transforms the one shape that follows.",
        &[form(&[COLUMNS], "#static_affine 1 0 0 0  0 1 0 0  0 0 1 0  0 2 0 1")],
    ),
    spec(
        Directive::StaticAffine,
        "#dynamic_affine",
        "Moves the one shape that follows by key frames; it stays where it is.",
        &[form(&[name(&["parameter"], "name of the motion")], "#dynamic_affine swing")],
    ),
    spec(Directive::KeyFile, "#key_file", "Key frames; they are not read.", KEY_FILE),
    spec(
        Directive::Shader,
        "#shader",
        "Programs for a graphics card; they are not used.",
        &[form(&[name(&["vertex", "fragment"], "names of the programs' files")], "#shader a.vp b.fp")],
    ),
    spec(
        Directive::ListBegin,
        "#shape_list_begin",
        "Opens a list of shapes that counts as one.",
        &[form(&[], "#shape_list_begin")],
    ),
    spec(
        Directive::ListEnd,
        "#shape_list_end",
        "Closes the list opened last.",
        &[form(&[], "#shape_list_end")],
    ),
    spec(
        Directive::Triangles,
        "#shape_triangles",
        "The material of the triangles in the list that follows.",
        &[form(&[MATERIAL], "#shape_triangles 0")],
    ),
    spec(
        Directive::ShapeTriangle,
        "#shape_triangle",
        "A triangle of three shared vertices.",
        &[form(&[CORNERS], "#shape_triangle 0 1 2"), form(&[MATERIAL, CORNERS], "#shape_triangle 0  0 1 2")],
    ),
    spec(
        Directive::ShapeTorus,
        "#shape_torus",
        "A torus about y.",
        &[form(
            &[
                MATERIAL,
                CENTER,
                lengths(&["inner"], "radius of the tube"),
                lengths(&["outer"], "radius of the circle in its middle"),
            ],
            "#shape_torus 0  0 0 0  .2 1",
        )],
    ),
];

const ROUND: &[Form] = &[form(
    &[
        lengths(&["px", "py", "pz"], "the point where it begins"),
        lengths(&["r"], "radius"),
        lengths(&["h"], "height, along z"),
    ],
    "#cylinder -m red -c --  0 0 0  1 2",
)];
const POINTS: Arguments =
    lengths(&["v1x", "v1y", "v1z", "v2x", "v2y", "v2z", "v3x", "v3y", "v3z"], "the three points");

/// `hmc`
static HMC: [Spec; 17] = [
    spec(
        Directive::Camera,
        "#camera",
        EYES,
        &[form(&[EYE, VIEW, UP, DEGREES], "#camera 0 0 4  0 0 -1  0 1 0  30")],
    ),
    spec(
        Directive::LightPoint,
        "#light_point",
        "A lamp that shines to all sides.",
        &[form(&[RGB, POSITION, ATTENUATION], "#light_point -n lamp --  1 1 1  0 5 0  1 0 0")],
    ),
    spec(
        Directive::LightSpot,
        "#light_spot",
        "A lamp that shines into a cone.",
        &[form(
            &[RGB, POSITION, DIRECTION, ATTENUATION, CUTOFF_DEGREES, DROPOFF],
            "#light_spot -n lamp --  1 1 1  0 5 0  0 -1 0  1 0 0  30 .5",
        )],
    ),
    spec(
        Directive::LightDir,
        "#light_dir",
        "Parallel light.",
        &[form(&[RGB, DIRECTION], "#light_dir -n sun --  1 1 1  0 -1 0")],
    ),
    spec(
        Directive::Material,
        "#material",
        "A surface that shapes may name.",
        &[form(
            &[
                AMBIENT,
                DIFFUSE,
                SPECULAR,
                EMISSIVE,
                numbers(&["ks"], "the highlight's exponent is 128 ks"),
                numbers(&["kt"], "transmission coefficient"),
                numbers(&["ir"], "index of refraction, above 0 where kt is"),
            ],
            "#material -n red --  .2 0 0  1 0 0  1 1 1  0 0 0  .6 0 1.4",
        )],
    ),
    spec(
        Directive::ShapeSphere,
        "#sphere",
        "A sphere.",
        &[form(&[CENTER, lengths(&["r"], "radius")], "#sphere -m red --  0 0 0  1")],
    ),
    spec(
        Directive::ShapeBox,
        "#box",
        "A box along the axes.",
        &[form(
            &[CENTER, lengths(&["lx", "ly", "lz"], "full lengths of the edges")],
            "#box -m red --  0 0 0  1 1 1",
        )],
    ),
    spec(Directive::ShapeCylinder, "#cylinder", "A cylinder along z, open without `-c`.", ROUND),
    spec(Directive::ShapeCone, "#cone", "A cone along z, open without `-c`.", ROUND),
    spec(
        Directive::ShapeTriangle,
        "#triangle",
        "A triangle.",
        &[
            form(&[POINTS], "#triangle -m red --  0 0 0  1 0 0  0 1 0"),
            form(
                &[
                    POINTS,
                    numbers(&["t1s", "t1t", "t2s", "t2t", "t3s", "t3t"], "texture coordinates of the points"),
                ],
                "#triangle -m red -t --  0 0 0  1 0 0  0 1 0  0 0  1 0  0 1",
            ),
        ],
    ),
    spec(
        Directive::ShapeTorus,
        "#torus",
        "A torus about z.",
        &[form(
            &[
                CENTER,
                lengths(&["major"], "radius of the circle in the middle of the tube"),
                lengths(&["minor"], "radius of the tube"),
            ],
            "#torus -m red --  0 0 0  2 .5",
        )],
    ),
    spec(
        Directive::GroupBegin,
        "#group_begin",
        "Opens a group.",
        &[
            form(&[], "#group_begin -n arm --"),
            form(&[MATRIX], "#group_begin -n arm --  1 0 0 0  0 1 0 0  0 0 1 0  0 0 0 1"),
        ],
    ),
    spec(
        Directive::Translate,
        "#translate",
        "Moves the group around.",
        &[form(&[numbers(&["x", "y", "z"], "by how much")], "#translate 0 0 -10")],
    ),
    spec(
        Directive::Rotate,
        "#rotate",
        "Turns the group around.",
        &[form(
            &[
                group(ArgumentKind::Number, &["angle"], "degrees", "by how much"),
                numbers(&["x", "y", "z"], "the axis, of any length but 0"),
            ],
            "#rotate 45  0 0 1",
        )],
    ),
    spec(
        Directive::Scale,
        "#scale",
        "Scales the group around.",
        &[form(&[numbers(&["x", "y", "z"], "by how much along each axis")], "#scale 1 2 1")],
    ),
    spec(
        Directive::Version,
        "#version",
        "Says which course the file is for.",
        &[form(&[name(&["version"], "the course's name")], "#version HMCCS155FALL2005")],
    ),
    spec(Directive::RayfileEnd, "#rayfile_end", "Ends the file.", &[form(&[], "#rayfile_end")]),
];

/// `unisa`
static UNISA: [Spec; 4] = [
    spec(
        Directive::Camera,
        "#camera",
        EYES,
        &[form(&[EYE, VIEW, UP, DEGREES], "#camera 0 0 4  0 0 -1  0 1 0  30")],
    ),
    spec(
        Directive::LightSpot,
        "#light_spot",
        "A lamp that shines into a cone.",
        &[form(
            &[RGB, POSITION, DIRECTION, ATTENUATION, CUTOFF_DEGREES, DROPOFF],
            "#light_spot 1 1 1  0 5 0  0 -1 0  1 0 0  30 .5",
        )],
    ),
    spec(
        Directive::Shader,
        "#shader",
        "Programs for a graphics card; only that of the name VertexColour counts: colours of vertices show.",
        &[form(
            &[name(&["vertex", "fragment"], "names of the programs' files")],
            "#shader \"a.vert\" \"a.frag\"",
        )],
    ),
    spec(
        Directive::Vertex,
        "#vertex",
        "A vertex that triangles may share.",
        &[
            form(
                &[
                    lengths(&["px", "py", "pz"], "point"),
                    numbers(&["nx", "ny", "nz"], "normal; 0 0 0 is the face's own normal"),
                    numbers(&["ts", "tt"], "texture coordinates"),
                    numbers(
                        &["r", "g", "b"],
                        "colour; under the shader VertexColour it shows in place of the material's",
                    ),
                ],
                "#vertex 0 -1 0  0 0 1  .5 0  1 1 1",
            ),
            form(
                &[
                    lengths(&["px", "py", "pz"], "point"),
                    numbers(&["nx", "ny", "nz"], "normal; 0 0 0 is the face's own normal"),
                    numbers(&["ts", "tt"], "texture coordinates"),
                ],
                "#vertex 0 -1 0  0 0 1  .5 0",
            ),
        ],
    ),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::directive::MAX_ARGUMENTS;

    #[test]
    fn every_word_of_every_dialect_is_found_and_its_counts_are_those_of_its_names() {
        for dialect in Dialect::ALL {
            for spec in words_of(dialect) {
                assert!(find_in(dialect, spec.word.as_bytes()).is_some(), "{dialect}: {}", spec.word);
                for form in spec.forms {
                    assert_eq!(form.count, form.each().count(), "{dialect}: {}", spec.word);
                    assert!(form.count <= MAX_ARGUMENTS);
                }
            }
        }
        assert!(find_in(Dialect::Hmc, b"#shape_sphere").is_none());
        assert_eq!(find_in(Dialect::Uva, b"#material").map(|spec| spec.forms[0].count), Some(19));
        assert!(find_in_any_dialect(b"#Static_Affine").is_some());
    }
}
