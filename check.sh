#!/usr/bin/env bash
# Everything that has to hold before a change lands. The same script runs on a developer's machine and in CI.
# It needs a Rust toolchain (1.95 or newer) with rustfmt and clippy, and nothing else.
set -euo pipefail
cd "$(dirname "$0")"

step() { printf '\n== %s\n' "$*"; }

step "format"
cargo fmt --check

step "lints, warnings are errors"
cargo clippy --locked --all-targets -- -D warnings

step "docs, warnings are errors"
RUSTDOCFLAGS="-D warnings" cargo doc --locked --no-deps

step "the core and the command line build without the window"
cargo check --locked --no-default-features
if cargo tree --locked -e normal --no-default-features | grep -E 'eframe|egui|rfd'; then
    echo "the core depends on the window's crates" >&2
    exit 1
fi

step "tests"
cargo test --locked

step "one scene of the gallery, without a window"
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
"${CARGO_TARGET_DIR:-target}/debug/penumbra" render scenes/final.toml -o "$out/final.png" \
    --width 320 --height 180 --samples 16 --json
"${CARGO_TARGET_DIR:-target}/debug/penumbra" verify "$out/final.png"

step "all checks passed"
