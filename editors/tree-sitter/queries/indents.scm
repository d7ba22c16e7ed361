(group) @indent.begin
(group_end) @indent.branch @indent.end
