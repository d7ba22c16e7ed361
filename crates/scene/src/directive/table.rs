//! The table itself: data only.

use super::ArgumentKind;
use super::Arguments;
use super::Directive;
use super::Form;
use super::Origin;
use super::Spec;

pub(super) const fn form(arguments: &'static [Arguments], example: &'static str) -> Form {
    let mut count = 0;
    let mut numeric = true;
    let mut group = 0;
    while group < arguments.len() {
        count += arguments[group].names.len();
        numeric &= matches!(arguments[group].kind, ArgumentKind::Number | ArgumentKind::Integer);
        group += 1;
    }
    Form { arguments, count, numeric, example }
}

pub(super) const fn group(
    kind: ArgumentKind,
    names: &'static [&'static str],
    unit: &'static str,
    meaning: &'static str,
) -> Arguments {
    Arguments { names, kind, unit, meaning }
}

pub(super) const fn numbers(names: &'static [&'static str], meaning: &'static str) -> Arguments {
    group(ArgumentKind::Number, names, "", meaning)
}

pub(super) const fn lengths(names: &'static [&'static str], meaning: &'static str) -> Arguments {
    group(ArgumentKind::Number, names, "scene units", meaning)
}

pub(super) const fn angle(names: &'static [&'static str], meaning: &'static str) -> Arguments {
    group(ArgumentKind::Number, names, "radians", meaning)
}

pub(super) const fn integer(names: &'static [&'static str], meaning: &'static str) -> Arguments {
    group(ArgumentKind::Integer, names, "", meaning)
}

pub(super) const fn name(names: &'static [&'static str], meaning: &'static str) -> Arguments {
    group(ArgumentKind::Name, names, "", meaning)
}

pub(super) const RGB: Arguments = numbers(&["r", "g", "b"], "red, green, blue; 1 is full");
pub(super) const POSITION: Arguments = lengths(&["px", "py", "pz"], "where it stands");
pub(super) const CENTER: Arguments = lengths(&["cx", "cy", "cz"], "centre");
pub(super) const ATTENUATION: Arguments =
    numbers(&["ca", "la", "qa"], "constant, linear and quadratic attenuation: 1 / (ca + la d + qa d²)");
pub(super) const MATERIAL: Arguments =
    integer(&["m"], "number of the material, from 0; -1 is the default material");
const COUNT: Arguments = integer(&["n"], "how many follow; only a hint");

