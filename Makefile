# The two commands of the README: `make demo` and `make test`. Both set up all that they need in .venv and target.

PYTHON ?= python3
BIN := .venv/bin
RUST := Cargo.toml Cargo.lock $(shell find crates -name '*.rs' -o -name Cargo.toml)
FUZZ_SECONDS ?= 30
TARGET := $(or $(CARGO_TARGET_DIR),target)
# The property tests' random numbers: the same every time, so that what passes here passes elsewhere.
export PROPTEST_RNG_SEED ?= 1

.PHONY: demo test bench rust python fuzz wasm wasm-target editor editor-test tools node clean

demo: .venv/figures.stamp
	$(BIN)/neuralmls demo -o out --force

test: rust wasm editor python editor-test fuzz
	@echo "make test: everything passed"

# Times the kernels against PyTorch, NumPy and molesq, and checks every answer. PyTorch from PyPI takes 6 GB of disk.
bench: .venv/bench.stamp
	$(BIN)/python -m benchmarks

rust: tools
	cargo fmt --all --check
	cargo fmt --manifest-path fuzz/Cargo.toml --check
	cargo clippy --workspace --all-targets --locked -- -D warnings
	cargo test --workspace --locked
	NEURALMLS_SIMD=avx2 cargo test --locked -p neuralmls-core
	NEURALMLS_SIMD=portable cargo test --locked -p neuralmls-core

# The browser editor's crates: they must compile without threads for WebAssembly.
wasm: wasm-target
	cargo clippy --locked -p neuralmls-core -p neuralmls-shapes -p neuralmls-wasm --no-default-features --target wasm32-unknown-unknown -- -D warnings

wasm-target: tools
	@rustup target list --installed 2>/dev/null | grep -q wasm32-unknown-unknown || rustup target add wasm32-unknown-unknown

# Builds the browser editor into the package, from where `neuralmls edit` serves it and wheels take it.
editor: wasm-target node .venv/figures.stamp
	RUSTFLAGS="-C target-feature=+simd128" cargo build --release --locked -p neuralmls-wasm --target wasm32-unknown-unknown
	cargo run --quiet --locked --profile tool -p neuralmls-bindgen -- \
		$(TARGET)/wasm32-unknown-unknown/release/neuralmls_wasm.wasm editor/src/wasm
	node editor/scripts/samples.mjs $(BIN)/neuralmls editor/public/samples
	cd editor && npm ci --no-audit --no-fund --silent && npm run --silent build

editor-test: editor .venv/test.stamp
	cd editor && npm run --silent check && npm test --silent && npm run --silent e2e

python: .venv/test.stamp
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/python -m pytest

fuzz: tools
	fuzz/run.sh $(FUZZ_SECONDS)

.venv/bin/python: | tools
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --upgrade pip

.venv/figures.stamp: .venv/bin/python pyproject.toml $(RUST)
	$(BIN)/python -m pip install --quiet --editable '.[figures]'
	@touch $@

.venv/test.stamp: .venv/bin/python pyproject.toml $(RUST)
	$(BIN)/python -m pip install --quiet --editable '.[baselines,figures,test]'
	@touch $@ .venv/figures.stamp

.venv/bench.stamp: .venv/bin/python pyproject.toml $(RUST)
	$(BIN)/python -m pip install --quiet --editable '.[bench]'
	@touch $@

tools:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null || { echo "Python 3.11 or later is missing: install it from https://www.python.org, or say where it is with PYTHON=..." >&2; exit 1; }
	@$(PYTHON) -c 'import ensurepip' 2>/dev/null || { echo "Python's venv module is missing: install it, on Debian with: apt-get install python3-venv" >&2; exit 1; }
	@command -v cargo >/dev/null || { echo "Rust is missing: install it from https://rustup.rs" >&2; exit 1; }

node:
	@node -e 'process.exitCode = Number(process.versions.node.split(".")[0]) < 20 ? 1 : 0' 2>/dev/null && command -v npm >/dev/null || { echo "Node.js 20 or later with npm is missing: install it from https://nodejs.org, on Debian with: apt-get install nodejs npm" >&2; exit 1; }

clean:
	rm -rf .venv target fuzz/target out editor/node_modules editor/src/wasm editor/public/samples python/neuralmls/editor_server/static
