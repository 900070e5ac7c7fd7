# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
#
# The one entry point. `make` lists the targets.

PYTHON := .venv/bin/python
export PATH := $(CURDIR)/.venv/bin:$(PATH):$(HOME)/.cargo/bin
# Python keeps what it compiled, whatever the environment says: a command starts in half the time.
unexport PYTHONDONTWRITEBYTECODE
PYTHON_FOLDERS := host tools runtime drivers examples verification virtual-brick/bindings
CARGO := env -u MAKEFLAGS cargo
CARGO_OPTIONS := --locked --manifest-path virtual-brick/Cargo.toml

# Root in the tree of another user is root for Debian packages only.
ifeq ($(shell test "$$(id -u)" = 0 -a "$$(stat -c %u .)" != 0 && echo yes),yes)
SHELL := tools/as_owner
setup native develop complete: SHELL := /bin/sh
endif

.DEFAULT_GOAL := help
.PHONY: help
help: ## List the targets
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  make %-14s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

.PHONY: setup
setup: ## Install missing packages and build everything that the commands need
	@tools/setup

.PHONY: native
native: ## Set-up with JIT code in the virtual brick: busy programs run twice as fast
	@tools/setup native

.PHONY: develop
develop: ## Set-up with the tools for tests, style checks and benchmarks
	@tools/setup develop

.PHONY: complete
complete:
	@tools/setup develop native

.PHONY: page
page: ## Build the page of `ravenbrick view` after a change (needs Node.js and rustup)
	@tools/page

.PHONY: demo
demo: setup ## Design, build and run the paper's vehicle; writes out/vehicle/report.html
	@.venv/bin/ravenbrick demo examples/vehicle

# Two more than there are processors: tests also wait, for links and for clocks.
JOBS = $(shell expr $$(nproc) + 2)
TOGETHER = $(MAKE) --no-print-directory --jobs=$(JOBS) --keep-going --output-sync

.PHONY: test
test: built ## Run all tests
	@$(TOGETHER) $(TEST_GROUPS) BUILT=yes

.PHONY: ci
ci: built docs-packages ## What CI runs: all tests, beside them the site with some bricks
	@$(TOGETHER) docs-site $(TEST_GROUPS) BUILT=yes BRICKS="$(CI_BRICKS)"

.PHONY: style
style: ## Check style, types, spelling, borders between the parts, and generated tables
	@$(PYTHON) -m tools.style.tidy
	@git ls-files -z | xargs -0 .venv/bin/codespell
	@$(PYTHON) -m tools.docs.tables --check
	@$(PYTHON) -m ruff check --quiet $(PYTHON_FOLDERS)
	@$(PYTHON) -m ruff format --quiet --check $(PYTHON_FOLDERS)
	@$(PYTHON) -m mypy --no-error-summary --config-file mypy.ini $(PYTHON_FOLDERS)
	@cargo fmt --manifest-path virtual-brick/Cargo.toml --all --check
	@$(CARGO) clippy $(CARGO_OPTIONS) --quiet --workspace --all-targets -- --deny warnings

.PHONY: test-rust
test-rust: ## Tests of the virtual brick's crates
	@$(CARGO) test $(CARGO_OPTIONS) --quiet --no-fail-fast --workspace --lib --bins --tests \
		--exclude virtual-brick-python --exclude virtual-brick-wasm --exclude wasm-glue

# The longest first, and last what uses several processors by itself.
PYTHON_GROUPS := test-brick test-host test-timing test-commands test-control test-tools
TEST_GROUPS = test-page $(PYTHON_GROUPS) style test-rust
.PHONY: test-python built $(PYTHON_GROUPS)
test-python: built ## Tests of the host package, tools, run-time, drivers and examples
	@$(TOGETHER) $(PYTHON_GROUPS) BUILT=yes

CONTROL := $(addprefix host/tests/,codegen control model schedule simulink)
test-host: TESTS := host/tests virtual-brick/bindings/python/tests \
	$(addprefix --ignore=,$(CONTROL) host/tests/cli host/tests/timing)
test-timing: TESTS := host/tests/timing
test-control: TESTS := $(CONTROL)
test-brick: TESTS := runtime/tests drivers/tests examples verification
test-commands: TESTS := host/tests/cli
test-tools: TESTS := tools
# Before all of them: beside them, what waits for the image would lose its place to other groups.
$(PYTHON_GROUPS): $(if $(BUILT),,built)
	@env -u MAKEFLAGS $(PYTHON) -m pytest -q $(TESTS)

# The image that several groups use.
built: develop
	@env -u MAKEFLAGS .venv/bin/ravenbrick build examples/vehicle

.PHONY: test-page
test-page: ## Tests of the page: units in Node.js, the shipped page in headless Chromium
	@env -u MAKEFLAGS tools/page test

.PHONY: conformance
conformance: complete ## Full verification campaigns; writes verification/results.{json,md}
	@for peers in cluster docs fmu pybricks pycpa timing; do \
		$(PYTHON) -m pip install --quiet --disable-pip-version-check \
			-r tools/requirements/$$peers.txt || \
		echo "tools/requirements/$$peers.txt: not installed; what compares with it is left out"; \
	done
	@$(PYTHON) -m verification.run

.PHONY: bench
bench: complete ## Benchmarks with peers; writes verification/benchmarks/results.{json,md}
	@$(PYTHON) -m verification.run --benchmarks

.PHONY: docs
docs: setup docs-packages ## Build the documentation site and the lab sheets as PDF in docs/_build
	@$(TOGETHER) docs-site

# A device, an example, and one that the steps of a sheet change.
CI_BRICKS := devices-touch-picture blank-press lab06-share
.PHONY: docs-packages docs-site docs-pages docs-sheets docs-bricks
docs-packages: setup
	@.venv/bin/pip install --quiet --disable-pip-version-check -r tools/requirements/docs.txt

docs-site: docs-sheets docs-bricks
	@rm -rf docs/_build/html/_static/brick*
	@cp -r docs/_build/bricks/. docs/_build/html
	@$(PYTHON) -m tools.docs.site.offline docs/_build/html
	@$(PYTHON) -m tools.docs.site_links docs/_build/html
	@echo "docs/_build/html/index.html, docs/_build/lab-sheets.pdf"

docs-pages:
	@env -u MAKEFLAGS $(PYTHON) -m sphinx -q -W --keep-going -b html docs docs/_build/html

# With the pictures that the pages make.
docs-sheets: docs-pages
	@env -u MAKEFLAGS $(PYTHON) -m tools.docs.sheets_pdf docs/_build/lab-sheets.pdf

# All bricks, or those that BRICKS names.
docs-bricks:
	@env -u MAKEFLAGS $(PYTHON) -m tools.docs.site.build docs/_build/bricks $(BRICKS)

.PHONY: teaching
teaching: docs ## Build the lecturer's site, with slides, in docs/_build/teaching
	@$(PYTHON) -m sphinx -q -W --keep-going -t teaching -b html docs docs/_build/teaching
	@cp -r docs/_build/html/_static/brick docs/_build/html/_static/bricks docs/_build/teaching/_static/
	@$(PYTHON) -m tools.docs.slides docs/_build/teaching/slides
	@$(PYTHON) -m tools.docs.site_links docs/_build/teaching
	@echo "docs/_build/teaching/index.html"

.PHONY: dist
dist: complete ## Build one wheel that works without this tree: build/dist/ravenbrick-….whl
	@$(PYTHON) -m tools.dist

.PHONY: clean
clean: ## Remove all built files (keeps .venv)
	rm -rf build out docs/_build virtual-brick/target web/generated web/node_modules
