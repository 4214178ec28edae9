# The two commands of the README: `make demo` and `make test`. Both set up all that they need in .venv and target.

PYTHON ?= python3
BIN := .venv/bin
RUST := Cargo.toml Cargo.lock $(shell find crates -name '*.rs' -o -name Cargo.toml)
FUZZ_SECONDS ?= 30
TARGET := $(or $(CARGO_TARGET_DIR),target)
# The property tests' random numbers: the same every time, so that what passes here passes elsewhere.
export PROPTEST_RNG_SEED ?= 1
# What is shipped names no folder of the machine that built it.
NO_PATHS := --remap-path-prefix=$(or $(CARGO_HOME),$(HOME)/.cargo)/registry/src=crates --remap-path-prefix=$(CURDIR)=.
COMMA := ,

.PHONY: demo test bench rust rust-format rust-lint rust-test rust-simd wasm wasm-target package
.PHONY: python python-lint python-types python-test editor editor-build editor-test editor-types editor-unit editor-e2e
.PHONY: wheels wheels-build wheels-test notebooks fuzz tools node clean

demo: .venv/figures.stamp
	$(BIN)/neuralmls demo -o out --force

# A line for each stage, which are targets below; `tools/stages.py` has their order.
test: tools node
	@$(PYTHON) tools/stages.py

# Times the kernels against PyTorch, NumPy and molesq, and checks every answer. PyTorch from PyPI takes 6 GB of disk.
bench: .venv/bench.stamp
	$(BIN)/python -m benchmarks

rust: rust-format rust-lint rust-test rust-simd

rust-format: tools
	cargo fmt --all --check
	cargo fmt --manifest-path fuzz/Cargo.toml --check

rust-lint: tools
	cargo clippy --workspace --exclude neuralmls-bindgen --all-targets --locked -- -D warnings
	cargo clippy --profile tool -p neuralmls-bindgen --locked -- -D warnings

# Tests that find no files to read say so; it is shown.
rust-test: tools
	cargo test --workspace --exclude neuralmls-bindgen --locked -- --show-output

# The same packages as in rust-test, so that nothing is built again.
rust-simd: tools
	NEURALMLS_SIMD=avx2 cargo test --workspace --exclude neuralmls-bindgen --locked
	NEURALMLS_SIMD=portable cargo test --workspace --exclude neuralmls-bindgen --locked

# The browser editor's crates: they must compile without threads for WebAssembly.
wasm: wasm-target
	cargo clippy --locked -p neuralmls-core -p neuralmls-session -p neuralmls-shapes -p neuralmls-wasm --no-default-features --target wasm32-unknown-unknown -- -D warnings

wasm-target: tools
	@rustup target list --installed 2>/dev/null | grep -q wasm32-unknown-unknown || rustup target add wasm32-unknown-unknown

# Builds the browser editor into the package, from where `neuralmls edit` serves it and wheels take it.
editor: .venv/figures.stamp
	$(MAKE) --no-print-directory editor-build

editor-build: wasm-target node
	RUSTFLAGS="-C target-feature=+simd128 $(NO_PATHS)" cargo build --release --locked -p neuralmls-wasm --target wasm32-unknown-unknown
	cargo run --quiet --locked --profile tool -p neuralmls-bindgen -- \
		$(TARGET)/wasm32-unknown-unknown/release/neuralmls_wasm.wasm editor/src/wasm
	node editor/scripts/samples.mjs $(BIN)/neuralmls editor/public/samples
	cd editor && npm ci --no-audit --no-fund --silent && npm run --silent build

editor-test: editor .venv/test.stamp
	$(MAKE) --no-print-directory editor-types editor-unit editor-e2e

# These need the built editor.
editor-types:
	cd editor && npm run --silent check

editor-unit:
	cd editor && npm test --silent -- --reporter=verbose

editor-e2e:
	cd editor && npm run --silent e2e -- --reporter=list$(if $(PLAYWRIGHT_JSON_OUTPUT_FILE),$(COMMA)json)

python: python-lint python-types python-test

package: .venv/test.stamp

python-lint: .venv/test.stamp
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .

python-types: .venv/test.stamp
	$(BIN)/mypy

# In two processes; tests of a file share what they set up.
python-test: .venv/test.stamp
	$(BIN)/python -m pytest -n 2 --dist loadfile

# Runs the sources in docs/notebooks, and writes what comes of them beside them.
notebooks: .venv/test.stamp
	$(BIN)/python tools/notebooks.py

# What is put on PyPI: a wheel for every Linux with glibc 2.28 and every Python from 3.11 on, and the sources with the built editor.
wheels: editor
	$(MAKE) --no-print-directory wheels-build

wheels-build: .venv/wheels.stamp
	$(BIN)/python tools/wheel/licences.py LICENSE-THIRD-PARTY.txt
	$(BIN)/python tools/wheel/backend.py
	rm -rf dist
	PATH="$(CURDIR)/$(BIN):$$PATH" RUSTFLAGS="$(NO_PATHS)" maturin build --release --locked --zig --compatibility manylinux_2_28 --out dist
	$(BIN)/maturin sdist --out dist

# Installs the wheel where there is nothing but Python, and tries it.
wheels-test: .venv/test.stamp .venv/wheels.stamp
	$(BIN)/python -m pytest -rP tools/wheel/test_wheel.py

fuzz: tools
	fuzz/run.sh $(FUZZ_SECONDS)

.venv/bin/python: | tools
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --upgrade pip

.venv/figures.stamp: .venv/bin/python pyproject.toml $(RUST)
	$(BIN)/python -m pip install --quiet --editable '.[figures]'
	@touch $@

.venv/test.stamp: .venv/bin/python pyproject.toml research/pyproject.toml $(RUST)
	$(BIN)/python -m pip install --quiet --editable '.[figures,test]' --editable ./research
	@touch $@ .venv/figures.stamp

.venv/wheels.stamp: .venv/bin/python pyproject.toml
	$(BIN)/python -m pip install --quiet 'maturin[zig]>=1.16,<2'
	@touch $@

.venv/bench.stamp: .venv/bin/python pyproject.toml research/pyproject.toml $(RUST)
	$(BIN)/python -m pip install --quiet --editable . --editable './research[bench]'
	@touch $@

tools:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null || { echo "Python 3.11 or later is missing: install it from https://www.python.org, or say where it is with PYTHON=..." >&2; exit 1; }
	@$(PYTHON) -c 'import ensurepip' 2>/dev/null || { echo "Python's venv module is missing: install it, on Debian with: apt-get install python3-venv" >&2; exit 1; }
	@command -v cargo >/dev/null || { echo "Rust is missing: install it from https://rustup.rs" >&2; exit 1; }

node:
	@node -e 'process.exitCode = Number(process.versions.node.split(".")[0]) < 20 ? 1 : 0' 2>/dev/null && command -v npm >/dev/null || { echo "Node.js 20 or later with npm is missing: install it from https://nodejs.org, on Debian with: apt-get install nodejs npm" >&2; exit 1; }

clean:
	rm -rf .venv target fuzz/target out dist LICENSE-THIRD-PARTY.txt editor/node_modules editor/src/wasm editor/public/samples python/neuralmls/editor_server/static
