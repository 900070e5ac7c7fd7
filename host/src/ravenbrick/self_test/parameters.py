# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The timing parameters, and the rows of a record that tell their values apart.

The order matters: the rows of a parameter depend besides on earlier ones only (and on later ones
little, which a second pass settles).
"""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["PARAMETERS", "UNSEEN", "Parameter", "Value"]

Value = int | str | bool


@dataclass(frozen=True)
class Parameter:
    """A field of `timing` in the brick's configuration (docs/reference/timing.md).

    `values` are those that are tried, in their order; `step_cycles` instead marks a parameter
    whose value is computed from the rows, which it moves in proportion, to this precision.
    """

    name: str
    nominal: Value
    rows: tuple[str, ...]
    values: tuple[Value, ...] = ()
    step_cycles: int = 0


_FLASH_LOADS = ("flash.thumb_with_ram_loads", "flash.thumb_with_flash_loads")
_FEW = tuple(range(5))
_SOME = tuple(range(11))

PARAMETERS = (
    Parameter("apb_cycles", 2, ("peripheral.loads", "peripheral.stores"), tuple(range(1, 9))),
    Parameter("flash_data_wait_cycles", 1, ("flash.loads",), _FEW),
    Parameter("flash_sequential_thumb_wait_cycles", 0, ("flash.thumb_operations",), _FEW),
    Parameter("flash_sequential_arm_wait_cycles", 1, ("flash.arm_operations",), _FEW),
    Parameter(
        "flash_first_wait_cycles", 1, ("flash.thumb_branches_even", "flash.arm_branches"), _FEW
    ),
    Parameter("thumb_odd_target_cycles", 0, ("flash.thumb_branches_odd",), _FEW),
    Parameter("code_buffer_loss", "branch", _FLASH_LOADS, ("branch", "flash_data", "gap")),
    Parameter("pdc_steal_cycles", 1, ("dma.loop_beside_100_transfers",), _SOME),
    Parameter("aic_level_cycles", 4, ("interrupt.level_request",), _SOME),
    Parameter("aic_edge_cycles", 5, ("interrupt.edge_request",), _SOME),
    Parameter("pio_input_cycles", 1, ("interrupt.pin_request",), _FEW),
    Parameter("pio_filter_cycles", 1, ("interrupt.filtered_pin_request",), _FEW),
    Parameter("core_sync_cycles", 3, ("interrupt.handler",), _SOME),
    Parameter("mask_change_delayed", True, ("interrupt.unmasked_before_load",), (False, True)),
    Parameter("coprocessor_stretch_cycles", 192, ("link.receive", "link.send"), step_cycles=48),
)

UNSEEN = {
    "undefined_internal_cycles": "an undefined instruction ends the program",
}
"""Parameters that no row depends on, with the reason."""
