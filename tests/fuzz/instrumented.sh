#!/usr/bin/env bash
# The compiler with coverage for libFuzzer, for the packages of this workspace (RUSTC_WORKSPACE_WRAPPER): the flags are
# those of `cargo fuzz build --sanitizer none`, and all of them are there in a stable compiler.
exec "$@" --cfg fuzzing -Ccodegen-units=1 -Cpasses=sancov-module \
    -Cllvm-args=-sanitizer-coverage-level=4 -Cllvm-args=-sanitizer-coverage-inline-8bit-counters \
    -Cllvm-args=-sanitizer-coverage-pc-table -Cllvm-args=-sanitizer-coverage-trace-compares
