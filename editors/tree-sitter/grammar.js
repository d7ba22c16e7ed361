// The `.ray` language for tree-sitter. Its words come from directives.json, which a test makes from the table of
// directives; check.sh beside this file generates the parser and tests it.

/// <reference types="tree-sitter-cli/dsl" />

const words = require("./directives.json");

// Directives are lower case; other letters are accepted.
const inAnyCase = (word) =>
  word.replace(/[a-z]/g, (letter) => `[${letter}${letter.toUpperCase()}]`);

const oneOf = (list) => new RegExp(`#(?:${list.map(inAnyCase).join("|")})`);

// A text or a name runs to its closing sign, but never into a line that begins with a `#`.
const closedBy = (sign) =>
  new RegExp(`${sign}(?:[^${sign}\\n]|(?:\\n[ \\t\\r]*)+[^#${sign}\\s])*(?:\\n[ \\t\\r]*)*${sign}`);

// Of tokens of one length the first counts, so the order of the rules below is what tells numbers from words.
module.exports = grammar({
  name: "ray",

  extras: ($) => [/\s/, /\uFEFF/, $.comment],

  rules: {
    source_file: ($) => repeat($._item),

    _item: ($) => choice($.group, $.directive),

    group: ($) => seq($.group_begin, repeat($._item), $.group_end),
    group_begin: ($) => seq($.begin_name, repeat($._argument)),
    group_end: ($) => seq($.end_name, repeat($._argument)),

    directive: ($) =>
      seq(choice($.shape_name, $.file_name, $.setting_name, $.unknown_name), repeat($._argument)),

    _argument: ($) => choice($.number, $.flag, $.flags_end, $.quoted, $.text, $.word),

    comment: (_) => token(choice(/\/\/[^\n]*/, /\/\*(?:[^*]|\*+[^*\/])*\*+\//)),

    begin_name: (_) => token(oneOf(words.begins)),
    end_name: (_) => token(oneOf(words.ends)),
    shape_name: (_) => token(oneOf(words.shapes)),
    file_name: (_) => token(oneOf(words.files)),
    setting_name: (_) => token(oneOf(words.settings)),
    unknown_name: (_) => /#\S*/,

    number: (_) => /[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?/,
    flags_end: (_) => "--",
    flag: (_) => /-[A-Za-z]\S*/,
    quoted: (_) => token(closedBy('"')),
    text: (_) => token(closedBy("!")),
    // What begins like a comment is one.
    word: (_) => /[^\s#!"\/]\S*|\/|\/[^\s\/*]\S*/,
  },
});
