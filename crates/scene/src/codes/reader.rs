//! What the reader says, at length: data only.

use super::Explanation;
use super::explained;
use super::with_limit;
use super::with_parts;

/// One entry for each code of the reader, by name.
pub const EXPLANATIONS: &[Explanation] = &[
    explained(
        "argument-count",
        "Each directive takes a fixed number of arguments, and everything up to the next `#` counts, over as many \
         lines as it runs. The message names the arguments that are missing, or points at the first one too many. \
         Often two numbers have run together, a comment was begun with a sign that is none, or the line belongs to \
         another dialect of the language.",
        "#shape_sphere -1  0 0 0",
        "#shape_sphere -1  0 0 0  1",
    ),
    explained(
        "attenuation",
        "A lamp's light is divided by ca + la·d + qa·d² at the distance d. With a coefficient below 0, or with all \
         three 0, that sum is not above 0 everywhere; where it is not, the light does not fade. A lamp that shall not \
         fade has `1 0 0`.",
        "#light_point 1 1 1  0 5 5  0 0 0",
        "#light_point 1 1 1  0 5 5  1 0 0",
    ),
    with_parts(
        explained(
            "cannot-read",
            "The system refuses to hand out a file: it does not exist, is a folder, or may not be read. The message \
             repeats what the system says. Names of included files are relative to the file that names them, else to \
             the working directory.",
            "#ray_file locked.ray",
            "",
        ),
        &[("locked.ray", None)],
    ),
    explained(
        "count-hint",
        "`#light_num`, `#texture_num`, `#material_num`, `#vertex_num` and `#ray_file_num` announce how many entries \
         follow. They are hints only: the list as written is used. Where hint and list disagree, an entry is missing \
         or the hint was not kept up.",
        "#light_num 2\n#light_dir 1 1 1  0 0 -1",
        "#light_num 1\n#light_dir 1 1 1  0 0 -1",
    ),
    explained(
        "degenerate-shape",
        "A radius or height that is not above 0, an edge below 0, or a triangle whose corners lie on one line: such a \
         shape has no surface that a ray could meet, so it is left out. One edge of 0 is allowed, it makes a box a \
         rectangle.",
        "#shape_sphere -1  0 0 0  0",
        "#shape_sphere -1  0 0 0  1",
    ),
    with_limit(
        explained(
            "file-too-large",
            "A file is larger than what may be read at all, so that no file can take the machine's whole memory.",
            "#shape_sphere -1  0 0 0  1",
            "",
        ),
        "max_file_bytes",
        10,
    ),
    explained(
        "group-matrix",
        "A group's matrix stands row by row and acts on column vectors: a translation stands at the ends of the first \
         three rows, and the last row is `0 0 0 1`. A singular matrix presses everything flat and has no inverse, so \
         no ray could be taken back through it. Typical causes are a number that slipped to a neighbouring place, as \
         in the slides' own example, a matrix written column by column, or a scale of 0. Where one such slip explains \
         the matrix, the message says which matrix was probably meant.",
        "#group_begin 1 0 0 -3  0 1 0 0  0 0 0 1  0 0 0 1\n#group_end",
        "#group_begin 1 0 0 -3  0 1 0 0  0 0 1 0  0 0 0 1\n#group_end",
    ),
    explained(
        "half-angle",
        "The camera's last number is half of the vertical view angle in radians, above 0 and below π/2. A number above \
         that is mostly an angle in degrees: half of it, times π/180, is what belongs here.",
        "#camera 0 0 4  0 0 -1  0 1 0  45",
        "#camera 0 0 4  0 0 -1  0 1 0  .3927",
    ),
    with_parts(
        explained(
            "include-cycle",
            "A file includes itself, be it by way of others, which would make the scene endless. The message shows the \
             chain of files that closes the circle.",
            "#ray_file part.ray",
            "",
        ),
        &[("part.ray", Some("#ray_file example.ray"))],
    ),
    with_limit(
        with_parts(
            explained(
                "include-limit",
                "Files include each other deeper than the limit, or a scene has more files than the limit. The limits \
                 keep a handful of short files from filling the memory.",
                "#ray_file part.ray",
                "",
            ),
            &[("part.ray", Some("#shape_sphere -1  0 0 0  1"))],
        ),
        "max_includes",
        1,
    ),
    explained(
        "include-not-found",
        "The file that a `#ray_file` names is neither beside the file that names it nor in the working directory. The \
         message lists the places tried, and a file of a similar name where there is one. A name with blanks needs \
         \"quotes\".",
        "#ray_file prat.ray",
        "",
    ),
    explained(
        "index-of-refraction",
        "A material that lets light through (kt above 0) bends it by its index of refraction, which must be above 0: \
         1 is air, 1.33 water, 1.5 glass, 2.4 diamond.",
        "#material 0 0 0  0 0 0  1 1 1  0 0 0  .2 .8 0 -1 !glass!",
        "#material 0 0 0  0 0 0  1 1 1  0 0 0  .2 .8 1.5 -1 !glass!",
    ),
    explained(
        "lamp-radius",
        "`#light_area` is a disc; its radius must be above 0. A lamp without extent is a `#light_point`.",
        "#light_area 1 1 1  0 5 0  0 -1 0  0  1 0 0",
        "#light_area 1 1 1  0 5 0  0 -1 0  .5  1 0 0",
    ),
    explained(
        "letter-case",
        "Directives are written in lower case. Other letters are accepted here, but other programs may refuse them.",
        "#Ambient .1 .1 .1",
        "#ambient .1 .1 .1",
    ),
    explained(
        "negative-count",
        "The number of a `#…_num` line says how many entries follow, so it cannot be below 0.",
        "#light_num -1",
        "#light_num 1",
    ),
    with_limit(
        explained(
            "nesting-limit",
            "Groups are nested deeper than the limit, which no scene made by people comes near: a program that writes \
             scenes has probably forgotten its `#group_end`.",
            "#group_begin 1 0 0 0  0 1 0 0  0 0 1 0  0 0 0 1\n\
             #group_begin 1 0 0 0  0 1 0 0  0 0 1 0  0 0 0 1\n#group_end\n#group_end",
            "",
        ),
        "max_nesting",
        1,
    ),
    explained(
        "not-a-number",
        "A decimal, finite number belongs here, such as `3`, `-1`, `.523`, `+2.` or `1e-3`. The decimal sign is the \
         point, numbers are parted by blanks alone, and a comment needs a blank before its `//`. Hexadecimal numbers, \
         `nan`, `inf` and what is too large for double precision are refused.",
        "#shape_sphere -1  0 0,5 0  1",
        "#shape_sphere -1  0 0.5 0  1",
    ),
    explained(
        "not-a-scene",
        "The file has no directive of the language: it is empty, binary, or in another format. Several formats share \
         the ending `.ray` or something close to it; where the first words tell which one it is, the message says so.",
        "ply\nformat ascii 1.0",
        "#shape_sphere -1  0 0 0  1",
    ),
    explained(
        "not-an-integer",
        "Counts and the numbers of materials, textures, vertices and included files are whole numbers.",
        "#light_num 1.5",
        "#light_num 1",
    ),
    explained(
        "parallel-up",
        "The camera's up vector says which side of the picture is up. It may lean, but it must not be parallel to the \
         view direction, for then it says nothing.",
        "#camera 0 9 0  0 -1 0  0 1 0  .4",
        "#camera 0 9 0  0 -1 0  0 0 -1  .4",
    ),
    explained(
        "repeated-directive",
        "A scene has one camera, one background and one ambient light. Of several the first one counts.",
        "#ambient .1 .1 .1\n#ambient .2 .2 .2",
        "#ambient .2 .2 .2",
    ),
    explained(
        "spot-angle",
        "A spot's cut-off angle runs from its axis to its edge, in radians, from 0 to π. A larger number is mostly an \
         angle in degrees; below 0 the lamp lights nothing.",
        "#light_spot 1 1 1  0 5 0  0 -1 0  1 0 0  30 .5",
        "#light_spot 1 1 1  0 5 0  0 -1 0  1 0 0  .5236 .5",
    ),
    explained(
        "stray-group-end",
        "Each `#group_end` closes the group opened last. Here none is open: one `#group_end` is too many, or a \
         `#group_begin` is missing or misspelt.",
        "#group_end",
        "#group_begin 1 0 0 0  0 1 0 0  0 0 1 0  0 0 0 1\n#group_end",
    ),
    explained(
        "stray-text",
        "Words before the first directive belong to nothing. A comment begins with `//` or stands between \
         `/*` and `*/`.",
        "My first scene\n#shape_sphere -1  0 0 0  1",
        "// My first scene\n#shape_sphere -1  0 0 0  1",
    ),
    with_limit(
        explained(
            "too-many-errors",
            "Reading stops after 20 errors: what follows is mostly their consequence. Mend those shown and run again.",
            "#shape_spere -1  0 0 0  1\n#shape_bxo -1  0 0 0  1 1 1",
            "",
        ),
        "max_errors",
        1,
    ),
    with_limit(
        explained(
            "too-many-shapes",
            "A file holds more shapes than the limit, or its instances multiply to more: a file of a few lines can \
             place itself exponentially often by way of others.",
            "#shape_sphere -1  0 0 0  1\n#shape_sphere -1  3 0 0  1",
            "",
        ),
        "max_shapes",
        1,
    ),
    explained(
        "unclosed-group",
        "Each `#group_begin` needs its `#group_end`. The message points at the innermost group still open at the end \
         of the file; the place where the end is missing may lie anywhere after it.",
        "#group_begin 1 0 0 0  0 1 0 0  0 0 1 0  0 0 0 1",
        "#group_begin 1 0 0 0  0 1 0 0  0 0 1 0  0 0 0 1\n#group_end",
    ),
    explained(
        "unknown-directive",
        "No directive has this name. The message suggests the nearest one, or names the dialect that has such a \
         directive. What stands between here and the next directive is passed over.",
        "#shape_spere -1  0 0 0  1",
        "#shape_sphere -1  0 0 0  1",
    ),
    explained(
        "unknown-include",
        "`#ray_file_instance` names a file by its number: the first `#ray_file` of the same file is number 0.",
        "#ray_file_instance 0",
        "",
    ),
    explained(
        "unknown-material",
        "A shape's first number is that of its material: the first `#material` of the same file is number 0, and -1 is \
         the default material. An included file has materials of its own.",
        "#material 1 1 1  1 1 1  0 0 0  0 0 0  0 0 1 -1 !!\n#shape_sphere 1  0 0 0  1",
        "#material 1 1 1  1 1 1  0 0 0  0 0 0  0 0 1 -1 !!\n#shape_sphere 0  0 0 0  1",
    ),
    explained(
        "unknown-texture",
        "The 16th number of a material is that of its texture: the first `#texture` of the same file is number 0, and \
         -1 is none.",
        "#material 1 1 1  1 1 1  0 0 0  0 0 0  0 0 1 0 !!",
        "#material 1 1 1  1 1 1  0 0 0  0 0 0  0 0 1 -1 !!",
    ),
    explained(
        "unknown-vertex",
        "A triangle of four numbers names three vertices: the first `#vertex` of the same file is number 0. Formats \
         that count from 1 need each number lowered by 1.",
        "#vertex 0 0 0  0 0 1  0 0\n#vertex 1 0 0  0 0 1  0 0\n#vertex 0 1 0  0 0 1  0 0\n#shape_triangle -1  1 2 3",
        "#vertex 0 0 0  0 0 1  0 0\n#vertex 1 0 0  0 0 1  0 0\n#vertex 0 1 0  0 0 1  0 0\n#shape_triangle -1  0 1 2",
    ),
    explained(
        "unterminated",
        "A `\"` needs a second `\"`, a `!` a second `!`, a `/*` its `*/`. So that one forgotten sign does not swallow \
         half the file, a text ends at the latest before a line that begins with a directive.",
        "#material 1 1 1  1 1 1  0 0 0  0 0 0  0 0 1 -1 !red",
        "#material 1 1 1  1 1 1  0 0 0  0 0 0  0 0 1 -1 !red!",
    ),
    explained(
        "wrong-argument",
        "A file name belongs here, as it is or in \"quotes\", or a text between exclamation marks; `!!` is an empty \
         text.",
        "#material 1 1 1  1 1 1  0 0 0  0 0 0  0 0 1 -1 red",
        "#material 1 1 1  1 1 1  0 0 0  0 0 0  0 0 1 -1 !red!",
    ),
    explained(
        "zero-direction",
        "A direction may have any length but 0: the camera's view and up, a spot's axis, where parallel light travels, \
         the front side of a lamp. A length so small or so large that its square cannot be held is refused as well.",
        "#light_dir 1 1 1  0 0 0",
        "#light_dir 1 1 1  0 -1 0",
    ),
];
