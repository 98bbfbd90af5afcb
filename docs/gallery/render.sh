#!/bin/sh
# Renders the small pictures of this folder, and the icon, with the penumbra built last.
# Usage: docs/gallery/render.sh [SCENE...]    (default: all of scenes/, and the icon)
set -eu
cd "$(dirname "$0")/../.."
penumbra=${PENUMBRA:-target/release/penumbra}

if [ $# -eq 0 ]; then
    set -- $(basename -s .toml scenes/*.toml)
    "$penumbra" render docs/gallery/icon.toml -o assets/icon.png
fi
for scene in "$@"; do
    "$penumbra" render "scenes/$scene.toml" -o "docs/gallery/$scene.png" \
        --width 480 --height 270
done
