//! What is said of the scene as a whole, at length: data only.

use super::Explanation;
use super::explained;
use super::with_parts;

const SMALL: &str = "\
#group_begin 1e-200 0 0 0  0 1e-200 0 0  0 0 1e-200 0  0 0 0 1
#group_begin 1e-200 0 0 0  0 1e-200 0 0  0 0 1e-200 0  0 0 0 1
#shape_sphere -1  0 0 0  1
#group_end
#group_end";

/// One entry for each code of resolving, of looking a scene over, and of textures.
pub const EXPLANATIONS: &[Explanation] = &[
    Explanation {
        code: "broken-scene",
        text: "A scene that a program has put together, not one read from a file, names an entry of its own lists that \
               does not exist. No file gives this message.",
        example: None,
        repaired: "",
    },
    explained(
        "color-range",
        "Colours run from 0 to 1. Whole numbers up to 255 look as if they came from a program that counts so; \
         divided by 255 they are what was probably meant. Lamps may be brighter than 1 and are not judged.",
        "#background 135 206 235",
        "#background .529 .808 .922",
    ),
    explained(
        "duplicate-shape",
        "Two shapes agree in every number and stand in the same place. Exact ties go to the shape that stands first, \
         so no ray meets the second; if it lets light through, shadows count it all the same. Mostly a line was copied \
         and not changed.",
        "#shape_sphere -1  0 0 0  1\n#shape_sphere -1  0 0 0  1",
        "#shape_sphere -1  0 0 0  1\n#shape_sphere -1  3 0 0  1",
    ),
    explained(
        "empty-view",
        "Every shape lies behind the camera, so the picture is all background. The camera's second triple is a \
         direction, not the point to look at: that point minus the eye is the direction.",
        "#camera 0 0 9  0 0 1  0 1 0  .5\n#shape_sphere -1  0 0 0  1",
        "#camera 0 0 9  0 0 -1  0 1 0  .5\n#shape_sphere -1  0 0 0  1",
    ),
    explained(
        "enclosed-shape",
        "A shape stands wholly inside a sphere, box or cylinder whose material lets no light through, and the camera \
         does not: rays end on the outer surface, so the inner shape shows nowhere and costs time. Let the outer \
         material transmit (kt above 0), or take the inner shape out.",
        "#shape_sphere -1  0 0 0  2\n#shape_box -1  0 0 0  1 1 1",
        "#shape_sphere -1  0 0 0  2\n#shape_box -1  5 0 0  1 1 1",
    ),
    explained(
        "material-range",
        "The specular coefficient ks and the transmission coefficient kt weigh light, so they are 0 or more. A number \
         below 0 is used as written, but for the highlight's exponent, and darkens the picture.",
        "#material 1 1 1  1 1 1  1 1 1  0 0 0  -.5 0 1 -1 !!",
        "#material 1 1 1  1 1 1  1 1 1  0 0 0  .5 0 1 -1 !!",
    ),
    explained(
        "material-text",
        "The text between exclamation marks holds clauses such as `marble scale=3`: a known name, then `key=value` \
         without blanks. A key that the clause does not have, or a value out of its range, is passed over; anything \
         that is not of this form is free text and is kept without a word.",
        "#material 1 1 1  1 1 1  0 0 0  0 0 0  0 0 1 -1 !marble size=3!",
        "#material 1 1 1  1 1 1  0 0 0  0 0 0  0 0 1 -1 !marble scale=3!",
    ),
    explained(
        "no-camera",
        "Without a `#camera` one is used that looks down -z and just frames all shapes. The message gives it as a line \
         that can be copied into the file and changed there. Files that other files include need none.",
        "#light_dir 1 1 1  0 0 -1\n#shape_sphere -1  0 0 0  1",
        "#camera 0 0 4  0 0 -1  0 1 0  .4\n#light_dir 1 1 1  0 0 -1\n#shape_sphere -1  0 0 0  1",
    ),
    explained(
        "no-light",
        "Without any lamp only ambient light and what materials emit show. Files that other files include need none: \
         lamps of included files do not count.",
        "#camera 0 0 4  0 0 -1  0 1 0  .4\n#shape_sphere -1  0 0 0  1",
        "#camera 0 0 4  0 0 -1  0 1 0  .4\n#light_dir 1 1 1  0 0 -1\n#shape_sphere -1  0 0 0  1",
    ),
    explained(
        "no-shape",
        "There is nothing to see: the file has no shape, all of them were left out, or no included file is placed.",
        "#camera 0 0 4  0 0 -1  0 1 0  .4\n#light_dir 1 1 1  0 0 -1",
        "#camera 0 0 4  0 0 -1  0 1 0  .4\n#light_dir 1 1 1  0 0 -1\n#shape_sphere -1  0 0 0  1",
    ),
    explained(
        "singular-product",
        "Each matrix is fine by itself, but the product of those around a shape is singular or leaves the range of \
         double precision: scales have piled up. The message lists the groups from the inside out.",
        SMALL,
        "",
    ),
    explained(
        "texture-not-found",
        "A texture's name is relative to the folder of the file that names it, else to the working directory; a \
         backslash is taken as `/` where it must be. The message lists the folders searched, and a file of a similar \
         name where there is one. A name with blanks needs \"quotes\".",
        "#texture nowhere.png",
        "",
    ),
    with_parts(
        explained(
            "texture-unreadable",
            "The file is there, but it is no picture: damaged, cut off, empty, too large, or in a format that is not \
             read. Save it anew as PNG, JPEG, BMP, PPM, QOI, TIFF, HDR or EXR.",
            "#texture noise.png",
            "",
        ),
        &[("noise.png", Some("no picture"))],
    ),
    with_parts(
        explained(
            "unused-include",
            "`#ray_file` only gives a file a number; its shapes appear where a `#ray_file_instance` places it, as \
             often as there are such lines.",
            "#ray_file part.ray",
            "#ray_file part.ray\n#ray_file_instance 0",
        ),
        &[("part.ray", Some("#shape_sphere -1  9 0 0  1"))],
    ),
    explained(
        "vanishing-shape",
        "Double precision holds 16 digits. A shape of size 1 at a distance of 10^17 from the origin has all its sides \
         at the same number, and no ray can meet it. Bring the scene near the origin.",
        "#shape_sphere -1  1e20 1e20 -1e20  1",
        "#shape_sphere -1  0 0 0  1",
    ),
];