/// All directives, in the order of [`Directive`].
pub static DIRECTIVES: [Spec; 25] = [
    Spec {
        directive: Directive::Camera,
        word: "#camera",
        meaning: "The eye and where it looks.",
        origin: Origin::Slides,
        forms: &[form(
            &[
                lengths(&["px", "py", "pz"], "the eye"),
                numbers(&["dx", "dy", "dz"], "view direction, of any length but 0"),
                numbers(&["ux", "uy", "uz"], "up, of any length but 0 and not along the view direction"),
                angle(&["ha"], "half of the vertical view angle, between 0 and π/2"),
            ],
            "#camera 0 0 4  0 0 -1  0 1 0  .523",
        )],
    },
    Spec {
        directive: Directive::Background,
        word: "#background",
        meaning: "The colour of a ray that hits nothing.",
        origin: Origin::Slides,
        forms: &[form(&[RGB], "#background .2 .3 .5")],
    },
    Spec {
        directive: Directive::Ambient,
        word: "#ambient",
        meaning: "The global ambient light.",
        origin: Origin::Slides,
        forms: &[form(&[RGB], "#ambient .1 .1 .1")],
    },
    Spec {
        directive: Directive::LightNum,
        word: "#light_num",
        meaning: "The number of lights.",
        origin: Origin::Slides,
        forms: &[form(&[COUNT], "#light_num 4")],
    },
    Spec {
        directive: Directive::LightPoint,
        word: "#light_point",
        meaning: "A lamp that shines to all sides.",
        origin: Origin::Slides,
        forms: &[form(&[RGB, POSITION, ATTENUATION], "#light_point .8 .8 .8  -10 10 10  1 0 0")],
    },
    Spec {
        directive: Directive::LightSpot,
        word: "#light_spot",
        meaning: "A lamp that shines into a cone.",
        origin: Origin::Slides,
        forms: &[form(
            &[
                RGB,
                POSITION,
                numbers(&["dx", "dy", "dz"], "axis, of any length but 0"),
                ATTENUATION,
                angle(&["sc"], "cut-off angle between axis and edge"),
                numbers(&["sd"], "drop-off rate: the exponent is 128 sd"),
            ],
            "#light_spot 1 1 1  10 10 10  -1 -1 -1  1 0 0  .231 .5",
        )],
    },
    Spec {
        directive: Directive::LightDir,
        word: "#light_dir",
        meaning: "Parallel light, as from the sun; it does not fade.",
        origin: Origin::Slides,
        forms: &[form(
            &[RGB, numbers(&["dx", "dy", "dz"], "where the light travels, of any length but 0")],
            "#light_dir .3 .3 .3  0 -.7 -.7",
        )],
    },
    Spec {
        directive: Directive::LightArea,
        word: "#light_area",
        meaning: "A disc that shines to its front side and casts soft shadows.",
        origin: Origin::Dotray,
        forms: &[form(
            &[
                RGB,
                POSITION,
                numbers(&["dx", "dy", "dz"], "normal of the front side, of any length but 0"),
                lengths(&["radius"], "radius of the disc, above 0"),
                ATTENUATION,
            ],
            "#light_area .8 .8 .8  0 5 0  0 -1 0  .5  1 0 0",
        )],
    },
    Spec {
        directive: Directive::TextureNum,
        word: "#texture_num",
        meaning: "The number of textures.",
        origin: Origin::Slides,
        forms: &[form(&[COUNT], "#texture_num 1")],
    },
    Spec {
        directive: Directive::Texture,
        word: "#texture",
        meaning: "An image that materials may name by its number.",
        origin: Origin::Slides,
        forms: &[form(
            &[name(&["filename"], "relative to the folder of the file; \"quoted\" where it holds blanks")],
            "#texture \"two words.bmp\"",
        )],
    },
    Spec {
        directive: Directive::MaterialNum,
        word: "#material_num",
        meaning: "The number of materials.",
        origin: Origin::Slides,
        forms: &[form(&[COUNT], "#material_num 1")],
    },
    Spec {
        directive: Directive::Material,
        word: "#material",
        meaning: "A surface that shapes may name by its number.",
        origin: Origin::Slides,
        forms: &[form(
            &[
                numbers(&["ar", "ag", "ab"], "ambient colour"),
                numbers(&["dr", "dg", "db"], "diffuse colour"),
                numbers(&["sr", "sg", "sb"], "specular colour"),
                numbers(&["er", "eg", "eb"], "emissive colour"),
                numbers(
                    &["ks"],
                    "specular coefficient: weight of the mirror; the highlight's exponent is 128 ks",
                ),
                numbers(&["kt"], "transmission coefficient"),
                numbers(&["ir"], "index of refraction, above 0 where kt is"),
                integer(&["tn"], "number of the texture, from 0; -1 is none"),
                group(
                    ArgumentKind::Text,
                    &["string"],
                    "",
                    "free text, or 3-D textures and bumps; may be empty",
                ),
            ],
            "#material .2 0 0  1 0 0  1 1 1  0 0 0  .6 0 1.4 -1 !!",
        )],
    },
    Spec {
        directive: Directive::GroupBegin,
        word: "#group_begin",
        meaning: "Opens a group: its matrix acts on all that stands in it.",
        origin: Origin::Slides,
        forms: &[form(
            &[
                numbers(&["m11", "m12", "m13", "m14"], "first row; m14 is the shift along x"),
                numbers(&["m21", "m22", "m23", "m24"], "second row; m24 is the shift along y"),
                numbers(&["m31", "m32", "m33", "m34"], "third row; m34 is the shift along z"),
                numbers(&["m41", "m42", "m43", "m44"], "last row: 0 0 0 1"),
            ],
            "#group_begin 1 0 0 -3  0 1 0 0  0 0 1 0  0 0 0 1",
        )],
    },
    Spec {
        directive: Directive::GroupEnd,
        word: "#group_end",
        meaning: "Closes the group opened last.",
        origin: Origin::Slides,
        forms: &[form(&[], "#group_end")],
    },
    Spec {
        directive: Directive::ShapeSphere,
        word: "#shape_sphere",
        meaning: "A sphere.",
        origin: Origin::Slides,
        forms: &[form(&[MATERIAL, CENTER, lengths(&["r"], "radius")], "#shape_sphere 0  0 0 0  1")],
    },
    Spec {
        directive: Directive::ShapeBox,
        word: "#shape_box",
        meaning: "A box along the axes; one edge of 0 makes it a rectangle.",
        origin: Origin::Slides,
        forms: &[form(
            &[MATERIAL, CENTER, lengths(&["lx", "ly", "lz"], "full lengths of the edges")],
            "#shape_box 0  0 0 0  1 1.1 1.2",
        )],
    },
    Spec {
        directive: Directive::ShapeCylinder,
        word: "#shape_cylinder",
        meaning: "A closed cylinder along y.",
        origin: Origin::Slides,
        forms: &[form(
            &[
                MATERIAL,
                lengths(&["cx", "cy", "cz"], "centre, at half height"),
                lengths(&["r"], "radius"),
                lengths(&["h"], "height"),
            ],
            "#shape_cylinder 0  0 0 0  1 1.4",
        )],
    },
    Spec {
        directive: Directive::ShapeCone,
        word: "#shape_cone",
        meaning: "A closed cone along y, its apex at cy + h/2; with a second radius, which is an extension of this \
                  program, a truncated one.",
        origin: Origin::Slides,
        forms: &[
            form(
                &[
                    MATERIAL,
                    lengths(&["cx", "cy", "cz"], "centre, at half height"),
                    lengths(&["r"], "radius of the base"),
                    lengths(&["h"], "height"),
                ],
                "#shape_cone 0  0 0 0  1.2 1.3",
            ),
            form(
                &[
                    MATERIAL,
                    lengths(&["cx", "cy", "cz"], "centre, at half height"),
                    lengths(&["r"], "radius of the base"),
                    lengths(&["h"], "height"),
                    lengths(&["r2"], "radius of the upper disc, which closes it in place of the apex"),
                ],
                "#shape_cone 0  0 0 0  1.2 1.3 .5",
            ),
        ],
    },
    Spec {
        directive: Directive::ShapeSide,
        word: "#shape_side",
        meaning: "The side of a cylinder along y, without its discs; with a second radius that of a cone.",
        origin: Origin::Dotray,
        forms: &[
            form(
                &[
                    MATERIAL,
                    lengths(&["cx", "cy", "cz"], "centre, at half height"),
                    lengths(&["r"], "radius"),
                    lengths(&["h"], "height"),
                ],
                "#shape_side 0  0 0 0  1 1.4",
            ),
            form(
                &[
                    MATERIAL,
                    lengths(&["cx", "cy", "cz"], "centre, at half height"),
                    lengths(&["r"], "radius of the lower end"),
                    lengths(&["h"], "height"),
                    lengths(&["r2"], "radius of the upper end; 0 for an apex"),
                ],
                "#shape_side 0  0 0 0  1.2 1.3 .5",
            ),
        ],
    },
    Spec {
        directive: Directive::ShapeTriangle,
        word: "#shape_triangle",
        meaning: "A triangle; the number of arguments tells its two forms apart.",
        origin: Origin::Slides,
        forms: &[
            form(
                &[
                    MATERIAL,
                    lengths(
                        &["v1x", "v1y", "v1z", "v2x", "v2y", "v2z", "v3x", "v3y", "v3z"],
                        "the three points",
                    ),
                    numbers(
                        &["n1x", "n1y", "n1z", "n2x", "n2y", "n2z", "n3x", "n3y", "n3z"],
                        "their normals; 0 0 0 is the face's own normal",
                    ),
                    numbers(&["t1s", "t1t", "t2s", "t2t", "t3s", "t3t"], "their texture coordinates"),
                ],
                "#shape_triangle 0  0 -1 0  1 1 0  -1 1 0  0 0 1  0 0 1  0 0 1  .5 0  1 1  0 1",
            ),
            form(
                &[MATERIAL, integer(&["i", "j", "k"], "numbers of three vertices of the same file, from 0")],
                "#shape_triangle 0  0 1 2",
            ),
        ],
    },
    Spec {
        directive: Directive::VertexNum,
        word: "#vertex_num",
        meaning: "The number of vertices.",
        origin: Origin::LaterCourses,
        forms: &[form(&[COUNT], "#vertex_num 3")],
    },
    Spec {
        directive: Directive::Vertex,
        word: "#vertex",
        meaning: "A vertex that triangles may share.",
        origin: Origin::LaterCourses,
        forms: &[form(
            &[
                lengths(&["px", "py", "pz"], "point"),
                numbers(&["nx", "ny", "nz"], "normal; 0 0 0 is the face's own normal"),
                numbers(&["ts", "tt"], "texture coordinates"),
            ],
            "#vertex 0 -1 0  0 0 1  .5 0",
        )],
    },
    Spec {
        directive: Directive::RayFileNum,
        word: "#ray_file_num",
        meaning: "The number of included files.",
        origin: Origin::LaterCourses,
        forms: &[form(&[COUNT], "#ray_file_num 1")],
    },
    Spec {
        directive: Directive::RayFile,
        word: "#ray_file",
        meaning: "Numbers another file, from 0, so that it can be placed.",
        origin: Origin::LaterCourses,
        forms: &[form(
            &[name(&["filename"], "relative to the file that names it, else to the working directory")],
            "#ray_file part.ray",
        )],
    },
    Spec {
        directive: Directive::RayFileInstance,
        word: "#ray_file_instance",
        meaning: "Places the shapes of a numbered file in the group around.",
        origin: Origin::LaterCourses,
        forms: &[form(&[integer(&["n"], "number of the `#ray_file`, from 0")], "#ray_file_instance 0")],
    },
];
