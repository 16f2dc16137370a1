#!/bin/sh
# Files of `build --profile stream` and streams alone show a first picture within their limits: first_picture.sh PYTHON PROGRAM
set -eu
here=$(cd "$(dirname "$0")" && pwd)
python=$1 program=$2
data=${LODESTONE_DATA:-$here/../../shared/data}
set -- "$here/../demo/suzi.glb"
for model in paper/stanford-bunny.obj paper/fandisk.obj mesh/spider.obj mesh/spot/spot_triangulated.obj gltf/SheenCloth.glb; do
  if [ -e "$data/$model" ]; then set -- "$@" "$data/$model"; else echo "SKIPPED $model: no such model on this machine"; fi
done
exec "$python" -B "$here/../bench/stream/first_picture.py" --program "$program" --effort 1 --strict "$@"
