//! What is said of files in other dialects, at length: data only.

use super::Explanation;
use super::explained;
use super::with_limit;
use super::with_parts;

/// One entry for each code, by name.
pub const EXPLANATIONS: &[Explanation] = &[
    explained(
        "dialect-doubt",
        "The language spread to other courses and changed there. A file that is faulty as a file of the slides is \
         looked at for what only other dialects have, and this one has marks of more than one; the dialect with more \
         of them is taken. `--dialect NAME` says which it is.",
        "#camera 0 0 9  0 0 -1  0 1 0  1\n#light_area 1 1 1  0 5 5  0 -1 -1  .5  1 0 0\n\
         #material 0 0 0  1 1 1  1 0 0  0 0 0 1  0 0 0  1 -1 !!\n\
         #material 0 0 0  1 1 1  0 0 1  0 0 0 1  0 0 0  1 -1 !!\n#shape_sphere 0  0 0 0  1",
        "",
    ),
    explained(
        "dialect-unclear",
        "A file that is faulty as a file of the slides has as many marks of one other dialect as of another, and \
         their numbers mean different things. `--dialect NAME` says which it is.",
        "#joint_begin elbow\n#shader \"a.vert\" \"a.frag\"",
        "",
    ),
    explained(
        "ignored-part",
        "A foreign dialect says something that the picture does not show: joints stand at their rest pose; programs \
         for graphics cards have no effect, nor have colours of vertices without the program `VertexColour`, nor a \
         bump image that no shape asks for with `-u`; and where light passes through a surface whose index of \
         refraction is not above 0, it is not bent.",
        "#shader \"a.vert\" \"a.frag\"\n#camera 0 0 50  0 0 -1  0 1 0  45",
        "",
    ),
    with_parts(
        explained(
            "include-elsewhere",
            "The programs of some courses ran in another folder than that of their scenes, so that the names of \
             included files in published scenes lead nowhere. In foreign dialects a file of that name beside the one \
             that includes it, or in the folders above, is taken instead.",
            "#camera 0 0 9  0 0 -1  0 1 0  1\n#light_dir 1 1 1  0 0 -1\n\
             #material 0 0 0  1 1 1  1 1 1  0 0 0 1  0 0 0  1 -1 !!\n#shape_sphere 0  0 0 0  1\n\
             #ray_file gone/part.ray\n#ray_file_instance 0",
            "",
        ),
        &[(
            "part.ray",
            Some("#material 0 0 0  1 1 1  1 1 1  0 0 0 1  0 0 0  1 -1 !!\n#shape_sphere 0  2 0 0  1"),
        )],
    ),
    explained(
        "lone-affine",
        "In the dialect `jhu` a `#static_affine` transforms the one shape that follows, which may be a list of shapes, \
         an included file, or another `#static_affine` with its shape. Here none follows.",
        "#static_affine 1 0 0 0  0 1 0 0  0 0 1 0  0 2 0 1",
        "",
    ),
    explained(
        "repeated-name",
        "In the dialect `hmc` shapes name their materials. Two materials have the same name; the last one counts.",
        "#version HMCCS155FALL2002\n#camera 0 0 50  0 0 -1  0 1 0  30\n#light_dir --  1 1 1  0 0 -1\n\
         #material -n red --  0 0 0  1 0 0  0 0 0  0 0 0  0 0 1\n\
         #material -n red --  0 0 0  1 0 0  0 0 0  0 0 0  0 0 1\n\
         #sphere -m red --  0 0 0  1\n#rayfile_end\n#shape_ is not read here",
        "",
    ),
    explained(
        "unclosed-flags",
        "In the dialect `hmc` flags such as `-n name` stand between a directive and `--`, and the numbers follow. \
         Without the `--` it is not clear where the numbers begin.",
        "#version HMCCS155FALL2002\n#sphere -n ball  0 0 0  1",
        "",
    ),
    explained(
        "unsupported-directive",
        "In the dialect `jhu` shapes may be united, intersected and subtracted. Nothing here does that, and without it \
         the picture would not be the one that is meant.",
        "#union",
        "",
    ),
];

/// The entry of a code that comes only where one forces a dialect.
pub const FORCED: &[Explanation] = &[with_limit(
    explained(
        "other-dialect",
        "The language spread to other courses and changed there. This file is written in a dialect whose numbers mean \
         something else than those of the one that `--dialect` names, so reading it so would give a wrong picture. \
         Without that option the dialect is found out.",
        "#version HMCCS155FALL2002\n#sphere -m gold -- 0 0 0  1",
        "",
    ),
    "dialect",
    0,
)];
