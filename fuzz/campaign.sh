#!/usr/bin/env bash
# Fuzzes every target in turn: fuzz/campaign.sh [MINUTES a target and round [ROUNDS [SECONDS]]].
# An input that takes more than 10 SECONDS has failed; give it more on a machine that is busy.
# Needs the stable compiler and a C++ compiler, nothing else. What was found and how much was run is
# in fuzz/work/: corpus/, crashes/, and log.tsv with a line a run: when, which target, executions,
# edges and features seen, seconds of a processor. Fails where an input did.
set -euo pipefail
cd "$(dirname "$0")"
minutes=${1:-10} rounds=${2:-3} timeout=${3:-10}
triple=$(rustc -vV | sed -n 's/^host: //p')
# Coverage counters and compared values for libFuzzer; `fuzzing` turns checksums of PNG off.
sancov="-Cpasses=sancov-module -Ccodegen-units=1 --cfg fuzzing"
for flag in level=4 inline-8bit-counters pc-table trace-compares; do
    sancov+=" -Cllvm-args=-sanitizer-coverage-$flag"
done
export CARGO_TARGET_DIR=${FUZZ_TARGET_DIR:-$PWD/target}
RUSTFLAGS=$sancov nice -n 19 cargo build --quiet --locked --release --target "$triple"
mkdir -p work/crashes
# What a target begins with beside the corpus of the tests.
declare -A seeds=([scene_file]=../scenes [scene_render]=../scenes)
n_failed=0 TIMEFORMAT=%U
for round in $(seq "$rounds"); do
    for target in scene_file mesh snapshot scene_render accelerators; do
        mkdir -p "work/corpus/$target"
        log=work/$target.$(date +%s).log
        # Time and memory as promised for any file.
        seconds=$({ time nice -n 19 "$CARGO_TARGET_DIR/$triple/release/$target" \
            "work/corpus/$target" "../tests/corpus/$target" ${seeds[$target]:-} \
            -artifact_prefix="work/crashes/$target-" -max_total_time=$((60 * minutes)) \
            -timeout="$timeout" -rss_limit_mb=2048 -print_final_stats=1 -reload=0 \
            -dict="dictionaries/$target.dict" >"$log" 2>&1; } 2>&1) || {
            n_failed=$((n_failed + 1))
            echo "$target failed: see fuzz/$log" >&2
        }
        runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
        seen=$(sed -n 's/.* cov: \([0-9]*\) ft: \([0-9]*\) .*/\1\t\2/p' "$log" | tail -1)
        printf '%s\t%s\t%s\t%s\t%s\n' \
            "$(date -u +%FT%TZ)" "$target" "${runs:-0}" "$seen" "$seconds" >>work/log.tsv
    done
done
[ "$n_failed" -eq 0 ]
