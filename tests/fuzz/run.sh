#!/usr/bin/env bash
# Runs fuzz targets one after the other, each for a while:
#
#     tests/fuzz/run.sh SECONDS [TARGET...]
#
# Ends with status 1 if an input makes one panic, takes longer than 10 s or more memory than there should be; that input is
# in target/fuzz/TARGET/ then. SEED is where the random numbers start, 1 if it is not set; KEEP=1 goes on from what
# earlier runs have found.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

seconds=${1:?"expected how many seconds each target runs"}
shift
targets=("$@")
[ ${#targets[@]} -gt 0 ] || targets=(gltf obj scan scene export render)

# Dependencies are those that the tests have compiled already. The library has no unsafe code: no address sanitizer is needed.
RUSTC_WORKSPACE_WRAPPER=$PWD/tests/fuzz/instrumented.sh CARGO_INCREMENTAL=0 \
    cargo build --locked --package photosurface-fuzz --bins

# Inputs become files by the thousand.
if [ -z "${TMPDIR:-}" ] && [ -w /dev/shm ]; then export TMPDIR=/dev/shm; fi
# One core is enough, and the order of things is the same every time.
export RAYON_NUM_THREADS=1

status=0
for target in "${targets[@]}"; do
    found=target/fuzz/$target
    mkdir -p "$found/corpus"
    [ -n "${KEEP:-}" ] || find "$found/corpus" -type f -delete
    options=(
        "-seed=${SEED:-1}" "-max_total_time=$seconds" -timeout=10 -rss_limit_mb=1024 -max_len=4096
        -print_final_stats=1 "-artifact_prefix=$found/"
    )
    [ ! -f "tests/fuzz/dictionaries/$target.dict" ] || options+=("-dict=tests/fuzz/dictionaries/$target.dict")
    folders=("$found/corpus" "tests/fuzz/corpus/$target")
    case $target in
        gltf) folders+=(fixtures/meshes) ;;
        scene) folders+=(examples/scenes) ;;
    esac
    printf '==> fuzzing %s for %s s\n' "$target" "$seconds"
    if "target/debug/$target" "${options[@]}" "${folders[@]}" >"$found/log" 2>&1; then
        sed -n "s/^stat::number_of_executed_units: */$target: executions: /p" "$found/log"
    else
        status=1
        grep -A 3 -m 1 'panicked at\|memory allocation of\|ERROR: libFuzzer: [^d]' "$found/log" || true
        printf '%s failed, the input is %s; all of it is in %s/log\n' "$target" \
            "$(sed -n 's/.*Test unit written to //p' "$found/log")" "$found"
    fi
done
exit $status
