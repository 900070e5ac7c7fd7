# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
#
# From design.py, src/ and robot.toml to an image, each tool shown as it runs. A project's Makefile
# sets RAVENBRICK_HOME to the Ravenbrick tree and includes this file. `make` or `make ram`: the
# image for the boot monitor; `make flash`: the one for power-on; `make test`: every scenario.
# Inside the tree all that is built goes to the tree's build/, elsewhere to build/ in the project.

HOME_DIR := $(abspath $(RAVENBRICK_HOME))
PYTHON   ?= $(HOME_DIR)/.venv/bin/python
CODE     ?= arm
PROJECT  := $(notdir $(CURDIR))
ROBOT    := $(shell sed -n '/^name = /{s/.*"\(.*\)".*/\1/p;q}' robot.toml)

export RAVENBRICK_BUILD ?= $(if $(filter $(HOME_DIR)/%,$(CURDIR)),$(HOME_DIR),$(CURDIR))/build
export GPR_PROJECT_PATH := $(HOME_DIR)/tools:$(HOME_DIR)/drivers

SHELL := /bin/bash -o pipefail
.DEFAULT_GOAL := ram

.PHONY: ram flash test design runtime clean
ram flash: $(if $(wildcard design.py),generated/functional.c) runtime
	@mkdir -p $(RAVENBRICK_BUILD)/$(PROJECT)/$@
	@gprbuild --config=$(HOME_DIR)/tools/ravenbrick.cgpr -P robot.gpr -XIMAGE=$@ -XCODE=$(CODE) \
	  -XPROJECT=$(PROJECT) -XROBOT=$(ROBOT) -cargs -v -bargs -v -largs -v 2>&1 \
	  | tee $(RAVENBRICK_BUILD)/$(PROJECT)/$@/tools.log | awk -f $(HOME_DIR)/tools/show_tools.awk

test: ram
	@for file in scenarios/*.toml; do \
	  $(PYTHON) -c 'from ravenbrick.cli import main; main()' run . $$file || exit; done

design: generated/functional.c

generated/functional.c: design.py
	@echo "  python    design.py -> $@"
	@$(PYTHON) design.py

# RAVENBRICK_RTS names another run-time library, which is then taken as it is.
runtime:
	@test -n "$$RAVENBRICK_RTS" || $(MAKE) --silent -C $(HOME_DIR)/runtime

clean:
	rm -rf $(RAVENBRICK_BUILD)/$(PROJECT)
