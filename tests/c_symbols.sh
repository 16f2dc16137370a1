#!/usr/bin/env bash
# The shared library for C shows the functions of its header, all of them and nothing else.
#
#   c_symbols.sh LIBRARY HEADER
set -euo pipefail

shown() { nm -D --defined-only "$1" | awk '{ print $3 }' | sort; }
declared() { grep -oE '^LODESTONE_API .*' "$1" | grep -oE 'lodestone_[a-z_]+\(' | tr -d '(' | sort; }

[ "$(declared "$2" | wc -l)" -ge 20 ]
diff <(shown "$1") <(declared "$2")
