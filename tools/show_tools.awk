# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
#
# Reads what the tools say when they are asked to be verbose; prints one line per tool that ran,
# and every message about the program.

function base(path) { sub(/.*\//, "", path); return path }

function argument(name,    i) {
  for (i = 2; i < NF; i++) if ($i == name) return $(i + 1)
}

function show(tool, from, to) { printf "  %-9s %s -> %s\n", tool, base(from), base(to) }

base($1) ~ /^(gnat1|cc1)$/ { source = argument("-dumpbase"); show(base($1), source, "assembly"); next }
base($1) == "as"           { show("as", "assembly", argument("-o")); next }
base($1) ~ /-gnatbind-12$/ { show("gnatbind", $4, argument("-o")); next }
base($1) == "collect2"     { linked = argument("-o")
                             match($0, /-T ?[a-z]+\.ld/)
                             show("ld", "*.o by " substr($0, RSTART + 2, RLENGTH - 2), linked); next }

# Chatter of the drivers
/^(COLLECT|COMPILER_PATH|LIBRARY_PATH|Configured with|Target:|Thread model)/ { next }
/^(Using built-in|Supported LTO|gcc version|GNU (assembler|C|Ada|ld)|Reading specs)/ { next }
/^No errors$|missing \.note\.GNU-stack|NOTE: This behaviour is deprecated/ { next }

/(error|warning|undefined|overflowed|cannot|failed|not found)/ || /^[^ ]+:[0-9]+:/ { print }
