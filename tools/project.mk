# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
#
# From design.py, src/ and robot.toml to an image, each tool shown as it runs. `make` or `make ram`:
# the image for the boot monitor; `make flash`: the one for power-on; `make test`: every scenario;
# `make clean`. The program is the one of the Ravenbrick tree that RAVENBRICK_HOME names, otherwise
# the one on the PATH.

export RAVENBRICK_HOME
RAVENBRICK ?= $(if $(RAVENBRICK_HOME),"$$RAVENBRICK_HOME/.venv/bin/ravenbrick",ravenbrick)
ifeq ($(RAVENBRICK)$(shell command -v ravenbrick),ravenbrick)
$(error ravenbrick is not on the PATH; set RAVENBRICK_HOME to the Ravenbrick tree)
endif

.DEFAULT_GOAL := ram
.PHONY: ram flash test design clean

ram flash:
	@$(RAVENBRICK) build . --image $@ --tools

test: ram
	@for file in scenarios/*.toml; do $(RAVENBRICK) run . "$$file" || exit; done

design:
	@$(RAVENBRICK) design .

clean:
	@$(RAVENBRICK) build . --clean
