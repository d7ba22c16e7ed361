(comment) @comment

(begin_name) @keyword
(end_name) @keyword
(setting_name) @keyword
(file_name) @keyword.import
(shape_name) @type
(unknown_name) @error

(number) @number
(flag) @attribute
(flags_end) @punctuation.delimiter
(quoted) @string.special.path
(text) @string
(word) @variable
