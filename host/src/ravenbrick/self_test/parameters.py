# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The timing parameters, and the rows of a record that tell their values apart.

The order matters: the rows of a parameter depend besides on earlier ones only (and on later ones
little, which a second pass settles).
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache

__all__ = ["INSEPARABLE", "PARAMETERS", "UNSEEN", "Parameter", "Value"]

Value = int | str | bool


@cache
def _nominal_values() -> dict[str, Value]:
    import virtual_brick

    return {p["name"]: p["nominal"] for p in json.loads(virtual_brick.timing_parameters())}


@dataclass(frozen=True)
class Parameter:
    """A field of `timing` in the brick's configuration (docs/reference/timing.md).

    `values` are those that are tried, in their order; `step_cycles` instead marks a parameter
    whose value is computed from the rows, which it moves in proportion, to this precision.
    """

    name: str
    rows: tuple[str, ...]
    values: tuple[Value, ...] = ()
    step_cycles: int = 0

    @property
    def nominal(self) -> Value:
        """The virtual brick's own value."""
        return _nominal_values()[self.name]


_FLASH_LOADS = ("flash.thumb_with_ram_loads", "flash.thumb_with_flash_loads")
_FEW = tuple(range(5))
_SOME = tuple(range(11))

PARAMETERS = (
    Parameter("apb_cycles", ("peripheral.loads", "peripheral.stores"), tuple(range(1, 9))),
    Parameter("flash_data_wait_cycles", ("flash.loads",), _FEW),
    Parameter("flash_sequential_thumb_wait_cycles", ("flash.thumb_operations",), _FEW),
    Parameter("flash_sequential_arm_wait_cycles", ("flash.arm_operations",), _FEW),
    Parameter("flash_first_wait_cycles", ("flash.thumb_branches_even", "flash.arm_branches"), _FEW),
    Parameter("thumb_odd_target_cycles", ("flash.thumb_branches_odd",), _FEW),
    Parameter("code_buffer_loss", _FLASH_LOADS, ("branch", "flash_data", "gap")),
    Parameter("pdc_steal_cycles", ("dma.loop_beside_100_transfers",), _SOME),
    Parameter("aic_level_cycles", ("interrupt.level_request",), _SOME),
    Parameter("aic_edge_cycles", ("interrupt.edge_request",), _SOME),
    Parameter("pio_input_cycles", ("interrupt.pin_request",), _FEW),
    Parameter("pio_filter_cycles", ("interrupt.filtered_pin_request",), _FEW),
    Parameter("core_sync_cycles", ("interrupt.handler",), _SOME),
    Parameter("mask_change_delayed", ("interrupt.unmasked_before_load",), (False, True)),
    Parameter("coprocessor_stretch_cycles", ("link.receive", "link.send"), step_cycles=48),
)

UNSEEN = {
    "undefined_internal_cycles": "an undefined instruction ends the program",
    "twi_stop_decision": "the handler is always in time; a slave with a long hold, and a byte "
    "written during it",
    "coprocessor_bad_frame_cycles": "no frame has a wrong sum; TWCK after such a frame on a logic "
    "analyser",
    "coprocessor_pass_cycles": "no output is measured; from the end of a frame on TWCK to the "
    "change of a bridge on a logic analyser",
}
"""Parameters that no row depends on, with the reason and what would show them."""

INSEPARABLE = {
    "coprocessor_status_copy_cycles": "only its sum with `coprocessor_stretch_cycles`; TWCK after "
    "the address of a read on a logic analyser",
    "coprocessor_good_frame_cycles": "only its sum with `coprocessor_stretch_cycles`; TWCK after "
    "the ninth byte of a frame on a logic analyser",
}
"""Parameters that move rows in the same way as another one, with what would tell them apart."""
