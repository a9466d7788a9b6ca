#!/usr/bin/env bash
# Runs fuzz targets, one on each core, each for a while:
#
#     tests/fuzz/run.sh SECONDS [TARGET...]
#
# Ends with status 1 if an input makes one panic, takes longer than 10 s or more memory than there should be; that input is
# in target/fuzz/TARGET/ then. SEED is where the random numbers start, 1 if it is not set; KEEP=1 goes on from what
# earlier runs have found; JOBS is how many run beside each other.
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

# fuzz TARGET: what it says comes at its end, in one piece.
fuzz() {
    local target=$1 found=target/fuzz/$1 said
    mkdir -p "$found/corpus"
    [ -n "${KEEP:-}" ] || find "$found/corpus" -type f -delete
    local options=(
        "-seed=${SEED:-1}" "-max_total_time=$seconds" -timeout=10 -rss_limit_mb=1024 -max_len=4096
        -print_final_stats=1 "-artifact_prefix=$found/"
    )
    [ ! -f "tests/fuzz/dictionaries/$target.dict" ] || options+=("-dict=tests/fuzz/dictionaries/$target.dict")
    local folders=("$found/corpus" "tests/fuzz/corpus/$target")
    case $target in
        gltf) folders+=(fixtures/meshes) ;;
        scene) folders+=(examples/scenes) ;;
    esac
    if "target/debug/$target" "${options[@]}" "${folders[@]}" >"$found/log" 2>&1; then
        sed -n "s/^stat::number_of_executed_units: */$target: executions: /p" "$found/log"
    else
        said=$(grep -A 3 -m 1 'panicked at\|memory allocation of\|ERROR: libFuzzer: [^d]' "$found/log" || true)
        printf '%s\n%s failed, the input is %s; all of it is in %s/log\n' "$said" "$target" \
            "$(sed -n 's/.*Test unit written to //p' "$found/log")" "$found"
        return 1
    fi
}

printf '==> fuzzing %s for %s s each\n' "${targets[*]}" "$seconds"
at_once=${JOBS:-$(nproc)}
started=()
for target in "${targets[@]}"; do
    while [ "$(jobs -rp | wc -l)" -ge "$at_once" ]; do sleep 0.1; done
    fuzz "$target" &
    started+=($!)
done
status=0
for one in "${started[@]}"; do wait "$one" || status=1; done
exit $status
