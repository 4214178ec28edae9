#!/usr/bin/env bash
# fuzz/run.sh SECONDS [TARGET...]: fuzzes each parser for so many seconds, from $FUZZ_SEED (1; 0 is another each time).
# Stable Rust, no cargo-fuzz.
set -euo pipefail
cd "$(dirname "$0")"

seconds=${1:?"usage: fuzz/run.sh SECONDS [obj|ply|off|stl|gltf|glb|table|npy|session|map]..."}
shift
targets=("$@")
[ ${#targets[@]} -gt 0 ] || targets=(obj ply off stl gltf glb table npy session map)

# Coverage counters, as cargo-fuzz sets them. With --target they do not reach build scripts.
host=$(rustc -vV | sed -n 's/^host: //p')
flags="-Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4"
flags+=" -Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table"
flags+=" -Cllvm-args=-sanitizer-coverage-trace-compares -Clink-dead-code --cfg fuzzing"
RUSTFLAGS="$flags" cargo build --release --quiet --target "$host" "${targets[@]/#/--bin=}"
built=${CARGO_TARGET_DIR:-target}/$host/release

python3 seeds.py corpus
mkdir -p artifacts
# A backtrace reads the whole program's symbols, which is more than the targets allow themselves.
export RUST_BACKTRACE=0

# One target; what it says is kept, and told once it is its turn.
fuzz() {
    local target=$1 log="artifacts/$1.log" status=0
    mkdir -p "artifacts/$target"
    echo "== $target, $seconds s"
    "$built/$target" "corpus/$target" -seed="${FUZZ_SEED:-1}" -max_total_time="$seconds" -max_len=4096 -rss_limit_mb=512 \
        -malloc_limit_mb=256 -timeout=10 -artifact_prefix="artifacts/$target/" -print_final_stats=1 >"$log" 2>&1 || status=1
    [ $status -eq 0 ] || tail -n 40 "$log"
    local first last runs
    first=$(grep -m1 -o 'INITED cov: [0-9]*' "$log" || true)
    last=$(grep -o 'cov: [0-9]*' "$log" | tail -n 1 || true)
    runs=$(grep -o 'stat::number_of_executed_units: *[0-9]*' "$log" | grep -o '[0-9]*$' || true)
    echo "   ${first:-no coverage} -> ${last:-none}, ${runs:-0} runs"
    if [ -z "$last" ]; then # without feedback it would find nothing and seem fine
        echo "   no coverage feedback"
        status=1
    fi
    return $status
}

# As many at once as there are processors, in the order of the list.
workers=$(nproc)
failed=()
for ((i = 0; i < ${#targets[@]}; i += workers)); do
    batch=("${targets[@]:i:workers}")
    running=()
    for target in "${batch[@]}"; do
        fuzz "$target" >"artifacts/$target.said" 2>&1 &
        running+=($!)
    done
    for j in "${!batch[@]}"; do
        wait "${running[j]}" || failed+=("${batch[j]}")
        cat "artifacts/${batch[j]}.said"
    done
done
if [ ${#failed[@]} -gt 0 ]; then
    echo "fuzzing found something in: ${failed[*]} (inputs in fuzz/artifacts)" >&2
    exit 1
fi
