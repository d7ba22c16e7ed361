(group) @fold
(comment) @fold
