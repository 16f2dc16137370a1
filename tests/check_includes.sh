#!/usr/bin/env bash
# Holds every #include between modules to the laws in CONTRIBUTING.md's table, and prints the arrows between them.
#
#   check_includes.sh [SOURCE_FOLDER]
#
# A law's line: | module | folder | public headers | what it holds | modules it may use, all of them further up |
set -euo pipefail
cd "${1:-$(dirname "$0")/..}"

sources() { find core lod io tools -name '*.cpp' -o -name '*.h' | LC_ALL=C sort; }

# FILE INCLUDED, for each include of a header of ours.
includes() {
  sources | xargs grep -HoE '^#include ("[^"]+"|<lodestone/[^>]+>)' | sed -E 's/^([^:]+):#include [<"]([^>"]+)[>"]/\1 \2/'
}

laws() { grep -E '^\| [a-z]+ \| (core|lod|io|tools)[a-z/]* \|' CONTRIBUTING.md; }

{ laws; echo "--"; sources; echo "--"; includes; } | awk '
  function fail(message) { print "check_includes: " message > "/dev/stderr"; failed = 1 }

  # The module of a public header as it is included, "lodestone/lod/cursor.h"; of a file in the source tree.
  function module_of_public(path,  parts) {
    sub(/^lodestone\//, "", path)
    if (path in public) return public[path]
    split(path, parts, "/")
    return (parts[1] "/*") in public ? public[parts[1] "/*"] : ""
  }
  function module_of_file(path,  folder) {
    if (match(path, /\/include\//)) return module_of_public(substr(path, RSTART + 9))
    for (folder = path; sub(/\/[^\/]*$/, "", folder);) if (folder in owner) return owner[folder]
    return ""
  }
  # A private header is named from the root of its module: "distance/triangle.h" in lod; a neighbour by its name alone.
  function module_of_include(file, included,  root) {
    if (included ~ /^lodestone\//) return module_of_public(included)
    if (included !~ /\//) return module_of_file(file)
    root = file
    sub(/\/.*/, "", root)
    return module_of_file(root "/" included)
  }

  $0 == "--" { part++; next }
  part == 0 {
    split($0, column, / *\| */)
    name = column[2]
    order[++count] = name
    rank[name] = count
    owner[column[3]] = name
    n = split(column[4], headers, " ")
    for (i = 1; i <= n; i++) public[headers[i]] = name
    may[name] = " " column[6] " "
    n = split(column[6], used, " ")
    for (i = 1; i <= n; i++) if (!(used[i] in rank)) fail(name " may use " used[i] ", which does not stand above it")
    next
  }
  part == 1 {
    if (module_of_file($0) == "") fail($0 " belongs to no module of CONTRIBUTING.md")
    next
  }
  {
    from = module_of_file($1)
    to = module_of_include($1, $2)
    if (to == "") { if ($2 ~ /\//) fail($1 " includes " $2 ", a header of no module"); next }
    if (from == to) next
    arrows[from, to]++
    if (index(may[from], " " to " ") == 0) fail($1 " includes " $2 ": " from " may not use " to)
  }
  END {
    if (count == 0) fail("CONTRIBUTING.md has no table of modules")
    for (i = 1; i <= count; i++) {
      line = order[i]
      for (j = 1; j < i; j++) if (arrows[order[i], order[j]]) line = line (line == order[i] ? " -> " : ", ") order[j] " (" arrows[order[i], order[j]] ")"
      print line
    }
    exit failed
  }'
